"""What people ask for instead of a product: the fewest bytes for an error, or the least error for a size.

"Cannot be met, the best is …" is an answer: the best trial then is the one that comes nearest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.attempts import Attempts, Rank
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import Grid
from qmd_studio.tuning.lattice import Lattice, Point
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import OnProgress, Outcome
from qmd_studio.tuning.search import budget_for, spread, walk_downhill
from qmd_studio.tuning.trial import Cancel, Evaluator, Trial

_BITS_IN_KBIT = 1000.0

_QUICK = 2e8
"""Values, settings times those of the motion, that a fast evaluator encodes in a second or two."""

_BATCH = 8
"""Settings that are tried together while the smallest files are looked at."""

_PROBES = 3
"""FDFs at which a line is looked at before it is given up."""


class TargetKind(StrEnum):
    """What is bounded: the payload's size or rate, or one of the three measures of error."""

    BYTES = "bytes"
    KBPS = "kbps"
    DEF = "def"
    MEAN_MM = "mean-mm"
    MAX_MM = "max-mm"


@dataclass(frozen=True, slots=True)
class Target:
    """`kind` shall be at most `value`: bytes of the payload, 1000 bits a second, ASF length units or millimetres.

    With a bound on size the least DEF is wanted, with one on error the fewest bytes. Raises `CodecError` for a value
    that is not a positive number.
    """

    kind: TargetKind
    value: float

    def __post_init__(self) -> None:
        if not 0 < self.value < math.inf:
            raise CodecError("the target is out of range", wanted="a positive number", got=f"{self.value:g}")

    @property
    def bounds_size(self) -> bool:
        """Whether it is the size that is bounded, not the error."""
        return self.kind in (TargetKind.BYTES, TargetKind.KBPS)

    def largest_bytes(self, motion: Motion) -> float:
        """Return how many bytes the payload of `motion` may have: infinitely many for a bound on error."""
        if not self.bounds_size:
            return math.inf
        return self.value if self.kind is TargetKind.BYTES else self.value * _BITS_IN_KBIT / 8 * motion.duration_s

    def error(self, trial: Trial) -> float:
        """Return the error that counts: DEF where the size is bounded."""
        return {TargetKind.MEAN_MM: trial.mean_mm, TargetKind.MAX_MM: trial.max_mm}.get(self.kind, trial.def_)

    def met_by(self, trial: Trial, motion: Motion) -> bool:
        """Return whether `trial` is within the bound."""
        return trial.bytes <= self.largest_bytes(motion) and (self.bounds_size or self.error(trial) <= self.value)

    def rank(self, motion: Motion) -> Rank:
        """Return the order of trials, the best first; those that miss come after, the nearest first."""

        def key(trial: Trial) -> tuple[float, ...]:
            met, error = self.met_by(trial, motion), self.error(trial)
            error_first = met == self.bounds_size
            wins = (error, float(trial.bytes)) if error_first else (float(trial.bytes), error)
            return 0.0 if met else 1.0, *wins

        return key


def meet(
    evaluator: Evaluator,
    grid: Grid,
    target: Target,
    *,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
    memory: Memory | None = None,
    thorough: bool | None = None,
) -> Outcome:
    """Return the best setting of `grid` for `target`; `target.met_by` says of the best whether it is met.

    `thorough` tries every setting, which is also the default where that takes a second or two. Otherwise each b and n_d
    is looked at where sizes, known beforehand, still leave a hope: error mostly falls as FDF rises.
    """
    rank = target.rank(evaluator.original)
    lattice = Lattice(grid, evaluator)
    n_points = len(lattice.points)
    quick = evaluator.is_fast and n_points * evaluator.original.X.size < _QUICK
    if thorough or n_points == 0 or (thorough is None and quick):  # or a grid without settings
        return exhaustive(evaluator, grid, on_progress=on_progress, cancel=cancel, memory=memory, rank=rank)
    with Attempts(evaluator, rank, budget=n_points, on_progress=on_progress, cancel=cancel, memory=memory) as attempts:
        look = _least_error if target.bounds_size else _fewest_bytes
        look(attempts, lattice, evaluator, target)
        walk_downhill(attempts, lattice)
        return attempts.outcome()


def _least_error(attempts: Attempts, lattice: Lattice, evaluator: Evaluator, target: Target) -> None:
    """Try for each b and n_d the largest FDF within the bound; where there is none at all, the smallest file."""
    largest = target.largest_bytes(evaluator.original)
    sizes = _sizes(lattice, evaluator)
    ends = [max((p for p in line if sizes[p] <= largest), default=None) for line in _lines(lattice)]
    within = [point for point in ends if point]
    attempts.try_all(within or [min(sizes, key=lambda point: sizes[point])][:1])


def _fewest_bytes(attempts: Attempts, lattice: Lattice, evaluator: Evaluator, target: Target) -> None:
    """Try the smallest files first; then halve the FDFs of each b and n_d that can still be smaller than the best."""
    sizes = _sizes(lattice, evaluator)
    smallest = sorted(sizes, key=lambda point: sizes[point])[: budget_for(lattice, evaluator) // 2]
    for start in range(0, len(smallest), _BATCH):
        attempts.try_all(smallest[start : start + _BATCH])
        if attempts.over or _is_met(attempts, evaluator, target):
            return
    for line in sorted(_lines(lattice), key=lambda points: sizes[points[0]]):
        limit = attempts.best.bytes if attempts.best and _is_met(attempts, evaluator, target) else math.inf
        hopeful = [point for point in line if sizes[point] < limit]
        _halve(attempts, hopeful, evaluator, target)


def _halve(attempts: Attempts, line: list[Point], evaluator: Evaluator, target: Target) -> None:
    """Find a small FDF on `line` (ascending) that meets the target: from the top, halving where one of the probes does.

    A large FDF may miss what a smaller one meets: one wild column more in the table, or one less, can decide it.
    """
    probes = spread(list(range(len(line))), _PROBES)
    high = next((place for place in reversed(probes) if _meets(attempts, line[place], evaluator, target)), None)
    low = 0
    while high is not None and low < high and not attempts.over:
        middle = (low + high) // 2
        if _meets(attempts, line[middle], evaluator, target):
            high = middle
        else:
            low = middle + 1


def _is_met(attempts: Attempts, evaluator: Evaluator, target: Target) -> bool:
    best = attempts.best
    return best is not None and target.met_by(best, evaluator.original)


def _meets(attempts: Attempts, point: Point, evaluator: Evaluator, target: Target) -> bool:
    attempts.try_all([point])
    trial = attempts.trials.get(point)
    return trial is not None and target.met_by(trial, evaluator.original)


def _lines(lattice: Lattice) -> Iterator[list[Point]]:
    """Yield for each b and n_d the points, FDF ascending."""
    for line, values in lattice.lines.items():
        yield [(fdf, *line) for fdf in values]


def _sizes(lattice: Lattice, evaluator: Evaluator) -> dict[Point, int]:
    return {point: evaluator.size(*point) for point in lattice.points}
