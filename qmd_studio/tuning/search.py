"""A search that tries few settings: within a per cent of the exhaustive one at a twentieth of its encodings.

The figure of merit falls along the edge of the largest allowed file, and is rugged in n_d where errors add up along the
motion. So the search looks at a coarse net over one segment and at that edge, then walks downhill from the best places
found, in steps of FDF that halve, until walks bring nothing more or what it may spend is spent.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TypeVar

from qmd_studio.tuning.attempts import Attempts, Rank, by_merit
from qmd_studio.tuning.grid import Grid
from qmd_studio.tuning.lattice import Lattice, Point
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import OnProgress, Outcome
from qmd_studio.tuning.trial import Cancel, Evaluator

_T = TypeVar("_T")

SHARE, AT_LEAST = 0.05, 120
"""What a search may spend: a share of the grid's settings, or a few where the grid is small."""

MOST_VALUES = 30_000_000_000
"""Values, those of the motion times settings, that a search encodes at most beyond `AT_LEAST`: some minutes."""

_SLOWER = 50
"""How much longer an encoder takes that is not fast."""

_NET = 5
"""FDFs of the coarse net at each index width."""

_EDGE_WIDTHS = 2
"""Index widths, the smallest, at which the edge of the largest file is looked at."""

_EDGE_SHARE = 0.4
"""The share of the budget that may go to that edge."""

_FIRST_STEP = 8

_PATIENCE = 8
"""Walks in a row without a better end after which the search ends."""


def search(
    evaluator: Evaluator,
    grid: Grid,
    *,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
    memory: Memory | None = None,
    rank: Rank = by_merit,
) -> Outcome:
    """Try few settings of `grid` and return the best by `rank`, least first.

    At most a twentieth of the grid is encoded, or 120 settings. `memory` is asked first and told afterwards. A search
    that `cancel` stops returns what it has, `complete` False.
    """
    lattice = Lattice(grid, evaluator)
    budget = budget_for(lattice, evaluator)
    with Attempts(evaluator, rank, budget=budget, on_progress=on_progress, cancel=cancel, memory=memory) as attempts:
        attempts.try_all(_net(lattice))
        attempts.try_all(spread(_edge(lattice), int(budget * _EDGE_SHARE)))
        walk_downhill(attempts, lattice)
        return attempts.outcome()


def budget_for(lattice: Lattice, evaluator: Evaluator) -> int:
    """Return how many settings a search of `lattice` may encode: fewer where each takes long."""
    values = MOST_VALUES if evaluator.is_fast else MOST_VALUES // _SLOWER
    affordable = values // max(evaluator.motion.X.size, 1)
    return max(AT_LEAST, min(int(SHARE * len(lattice.points)), affordable))


def walk_downhill(attempts: Attempts, lattice: Lattice) -> None:
    """Walk from the best points tried, each once, until nothing may be tried or walks have brought nothing for long."""
    walked: set[Point] = set()
    since_better, best = 0, attempts.best
    while not attempts.over and since_better < _PATIENCE:
        start = next((point for point in attempts.ranked() if point not in walked), None)
        if start is None:
            return
        walked.update(_walk(attempts, lattice, start))
        since_better = since_better + 1 if attempts.best is best else 0
        best = attempts.best


def _walk(attempts: Attempts, lattice: Lattice, point: Point) -> Iterator[Point]:
    """Go to the best neighbour as long as it is better, with steps of FDF that halve; yield the points passed."""
    yield point
    step = _FIRST_STEP
    while step and not attempts.over:
        neighbours = lattice.around(point, step)
        attempts.try_all(neighbours)
        known = [p for p in (point, *neighbours) if p in attempts.trials]
        better = min(known, key=lambda p: attempts.rank(attempts.trials[p]))
        if attempts.rank(attempts.trials[better]) < attempts.rank(attempts.trials[point]):
            point = better
            yield point
        else:
            step //= 2


def _net(lattice: Lattice) -> list[Point]:
    """Return for the longest segments each b, and FDFs from the least to the largest."""
    points: list[Point] = []
    for bits in lattice.bits:
        fdf = lattice.lines.get((bits, lattice.segments[-1]), [])
        points += [(value, bits, lattice.segments[-1]) for value in spread(fdf, _NET)]
    return points


def _edge(lattice: Lattice) -> list[Point]:
    """Return for each n_d, the longest first, the largest FDF at the smallest index widths."""
    lines = [(bits, segment) for segment in reversed(lattice.segments) for bits in lattice.bits[:_EDGE_WIDTHS]]
    return [(lattice.lines[line][-1], *line) for line in lines if line in lattice.lines]


def spread(values: list[_T], count: int) -> list[_T]:
    """Return at most `count` of `values`, evenly spread from the first to the last."""
    if len(values) <= count:
        return values
    places = [round(i * (len(values) - 1) / max(count - 1, 1)) for i in range(count)]
    return [values[place] for place, after in pairwise([*places, -1]) if place != after]
