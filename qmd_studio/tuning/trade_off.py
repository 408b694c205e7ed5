"""What the codec lab looks through: a grid that is as wide as there is time for, over the encoders that compete."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS, Encoder, QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.grid import Grid, raw_bytes
from qmd_studio.tuning.pareto import Front, fronts
from qmd_studio.tuning.trial import Cancel, Evaluator

_STEP = 30
_PARTS = (2, 4, 8)
"""Into how many segments of about equal length a motion is cut, beside none."""
_SLOW_FDF_STEP, _SLOW_MAX_BITS = 4, 11


def lab_grid(evaluator: Evaluator) -> Grid:
    """Return the settings to look through: all FDF and b and a few n_d; fewer where an encoder is slow.

    No file may be larger than the raw motion.
    """
    motion = evaluator.motion
    n_rows, n_columns = motion.n_frames - 1, max(motion.skeleton.n_columns, 1)
    limit = raw_bytes(motion)
    if not evaluator.is_fast:
        return Grid(tuple(range(0, n_columns, _SLOW_FDF_STEP)), tuple(range(MIN_BITS, _SLOW_MAX_BITS + 1)), (0,), limit)
    segments = {max(_STEP, round(n_rows / parts / _STEP) * _STEP) for parts in _PARTS}
    return Grid(tuple(range(n_columns)), tuple(range(MIN_BITS, MAX_BITS + 1)), (0, *sorted(segments)), limit)


def lab_fronts(motion: Motion, base: QmdSettings, cancel: Cancel) -> Iterator[Front]:
    """Yield the Pareto front of DEF over size as it fills in, over all encoders; `base` has the paper's constants."""
    evaluators = [evaluator_for(motion, replace(base, encoder=encoder)) for encoder in _COMPETING]
    return fronts([(evaluator, lab_grid(evaluator)) for evaluator in evaluators], cancel=cancel)


_COMPETING = tuple(encoder for encoder in Encoder if encoder.value != "bounded")
"""The encoders that take FDF, b and n_d; the bounded one finds these by itself."""
