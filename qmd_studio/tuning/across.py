"""One search over several reductions: each is searched for itself, the best of all is the answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from qmd_studio.tuning.attempts import Rank, by_merit
from qmd_studio.tuning.outcome import OnProgress, Outcome, Progress
from qmd_studio.tuning.trial import Cancel, Never, Trial

Search: TypeAlias = Callable[[OnProgress], Outcome]
"""A search that tells how far it is."""


def across(
    searches: Sequence[Search],
    *,
    rank: Rank = by_merit,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> Outcome:
    """Run `searches` one after the other and return what they came to together, the best by `rank`.

    What is to come is reckoned, while it runs, at what the present search has. `cancel` ends it early.
    """
    cancel, told = cancel or Never(), on_progress or _tell_nobody
    outcomes: list[Outcome] = []
    done, best = 0, None
    for number, search in enumerate(searches):
        if cancel.is_set():
            break
        tell = _offset(told, done, len(searches) - number, best, rank)
        outcomes.append(search(tell))
        done += len(outcomes[-1].trials)
        best = min([trial for trial in (best, outcomes[-1].best) if trial], key=rank, default=None)
    return Outcome(
        best=best,
        trials=tuple(trial for outcome in outcomes for trial in outcome.trials),
        evaluations=sum(outcome.evaluations for outcome in outcomes),
        seconds=sum(outcome.seconds for outcome in outcomes),
        complete=len(outcomes) == len(searches) and all(outcome.complete for outcome in outcomes),
    )


def _offset(tell: OnProgress, before: int, left: int, best: Trial | None, rank: Rank) -> OnProgress:
    """Return what tells the progress of one search as part of the whole, `left` searches from its end."""

    def tell_all(progress: Progress) -> None:
        better = min([trial for trial in (best, progress.best) if trial], key=rank, default=None)
        tell(Progress(before + progress.done, before + left * progress.total, better, progress.latest))

    return tell_all


def _tell_nobody(_progress: Progress) -> None:
    pass
