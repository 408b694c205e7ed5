"""The long work of the codec lab's plots and searches, as `Background` runs it; nothing here touches a widget."""

from __future__ import annotations

import time
from threading import Event
from typing import TYPE_CHECKING, Any

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.ui.background import Tell, Work

if TYPE_CHECKING:
    from qmd_studio.tuning.outcome import Outcome, Progress
    from qmd_studio.tuning.pareto import Front
    from qmd_studio.tuning.targets import Target
    from qmd_studio.tuning.trial import Trial

TELL_EVERY_S = 0.1
"""Whoever looks on needs no more than this, and the window has other things to do."""


def import_plots(_stop: Event, _tell: Tell) -> None:
    """Import what draws plots, which takes a third of a second that the window shall not wait."""
    import qmd_studio.ui.plot  # noqa: F401


def sweep_work(motion: Motion, base: QmdSettings, known: list[Trial]) -> Work:
    """Return the work that tells lists of `Trial` for Figure 6, all that are known so far; at last all."""

    def work(stop: Event, tell: Tell) -> list[Trial]:
        from qmd_studio.tuning.evaluator import evaluator_for  # compiled kernels come with it
        from qmd_studio.tuning.sweep import sweep

        trials, there = list(known), {trial.settings.fdf for trial in known}
        if len(there) == max(motion.skeleton.n_columns, 1):
            return trials
        often = _Seldom(tell)
        for latest in sweep(evaluator_for(motion, base), base.segment, known=there, cancel=stop):
            trials += latest
            often(list(trials))
        return trials

    return work


def front_work(motion: Motion, base: QmdSettings) -> Work:
    """Return the work that tells a `Front` as it fills in; at last the whole one."""

    def work(stop: Event, tell: Tell) -> Front | None:
        from qmd_studio.tuning.trade_off import lab_fronts

        front, often = None, _Seldom(tell)
        for front in lab_fronts(motion, base, stop):
            often(front)
        return front

    return work


def target_work(motion: Motion, base: QmdSettings, target: Target) -> Work:
    """Return the work that tells `Progress` and comes to the `Outcome` of a search for `target`."""

    def work(stop: Event, tell: Tell) -> Outcome:
        from qmd_studio.tuning.evaluator import evaluator_for
        from qmd_studio.tuning.targets import meet
        from qmd_studio.tuning.trade_off import lab_grid

        evaluator, often = evaluator_for(motion, base), _Seldom(tell)

        def on_progress(progress: Progress) -> None:
            often(progress)

        return meet(evaluator, lab_grid(evaluator), target, on_progress=on_progress, cancel=stop)

    return work


def paper_optimum_work(motion: Motion, base: QmdSettings) -> Work:
    """Return the work that comes to the `Outcome` of the paper's exhaustive search over the paper's grid."""

    def work(stop: Event, _tell: Tell) -> Outcome:
        from qmd_studio.tuning.evaluator import evaluator_for
        from qmd_studio.tuning.exhaustive import exhaustive
        from qmd_studio.tuning.grid import paper_grid

        return exhaustive(evaluator_for(motion, base), paper_grid(motion), cancel=stop)

    return work


class _Seldom:
    """Tells the first and then what comes `TELL_EVERY_S` after the last told."""

    def __init__(self, tell: Tell) -> None:
        self._tell, self._last = tell, 0.0

    def __call__(self, value: Any) -> None:
        now = time.monotonic()
        if now - self._last >= TELL_EVERY_S:
            self._last = now
            self._tell(value)
