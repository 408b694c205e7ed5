import gc
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QSurfaceFormat

from qmd_studio.ui.keys import KeyGuard
from qmd_studio.ui.main_window import MainWindow
from qmd_studio.ui.settings import SETTINGS_VARIABLE, Settings
from qmd_studio.ui.theme import Theme, ThemeSwitch
from qmd_studio.ui.viewport_format import viewport_format

QSurfaceFormat.setDefaultFormat(viewport_format())

BVH = """HIERARCHY
ROOT Hips
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 40 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Head
    {
      OFFSET 0 20 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 20 0
      }
    }
  }
}
MOTION
"""


def bvh_text(n_frames=60):
    turns = np.linspace(0, 40, n_frames)
    rows = [f"0 90 0 0 0 0 {a:.3f} 0 0 0 {a / 2:.3f} 0" for a in turns]
    return BVH + f"Frames: {n_frames}\nFrame Time: 0.0333333\n" + "\n".join(rows) + "\n"


@pytest.fixture(autouse=True)
def collected(qapp):
    """Let widgets that a test has done with go on the thread that made them, as the studio's collector does.

    What was there before the test is left out of the search: with compiled kernels loaded that takes a second a time.
    """
    gc.disable()
    gc.freeze()
    yield
    qapp.processEvents()
    gc.collect()
    gc.unfreeze()
    gc.enable()


@pytest.fixture
def bvh_file(tmp_path):
    path = tmp_path / "nod.bvh"
    path.write_text(bvh_text())
    return path


@pytest.fixture
def bad_file(tmp_path):
    path = tmp_path / "broken.bvh"
    path.write_text(bvh_text().replace("OFFSET 0 40 0", "OFFSET 0 forty 0"))
    return path


@pytest.fixture
def make_window(qtbot, qapp, tmp_path, monkeypatch):
    """Make windows with a settings file of the test's own, as many as the test opens one after the other."""
    monkeypatch.setenv(SETTINGS_VARIABLE, str(tmp_path / "settings.ini"))
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    guard = KeyGuard(qapp)
    windows = []

    def make(*, furnished=True):
        window = MainWindow(Settings(), ThemeSwitch(qapp, Theme.LIGHT))
        window.viewport.animated = False
        qtbot.addWidget(window)
        windows.append(window)
        window.resize(960, 640)
        window.show()
        qtbot.waitExposed(window)
        window.activateWindow()  # a screen without a window manager gives the focus to nobody by itself
        qtbot.waitUntil(window.isActiveWindow)
        if furnished:
            window.furnish()
        return window

    yield make
    for window in windows:
        window.close()
    qapp.removeEventFilter(guard)
    qapp.setStyleSheet("")


@pytest.fixture
def window(make_window):
    return make_window()


@pytest.fixture
def open_clip(qtbot):
    def open_(window, path):
        before = len(window.document.state.clips)
        window.open_paths([path])
        qtbot.waitUntil(lambda: len(window.document.state.clips) > before, timeout=10_000)
        window.playhead.playing = False
        window.playhead.seek(0)

    return open_


@pytest.fixture
def drop():
    def drop_(window, *paths):
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
        copy, left, none = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        enter = QDragEnterEvent(window.rect().center(), copy, data, left, none)
        window.dragEnterEvent(enter)
        if enter.isAccepted():
            window.dropEvent(QDropEvent(QPointF(window.rect().center()), copy, data, left, none))
        return enter.isAccepted()

    return drop_
