"""What the codec lab looks through: as wide as there is time for, over the profiles and the encoders that compete."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS, Encoder, QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.compact_search import FRONT_ERRORS_MM, compact_trials
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.grid import Grid, raw_bytes
from qmd_studio.tuning.lab_session import LabSession
from qmd_studio.tuning.pareto import Front, fronts
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.trial import Cancel, Evaluator, Trial

_STEP = 30
_PARTS = (2, 4, 8)
"""Into how many segments of about equal length a motion is cut, beside none."""
_SLOW_FDF_STEP, _SLOW_MAX_BITS = 4, 11
_REDUCED_FDF_STEP, _REDUCED_MAX_BITS = 8, 9
"""Of a slow encoder on less than all of a motion, of which there are many."""


def lab_grid(evaluator: Evaluator) -> Grid:
    """Return the settings to look through: all FDF and b and a few n_d; fewer where an encoder is slow.

    No file may be larger than what is encoded is raw.
    """
    motion = evaluator.motion
    n_rows, n_columns = motion.n_frames - 1, max(motion.skeleton.n_columns, 1)
    limit = raw_bytes(motion)
    if not evaluator.is_fast:
        whole = evaluator.reduction == Reduction()
        step, most = (_SLOW_FDF_STEP, _SLOW_MAX_BITS) if whole else (_REDUCED_FDF_STEP, _REDUCED_MAX_BITS)
        return Grid(tuple(range(0, n_columns, step)), tuple(range(MIN_BITS, most + 1)), (0,), limit)
    segments = {max(_STEP, round(n_rows / parts / _STEP) * _STEP) for parts in _PARTS}
    return Grid(tuple(range(n_columns)), tuple(range(MIN_BITS, MAX_BITS + 1)), (0, *sorted(segments)), limit)


def lab_fronts(motion: Motion, base: QmdSettings, reductions: Sequence[Reduction], cancel: Cancel) -> Iterator[Front]:
    """Yield the Pareto front of DEF over size as it fills in: the compact profile and all encoders of the paper's.

    `base` has the paper's constants. Every one of `reductions` is tried with all of them.
    """
    evaluators = [
        evaluator_for(motion, replace(base, encoder=encoder), reduction)
        for encoder in _COMPETING
        for reduction in reductions
    ]
    n_compact = 2 * len(FRONT_ERRORS_MM) * len(reductions)
    grids = [(evaluator, lab_grid(evaluator)) for evaluator in evaluators]
    return fronts(grids, others=(n_compact, _compact(motion, reductions)), cancel=cancel)


def _compact(motion: Motion, reductions: Sequence[Reduction]) -> Iterator[Trial | None]:
    session = LabSession(motion)
    for reduction in reductions:
        yield from compact_trials(session, reduction)


_COMPETING = tuple(encoder for encoder in Encoder if encoder.value != "bounded")
"""The encoders that take FDF, b and n_d; the bounded one finds these by itself."""
