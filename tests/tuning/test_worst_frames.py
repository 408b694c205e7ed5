import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.tuning.error_axis import ErrorAxis
from qmd_studio.tuning.worst_frames import frame_errors, next_worst, outline, worst_frames

errors = st.lists(st.floats(0, 1e4), min_size=1, max_size=120).map(np.array)


def test_the_error_of_a_frame_is_its_worst_point():
    distance = np.array([[0.1, 0.4], [2.0, 0.3]], dtype=np.float32)
    assert frame_errors(distance).tolist() == pytest.approx([0.4, 2.0])


def test_worst_frames_are_the_peaks_in_order_of_time():
    error = np.array([0, 5, 0, 0, 9, 0, 0, 4, 4, 0], dtype=float)
    assert worst_frames(error, min_gap=1).tolist() == [1, 4, 7]


def test_of_peaks_close_together_the_higher_stays():
    error = np.array([0, 5, 0, 9, 0, 0, 0, 7], dtype=float)
    assert worst_frames(error, min_gap=3).tolist() == [3, 7]


def test_small_bumps_are_no_worst_frames():
    error = np.array([0, 1, 0, 0, 9, 0], dtype=float)
    assert worst_frames(error, min_gap=1).tolist() == [4]


def test_a_faultless_motion_has_no_worst_frame():
    frames = worst_frames(np.zeros(5), min_gap=1)
    assert frames.tolist() == []
    assert next_worst(frames, 2) is None


@given(errors, st.integers(1, 20))
def test_the_worst_of_all_is_among_them_and_none_are_too_close(error, min_gap):
    frames = worst_frames(error, min_gap=min_gap)
    if error.max() > 1e-300:
        assert error[frames].max() == error.max()
    assert (np.diff(frames) >= min_gap).all()


def test_next_and_previous_go_round():
    frames = np.array([3, 8, 20])
    assert [next_worst(frames, f) for f in (0, 3, 19, 20, 25)] == [3, 8, 20, 3, 3]
    assert [next_worst(frames, f, backwards=True) for f in (25, 20, 4, 3, 0)] == [20, 8, 3, 20, 20]


@given(errors, st.integers(1, 300))
def test_an_outline_loses_no_peak_and_invents_none(error, width):
    drawn = outline(error, width)
    assert drawn.shape == (width,)
    assert drawn.max() == error.max()
    assert np.isin(drawn, error).all()


@given(st.floats(0, 1e5), st.booleans())
def test_an_axis_holds_the_largest_error(largest, logarithmic):
    axis = ErrorAxis.over(largest, logarithmic=logarithmic)
    assert axis.top >= largest * (1 - 1e-6)
    assert axis.bottom == axis.ticks[0]
    assert axis.top == axis.ticks[-1]
    heights = axis.heights(np.array([0.0, axis.bottom, largest, axis.top]))
    assert (np.diff(heights) >= 0).all()
    assert heights[0] == 0
    assert heights[-1] == pytest.approx(1)


def test_a_linear_axis_starts_at_zero_and_ends_at_a_round_number():
    assert ErrorAxis.over(1.8, logarithmic=False).ticks == pytest.approx((0, 1, 2))
    assert ErrorAxis.over(41.0, logarithmic=False).top == pytest.approx(50)
    assert ErrorAxis.over(0.5, logarithmic=False).top == pytest.approx(0.5)
