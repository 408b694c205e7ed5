import itertools

from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.tuning.segment_stops import nearest_stop, segment_stops


@given(st.integers(1, 50_000))
def test_stops_rise_to_one_segment(n_rows):
    stops = segment_stops(n_rows)
    assert stops[-1] == n_rows
    assert all(a < b for a, b in itertools.pairwise(stops))
    assert all(rows % 30 == 0 for rows in stops[:-1] if rows > 20)


def test_a_walk_has_the_papers_multiples_of_thirty():
    assert segment_stops(342)[-6:] == (210, 240, 270, 300, 330, 342)


def test_a_long_motion_has_stops_that_a_hand_can_set():
    assert len(segment_stops(20_000)) < 120


@given(st.integers(1, 5000), st.integers(1, 5000))
def test_the_nearest_stop_is_nearest(n_rows, rows):
    stops = segment_stops(n_rows)
    assert abs(stops[nearest_stop(stops, rows)] - rows) == min(abs(stop - rows) for stop in stops)
