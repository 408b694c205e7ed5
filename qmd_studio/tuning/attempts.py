"""The trials of a search that tries settings one after another: counted, remembered, ranked, and stopped in time."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Self, TypeAlias

from qmd_studio.tuning.lattice import Point
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import OnProgress, Outcome, Progress
from qmd_studio.tuning.running import THREAD_NAME
from qmd_studio.tuning.trial import Cancel, Evaluator, Never, Trial

Rank: TypeAlias = Callable[[Trial], tuple[float, ...]]
"""What is to be least."""


def by_merit(trial: Trial) -> tuple[float, ...]:
    """Rank by the paper's figure of merit, bytes times DEF; fewer bytes first where that is equal."""
    return trial.merit, trial.bytes


class Attempts:
    """Tries points while the `budget` lasts and nobody cancels; a context that ends its threads when it is left.

    Points that were tried before, here or in `memory`, cost nothing of the budget. Left by Ctrl+C it does not wait for
    what its threads are encoding: that takes long for a long motion, and the program ends.
    """

    def __init__(
        self,
        evaluator: Evaluator,
        rank: Rank,
        *,
        budget: int,
        on_progress: OnProgress | None = None,
        cancel: Cancel | None = None,
        memory: Memory | None = None,
    ) -> None:
        self.rank, self.budget, self.evaluations = rank, budget, 0
        self.trials: dict[Point, Trial] = {}
        self._evaluator, self._on_progress = evaluator, on_progress
        self._cancel, self._memory = cancel or Never(), memory or Memory(evaluator)
        self._pool = ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix=THREAD_NAME)
        self._started = time.perf_counter()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pool.shutdown(wait=not (kind and issubclass(kind, KeyboardInterrupt)), cancel_futures=True)
        self._memory.save()

    @property
    def over(self) -> bool:
        """Whether nothing more may be tried."""
        return self._cancel.is_set() or self.evaluations >= self.budget

    @property
    def best(self) -> Trial | None:
        """The best so far."""
        return min(self.trials.values(), key=self.rank, default=None)

    def ranked(self) -> list[Point]:
        """Return the points tried, the best first."""
        return sorted(self.trials, key=lambda point: self.rank(self.trials[point]))

    def try_all(self, points: Iterable[Point]) -> None:
        """Try `points`, as far as the budget goes, on all cores."""
        fresh = [point for point in dict.fromkeys(points) if point not in self.trials]
        known = {point: trial for point in fresh if (trial := self._memory.get(*point))}
        self.trials |= known
        self._tell(list(known.values()))
        fresh = [point for point in fresh if point not in known][: max(0, self.budget - self.evaluations)]
        for point, trial in zip(fresh, self._pool.map(self._one, fresh), strict=True):
            if trial is not None:
                self.trials[point] = trial
                self.evaluations += 1
                self._memory.add([trial])
                self._tell([trial])

    def outcome(self) -> Outcome:
        """Return what has been found; complete unless it was cancelled."""
        return Outcome(
            best=self.best,
            trials=tuple(self.trials.values()),
            evaluations=self.evaluations,
            seconds=time.perf_counter() - self._started,
            complete=not self._cancel.is_set(),
        )

    def _tell(self, latest: list[Trial]) -> None:
        if latest and self._on_progress:
            self._on_progress(Progress(self.evaluations, self.budget, self.best, tuple(latest)))

    def _one(self, point: Point) -> Trial | None:
        if self._cancel.is_set():
            return None
        fdf, bits, segment = point
        return self._evaluator.try_bits(fdf, segment, (bits,))[0]
