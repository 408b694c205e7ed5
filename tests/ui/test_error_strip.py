"""The error strip: a picture of every frame's error, and the way to the worst."""

from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QPalette
from PySide6.QtTest import QTest

from qmd_studio.project.playhead import Playhead
from qmd_studio.ui.error_strip import ErrorStrip
from qmd_studio.ui.ruler import Ruler

N_FRAMES = 201
PEAKS = {40: 8.0, 120: 10.0, 180: 4.0}


@pytest.fixture
def playhead():
    return Playhead(N_FRAMES, 30.0)


@pytest.fixture
def strip(qtbot, playhead):
    strip = ErrorStrip(playhead)
    qtbot.addWidget(strip)
    strip.resize(800, 56)
    strip.show()
    distance = np.full((N_FRAMES, 3), 0.2, dtype=np.float32)
    for frame, error in PEAKS.items():
        distance[frame, 1] = error
    strip.show_error(SimpleNamespace(distance_mm=distance))
    return strip


def inked(strip, x, y):
    """Whether a pixel is not the ground's."""
    image = strip.grab().toImage()
    scale = image.devicePixelRatio()
    return image.pixelColor(round(x * scale), round(y * scale)) != strip.palette().color(QPalette.ColorRole.Base)


def test_a_click_goes_to_the_frame_under_it(strip, playhead):
    playhead.playing = True
    QTest.mouseClick(strip, Qt.MouseButton.LeftButton, pos=QPoint(round(strip.x_of(120)), 20))
    assert playhead.index == 120
    assert not playhead.playing


def test_frames_stand_over_those_of_the_ruler(qtbot, strip, playhead):
    ruler = Ruler(playhead)
    qtbot.addWidget(ruler)
    ruler.resize(strip.width(), 40)
    assert [strip.x_of(f) for f in (0, 77, 200)] == [ruler.x_of(f) for f in (0, 77, 200)]


def test_n_goes_along_the_worst_frames_and_round(strip, playhead):
    seen = []
    for _ in range(4):
        QTest.keyClick(strip, Qt.Key.Key_N)
        seen.append(playhead.index)
    assert seen == [40, 120, 180, 40]
    for _ in range(2):
        QTest.keyClick(strip, Qt.Key.Key_N, Qt.KeyboardModifier.ShiftModifier)
        seen.append(playhead.index)
    assert seen[-2:] == [180, 120]


def test_a_peak_is_drawn_as_high_as_it_is(strip):
    top, bottom = strip._vertical()
    for frame, error in PEAKS.items():
        x = strip.x_of(frame)
        height = bottom - (bottom - top) * error / 10.0
        assert inked(strip, x, height + 3)
    assert not inked(strip, strip.x_of(180), top + 6)


def test_on_a_logarithmic_axis_small_errors_stand_out(strip):
    x, middle = strip.x_of(80), 30
    assert not inked(strip, x, middle)
    strip.logarithmic = True
    assert inked(strip, x, middle)


def test_the_playhead_is_drawn_where_it_is(strip, playhead):
    x = strip.x_of(100)
    assert not inked(strip, x, 14)
    playhead.seek(100)
    assert inked(strip, int(x), 14)


def test_without_a_measurement_it_says_so_and_n_does_nothing(strip, playhead):
    strip.clear()
    strip.go_to_next()
    strip.go_to_previous()
    assert playhead.index == 0
    assert strip.worst == []
    QTest.mouseClick(strip, Qt.MouseButton.LeftButton, pos=QPoint(400, 20))
    assert playhead.index == 100


def test_the_error_of_another_clip_is_not_drawn(strip, playhead):
    playhead.set_clip(50, 30.0)
    assert not inked(strip, strip.x_of(10), 50)


def test_a_clip_of_one_frame_can_be_clicked(qtbot):
    playhead = Playhead(1, 30.0)
    strip = ErrorStrip(playhead)
    qtbot.addWidget(strip)
    strip.resize(300, 56)
    strip.show()
    strip.show_error(SimpleNamespace(distance_mm=np.zeros((1, 2), np.float32)))
    strip.grab()
    QTest.mouseClick(strip, Qt.MouseButton.LeftButton, pos=QPoint(150, 20))
    assert playhead.index == 0
