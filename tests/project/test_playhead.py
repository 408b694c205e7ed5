import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.errors import EditError
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.timecode import clock_text, parse_frame


def playing(n_frames=10, fps=10.0, **attributes):
    playhead = Playhead(n_frames, fps)
    for name, value in attributes.items():
        setattr(playhead, name, value)
    playhead.playing = True
    return playhead


def test_advance_when_time_passes_then_frames_are_dropped_not_time():
    playhead = playing()
    seen = []
    playhead.moved.connect(seen.append)
    playhead.advance(0.35)
    assert playhead.index == 3
    assert seen == [3]


def test_advance_when_it_loops_then_the_last_frame_lasts_as_long_as_the_others():
    playhead = playing()
    playhead.advance(0.95)
    assert playhead.index == 9
    playhead.advance(0.1)
    assert playhead.index == 0


def test_advance_when_loop_is_off_then_it_stops_at_the_end_and_play_starts_again():
    playhead = playing(loop=False)
    playhead.advance(5.0)
    assert (playhead.index, playhead.playing) == (9, False)
    playhead.playing = True
    assert playhead.index == 0


def test_advance_when_reversed_then_it_runs_backwards_round_the_loop():
    playhead = playing(speed=-1.0)
    playhead.advance(0.15)
    assert playhead.index == 8


def test_preview_range_is_what_plays():
    playhead = playing(preview_range=(6, 3))
    playhead.seek(3)
    playhead.advance(0.45)
    assert playhead.index == 3
    assert (playhead.first, playhead.last) == (3, 6)


def test_speed_is_held_within_its_limits_with_its_sign():
    playhead = Playhead()
    playhead.speed = -9.0
    assert playhead.speed == -4.0
    playhead.speed = 0.01
    assert playhead.speed == pytest.approx(0.1)


def test_step_stops_and_stays_within_the_clip():
    playhead = playing()
    playhead.step(-1)
    assert (playhead.index, playhead.playing) == (0, False)
    playhead.step(99)
    assert playhead.index == 9


@given(
    n=st.integers(1, 50),
    moves=st.lists(st.tuples(st.floats(0, 100), st.floats(-10, 10), st.booleans()), max_size=12),
)
def test_the_playhead_never_leaves_the_clip(n, moves):
    playhead = Playhead(n, 29.97)
    for seconds, speed, loop in moves:
        playhead.speed, playhead.loop, playhead.playing = speed, loop, True
        playhead.advance(seconds)
        assert 0 <= playhead.index < n


@pytest.mark.parametrize(
    ("text", "frame"),
    [("123", 123), ("4.1s", 123), ("4,1 s", 123), ("0:04.1", 123), ("1:00", 1800), ("1:00:01", 108030), (" 7 ", 7)],
)
def test_parse_frame_reads_three_notations(text, frame):
    assert parse_frame(text, 30.0) == frame


@pytest.mark.parametrize("text", ["", "x", "-1", "4.1", "1:2:3:4", "9" * 4000, "nan s"])
def test_parse_frame_when_it_is_none_of_them_then_says_what_is(text):
    with pytest.raises(EditError, match=r"0:04\.1"):
        parse_frame(text, 30.0)


def test_clock_text_rounds_up_into_the_next_minute():
    assert clock_text(4.1) == "0:04.10"
    assert clock_text(59.999) == "1:00.00"
