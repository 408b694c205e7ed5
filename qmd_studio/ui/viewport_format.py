"""The OpenGL surface that the viewport draws on."""

from PySide6.QtGui import QSurfaceFormat


def viewport_format() -> QSurfaceFormat:
    """Return the surface that the viewport needs; make it the default before the application is made."""
    surface = QSurfaceFormat()
    surface.setVersion(3, 3)
    surface.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    surface.setDepthBufferSize(0)
    surface.setSamples(0)
    surface.setSwapInterval(1)
    return surface
