import sys

import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)  # timings are for benchmarks: other work may run beside the tests
settings.load_profile("untimed")


@pytest.fixture(autouse=True, scope="module")
def no_other_context():
    """Leave the thread without the OpenGL context that a window of an earlier test used: one thread has one context."""
    gui = sys.modules.get("PySide6.QtGui")
    current = gui.QOpenGLContext.currentContext() if gui is not None else None
    if current is not None:
        current.doneCurrent()
