import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication

from qmd_studio.project.playhead import Playhead
from qmd_studio.ui.ruler import Ruler, label_step


@pytest.fixture
def ruler(qtbot):
    ruler = Ruler(Playhead(101, 25.0))
    qtbot.addWidget(ruler)
    ruler.resize(432, 40)
    ruler.show()
    return ruler


def drag(ruler, first, last, modifiers=Qt.KeyboardModifier.NoModifier):
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    for kind, frame, button, held in (
        (QEvent.Type.MouseButtonPress, first, left, left),
        (QEvent.Type.MouseMove, last, none, left),
        (QEvent.Type.MouseButtonRelease, last, left, none),
    ):
        place = QPointF(ruler.x_of(frame), 20)
        QApplication.sendEvent(ruler, QMouseEvent(kind, place, place, button, held, modifiers))


def test_dragging_on_the_ruler_moves_the_playhead_and_stops_it(ruler):
    ruler._playhead.playing = True
    seen = []
    ruler._playhead.moved.connect(seen.append)
    drag(ruler, 20, 70)
    assert seen == [20, 70]
    assert not ruler._playhead.playing


def test_dragging_with_shift_sets_the_range_that_plays(ruler):
    drag(ruler, 60, 40, Qt.KeyboardModifier.ShiftModifier)
    assert ruler._playhead.preview_range == (40, 60)


def test_the_wheel_steps_by_frames(ruler):
    def turn(delta):
        none = Qt.KeyboardModifier.NoModifier
        place = QPointF(100, 20)
        event = QWheelEvent(
            place, place, QPoint(), QPoint(0, delta), Qt.MouseButton.NoButton, none, Qt.ScrollPhase.NoScrollPhase, False
        )
        QApplication.sendEvent(ruler, event)

    turn(-120)
    turn(-120)
    turn(120)
    assert ruler._playhead.index == 1


@given(n_frames=st.integers(1, 2_000_000), width=st.integers(50, 4000))
def test_labels_never_touch(n_frames, width):
    step = label_step(n_frames, width)
    assert step >= n_frames or step * width / max(n_frames - 1, 1) >= 64


def test_a_frame_and_its_pixel_are_inverse(ruler):
    assert [ruler.frame_at(ruler.x_of(frame)) for frame in range(101)] == list(range(101))


@pytest.mark.parametrize(("typed", "frame"), [("42", 42), ("1.0s", 30), ("0:01.5", 45), ("999", 59)])
def test_the_place_field_goes_where_it_is_told(window, open_clip, bvh_file, qtbot, typed, frame):
    open_clip(window, bvh_file)
    window.verbs["go_to"].trigger()
    qtbot.waitUntil(window.timeline.place.hasFocus)
    qtbot.keyClicks(window.timeline.place, typed)
    qtbot.keyClick(window.timeline.place, Qt.Key.Key_Return)
    assert window.playhead.index == frame


def test_the_place_field_when_it_is_no_place_then_says_what_is(window, open_clip, bvh_file, qtbot):
    open_clip(window, bvh_file)
    window.timeline.place.setText("soon")
    window.timeline.place.returnPressed.emit()
    assert "0:04.1" in window.banners.banners[0].text
    assert window.playhead.index == 0


def test_speed_and_loop_follow_the_controls(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    window.timeline.speed.setValue(2.5)
    assert window.playhead.speed == 2.5
    window.verbs["faster"].trigger()
    assert window.timeline.speed.value() == 4.0
    window.verbs["loop"].trigger()
    assert not window.playhead.loop
    assert not window.verbs["loop"].isChecked()
