"""The picture that the renderer draws into before it reaches the window: multisampled or smaller than the window."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from qmd_studio.render.gl import GraphicsError


class Target:
    """An off-screen picture of `size` pixels with `samples` a pixel (0 or 1 for none) and a depth buffer."""

    def __init__(self, size: tuple[int, int], samples: int) -> None:
        self.size, self.samples = size, samples
        self.number: int = GL.glGenFramebuffers(1)
        self._buffers = [int(b) for b in GL.glGenRenderbuffers(2)]
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.number)
        places = ((GL.GL_RGBA8, GL.GL_COLOR_ATTACHMENT0), (GL.GL_DEPTH_COMPONENT24, GL.GL_DEPTH_ATTACHMENT))
        for buffer, (form, place) in zip(self._buffers, places, strict=True):
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            if samples > 1:
                GL.glRenderbufferStorageMultisample(GL.GL_RENDERBUFFER, samples, form, *size)
            else:
                GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, form, *size)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            self.release()
            raise GraphicsError(
                "the driver gives no picture to draw into", got=f"{size[0]} × {size[1]}, {samples} samples"
            )

    def bind(self) -> None:
        """Make this picture the one that is drawn into."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.number)
        GL.glViewport(0, 0, *self.size)

    def show(self, framebuffer: int, size: tuple[int, int]) -> None:
        """Copy the picture to `framebuffer`, smoothed to `size` pixels."""
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self.number)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, framebuffer)
        smooth = GL.GL_LINEAR if size != self.size else GL.GL_NEAREST
        GL.glBlitFramebuffer(0, 0, *self.size, 0, 0, *size, GL.GL_COLOR_BUFFER_BIT, smooth)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, framebuffer)
        GL.glViewport(0, 0, *size)

    def read(self) -> NDArray[np.uint8]:
        """Return the picture, which must not be multisampled: (height, width, 4) RGBA, the top row first."""
        width, height = self.size
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self.number)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
        data = GL.glReadPixels(0, 0, width, height, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE)
        return np.frombuffer(data, np.uint8).reshape(height, width, 4)[::-1]

    def release(self) -> None:
        """Give the picture back to the driver."""
        GL.glDeleteFramebuffers(1, [self.number])
        GL.glDeleteRenderbuffers(len(self._buffers), self._buffers)
