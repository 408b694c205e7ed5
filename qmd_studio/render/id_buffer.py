"""A tiny picture of numbers instead of colours, by which is told what is under the mouse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.render.gl import GraphicsError

SIDE = 5
"""Pixels of a side; the one in the middle is under the mouse, the others are for what is missed by a hair."""


class IdBuffer:
    """A picture of two whole numbers a pixel, 0 where nothing is drawn, with a depth buffer."""

    def __init__(self) -> None:
        self._framebuffer: int = GL.glGenFramebuffers(1)
        self._buffers = [int(b) for b in GL.glGenRenderbuffers(2)]
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        places = ((GL.GL_RG16I, GL.GL_COLOR_ATTACHMENT0), (GL.GL_DEPTH_COMPONENT24, GL.GL_DEPTH_ATTACHMENT))
        for buffer, (form, place) in zip(self._buffers, places, strict=True):
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, form, SIDE, SIDE)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            self.release()
            raise GraphicsError("the driver gives no picture of numbers to pick from")

    def begin(self) -> None:
        """Draw into this picture from now on."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        GL.glViewport(0, 0, SIDE, SIDE)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(True)
        GL.glClearBufferiv(GL.GL_COLOR, 0, np.zeros(4, dtype=np.int32))
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)

    def read(self) -> tuple[NDArray[np.int32], FloatArray]:
        """Return the numbers (SIDE, SIDE, 2) and the depths (SIDE, SIDE) from 0 to 1, the lowest row first."""
        numbers, depths = np.zeros((SIDE, SIDE, 2), np.int32), np.zeros((SIDE, SIDE), np.float32)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 4)
        GL.glReadPixels(0, 0, SIDE, SIDE, GL.GL_RG_INTEGER, GL.GL_INT, numbers)
        GL.glReadPixels(0, 0, SIDE, SIDE, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, depths)
        return numbers, depths.astype(np.float64)

    def release(self) -> None:
        """Give the picture back to the driver."""
        GL.glDeleteFramebuffers(1, [self._framebuffer])
        GL.glDeleteRenderbuffers(len(self._buffers), self._buffers)


def window_about(at: tuple[float, float], size: tuple[int, int]) -> FloatArray:
    """Return the matrix (4, 4) that spreads the `SIDE` × `SIDE` pixels about `at` over a whole picture.

    `at` is in pixels from the lower left corner of a picture of `size` pixels.
    """
    matrix = np.eye(4)
    for axis in range(2):
        scale = size[axis] / SIDE
        matrix[axis, axis] = scale
        matrix[axis, 3] = -scale * (2 * at[axis] / size[axis] - 1)
    return matrix


def nearest(numbers: NDArray[np.int32]) -> tuple[int, int] | None:
    """Return the row and column of what is drawn nearest to the middle, or None where nothing is."""
    rows, columns = np.nonzero(numbers[:, :, 0])
    if not len(rows):
        return None
    best = int(np.argmin((rows - SIDE // 2) ** 2 + (columns - SIDE // 2) ** 2))
    return int(rows[best]), int(columns[best])
