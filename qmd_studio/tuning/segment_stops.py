"""The stops of the n_d slider: fine where segments are short, the paper's multiples of 30 after that."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

_SHORT = (1, 2, 3, 5, 8, 10, 15, 20)
_STEP = 30
_GROWTH = 1.08


def segment_stops(n_rows: int) -> tuple[int, ...]:
    """Return the segment lengths in rows that a slider stops at, ascending; the last is `n_rows` ≥ 1, one segment.

    Stops from 30 on are multiples of 30, as in the paper's search (section 5.3), and thin out as they grow, so that a
    long motion still has a slider that a hand can set.
    """
    stops = [rows for rows in _SHORT if rows < n_rows]
    rows = _STEP
    while rows < n_rows:
        stops.append(rows)
        rows = max(rows + _STEP, round(rows * _GROWTH / _STEP) * _STEP)
    return (*stops, max(n_rows, 1))


def nearest_stop(stops: Sequence[float], rows: float) -> int:
    """Return the index of the stop nearest to `rows`, of stops in any unit."""
    place = bisect_left(stops, rows)
    if place == 0:
        return 0
    if place == len(stops):
        return len(stops) - 1
    return place if stops[place] - rows < rows - stops[place - 1] else place - 1
