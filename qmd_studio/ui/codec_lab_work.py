"""The long work of the codec lab's plots and searches, as `Background` runs it; nothing here touches a widget."""

from __future__ import annotations

import time
from dataclasses import replace
from threading import Event
from typing import TYPE_CHECKING, Any

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.ui.background import Tell, Work
from qmd_studio.ui.libraries import IMPORTING

if TYPE_CHECKING:
    from collections.abc import Callable

    from qmd_studio.tuning.outcome import OnProgress, Outcome
    from qmd_studio.tuning.pareto import Front
    from qmd_studio.tuning.targets import Target
    from qmd_studio.tuning.trial import Trial

TELL_EVERY_S = 0.1
"""Whoever looks on needs no more than this, and the window has other things to do."""


def import_plots(_stop: Event, _tell: Tell) -> None:
    """Import what draws plots, which takes a third of a second that the window shall not wait."""
    with IMPORTING:
        import qmd_studio.ui.plot  # noqa: F401


def sweep_work(motion: Motion, base: QmdSettings, reduction: Reduction, known: list[Trial]) -> Work:
    """Return the work that tells lists of `Trial` for Figure 6, all that are known so far; at last all."""

    def work(stop: Event, tell: Tell) -> list[Trial]:
        from qmd_studio.tuning.evaluator import evaluator_for  # compiled kernels come with it
        from qmd_studio.tuning.sweep import sweep

        trials, there = list(known), {trial.paper.fdf for trial in known}
        if len(there) == max(reduction.n_columns(motion.skeleton), 1):
            return trials
        often = _Seldom(tell)
        for latest in sweep(evaluator_for(motion, base, reduction), base.segment, known=there, cancel=stop):
            trials += latest
            often(list(trials))
        return trials

    return work


def front_work(motion: Motion, base: QmdSettings, *, reduced: bool) -> Work:
    """Return the work that tells a `Front` as it fills in; at last the whole one. `reduced` tries fewer frames too."""

    def work(stop: Event, tell: Tell) -> Front | None:
        from qmd_studio.tuning.trade_off import lab_fronts

        front, often = None, _Seldom(tell)
        for front in lab_fronts(motion, base, _reductions(motion, Reduction(), reduced=reduced), stop):
            often(front)
        return front

    return work


def target_work(motion: Motion, base: EncodeSettings, target: Target, *, reduced: bool) -> Work:
    """Return the work that tells `Progress` and comes to the `Outcome` of a search for `target`.

    The profile and the encoder are those of `base`, and so is what is left out unless `reduced` tries more.
    """

    def work(stop: Event, tell: Tell) -> Outcome:
        from qmd_studio.tuning.across import across

        often = _Seldom(tell)
        reductions = _reductions(motion, base.reduction, reduced=reduced)
        searches = [_search(motion, replace(base, reduction=reduction), target, stop) for reduction in reductions]
        return across(searches, rank=target.rank(motion), on_progress=often, cancel=stop)

    return work


def _search(motion: Motion, base: EncodeSettings, target: Target, stop: Event) -> Callable[[OnProgress], Outcome]:
    """Return the search for `target` in what `base` is: the compact profile, a bound, or a grid of one encoder."""
    from qmd_studio.tuning.compact_search import meet_bounded, meet_compact
    from qmd_studio.tuning.evaluator import evaluator_for
    from qmd_studio.tuning.targets import TargetKind, meet
    from qmd_studio.tuning.trade_off import lab_grid

    def search(tell: OnProgress) -> Outcome:
        if base.paper is None:
            return meet_compact(motion, base, target, on_progress=tell, cancel=stop)
        if base.is_bounded and target.kind is TargetKind.MAX_MM:
            return meet_bounded(motion, base, target, cancel=stop)
        coding = replace(base.paper, encoder=Encoder.CLOSED) if base.is_bounded else base.paper
        evaluator = evaluator_for(motion, coding, base.reduction)
        return meet(evaluator, lab_grid(evaluator), target, on_progress=tell, cancel=stop)

    return search


def _reductions(motion: Motion, own: Reduction, *, reduced: bool) -> tuple[Reduction, ...]:
    from qmd_studio.tuning.reductions import distinct, lab_reductions

    return distinct((own, *lab_reductions(motion)), motion) if reduced else (own,)


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
