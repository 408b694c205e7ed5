"""The Pareto front: the settings of any encoder that nothing beats in size and error at once, and its knee."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from qmd_studio.tuning.grid import Column, Grid
from qmd_studio.tuning.running import run_columns
from qmd_studio.tuning.trial import Cancel, Evaluator, Never, Trial

WATCHABLE_MM = 5.0
"""A mean error beyond it is seen by everybody: no trade-off is good there."""

_SMALLEST_ERROR = 1e-9
"""Below it errors count as equal: no logarithm of nothing."""

Measure = Callable[[Trial], float]


def by_def(trial: Trial) -> float:
    """Return the error that a front is drawn over unless another is asked for: DEF."""
    return trial.def_


@dataclass(frozen=True, slots=True)
class Front:
    """`points` by size ascending, their `measure`d error falling; `done` of `total` settings have been tried."""

    points: tuple[Trial, ...] = ()
    measure: Measure = by_def
    done: int = 0
    total: int = 0

    def with_trials(self, trials: Iterable[Trial]) -> Front:
        """Return the front of these points and `trials` together."""
        more = list(trials)
        best, kept = math.inf, []
        for trial in sorted([*self.points, *more], key=lambda t: (t.bytes, self.measure(t))):
            if self.measure(trial) < best:
                kept.append(trial)
                best = self.measure(trial)
        return Front(tuple(kept), self.measure, self.done + len(more), self.total)

    @property
    def knee(self) -> Trial | None:
        """The best trade-off: where the front, both axes logarithmic, bends farthest below the line between its ends.

        Points beyond `WATCHABLE_MM` do not count, unless there is nothing else. None for an empty front; of one or two
        points the smallest.
        """
        points = [trial for trial in self.points if trial.mean_mm <= WATCHABLE_MM] or self.points
        if len(points) < 3:
            return points[0] if points else None
        x = [math.log(trial.bytes) for trial in points]
        y = [math.log(max(self.measure(trial), _SMALLEST_ERROR)) for trial in points]
        width, height = x[-1] - x[0], y[0] - y[-1]
        if not width or not height:
            return points[0]
        below = [1 - (a - x[0]) / width - (b - y[-1]) / height for a, b in zip(x, y, strict=True)]
        return points[max(range(len(below)), key=below.__getitem__)]


def fronts(
    runs: Sequence[tuple[Evaluator, Grid]],
    *,
    others: tuple[int, Iterable[Trial | None]] = (0, ()),
    measure: Measure = by_def,
    cancel: Cancel | None = None,
    n_threads: int | None = None,
) -> Iterator[Front]:
    """Yield the front of several encoders on one motion as it fills in, after each few settings; the last is whole.

    `others` says how many trials come from elsewhere, and yields them (None: one that came to nothing). Settings far
    apart are tried first, so that an early front has the final shape. `cancel` ends it early.
    """
    cancel = cancel or Never()
    plans = [(evaluator, _spread(list(grid.columns(evaluator.motion)))) for evaluator, grid in runs]
    n_others, trials_from_elsewhere = others
    total = sum(len(column.bits) for _, columns in plans for column in columns) + n_others
    front = Front(measure=measure, total=total)
    for trial in trials_from_elsewhere:
        front = front.with_trials([trial]) if trial else replace(front, done=front.done + 1)
        yield front
        if cancel.is_set():
            return
    for evaluator, columns in plans:
        for trials in run_columns(evaluator, columns, cancel=cancel, n_threads=n_threads):
            front = front.with_trials(trials)
            yield front


def _spread(columns: list[Column]) -> list[Column]:
    """Return `columns` in an order that visits every 16th first, then those halfway between, and so on."""
    starts = [(0, 16), (8, 16), (4, 8), (2, 4), (1, 2)]
    return [column for start, step in starts for column in columns[start::step]]
