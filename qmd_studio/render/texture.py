"""A small picture on the graphics card: a colour map, a shadow."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from OpenGL import GL


class Texture:
    """A float picture (height, width, 3) or (height, width), smoothed between its pixels and clamped at its edges."""

    def __init__(self, pixels: ArrayLike) -> None:
        self.number: int = GL.glGenTextures(1)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self.number)
        for name, value in (
            (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_EDGE),
            (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_EDGE),
        ):
            GL.glTexParameteri(GL.GL_TEXTURE_2D, name, value)
        self.write(pixels)

    def write(self, pixels: ArrayLike) -> None:
        """Replace the picture."""
        data = np.ascontiguousarray(pixels, dtype=np.float32)
        form, inner = (GL.GL_RED, GL.GL_R16F) if data.ndim == 2 else (GL.GL_RGB, GL.GL_RGB16F)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self.number)
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 4)
        GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, inner, data.shape[1], data.shape[0], 0, form, GL.GL_FLOAT, data)

    def bind(self, unit: int) -> None:
        """Make this the picture of texture unit `unit`."""
        GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self.number)

    def release(self) -> None:
        """Give the picture back to the driver."""
        GL.glDeleteTextures([self.number])
