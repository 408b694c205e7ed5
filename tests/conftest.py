import sys

import pytest


@pytest.fixture(autouse=True, scope="module")
def no_other_context():
    """Leave the thread without the OpenGL context that a window of an earlier test used: one thread has one context."""
    gui = sys.modules.get("PySide6.QtGui")
    current = gui.QOpenGLContext.currentContext() if gui is not None else None
    if current is not None:
        current.doneCurrent()
