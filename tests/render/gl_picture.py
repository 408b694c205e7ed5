"""A hidden OpenGL 3.3 context and pictures drawn in it, for the renderer's tests."""

from __future__ import annotations

import numpy as np
from PySide6.QtGui import QOffscreenSurface, QOpenGLContext, QSurfaceFormat

SIZE = (320, 240)


class HiddenContext:
    """Makes a context current and draws scenes into a target of its own."""

    def __init__(self):
        form = QSurfaceFormat()
        form.setVersion(3, 3)
        form.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
        self._surface = QOffscreenSurface()
        self._surface.setFormat(form)
        self._surface.create()
        self._context = QOpenGLContext()
        self._context.setFormat(form)
        assert self._context.create()
        self.make_current()

    def make_current(self):
        assert self._context.makeCurrent(self._surface)

    def picture(self, renderer, scene, camera, *, quality, size=SIZE):
        """Return what `renderer` draws: (height, width, 3) 0 to 255, the top row first."""
        from OpenGL import GL

        from qmd_studio.render.target import Target

        self.make_current()
        target = Target(size, 0)
        renderer.draw(scene, camera, size, framebuffer=target.number, quality=quality)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, target.number)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
        data = GL.glReadPixels(0, 0, *size, GL.GL_RGB, GL.GL_UNSIGNED_BYTE)
        target.release()
        return np.frombuffer(data, np.uint8).reshape(size[1], size[0], 3)[::-1].astype(int)

    def close(self):
        self._context.doneCurrent()
        self._surface.destroy()
