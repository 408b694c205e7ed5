"""The paper's Figures 5 and 6 for one motion: size and DEF over FDF, a line for each b, the coarse shape first."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.grid import Column
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.running import run_columns
from qmd_studio.tuning.trial import Cancel, Evaluator, Trial

FIGURE_BITS = (8, 9, 10, 11)
"""The index widths of the paper's figures."""

_FIRST_STEP = 16
_KB = 1024
_LEAST_DEF = 1e-5
"""Smaller errors are drawn as this one: the last columns' would squeeze all others together."""


def size_lines(motion: Motion, segment: int, reduction: Reduction | None = None) -> dict[int, list[float]]:
    """Return for each b the payload in KB (of 1024 bytes) at FDF 0, 1, … to the number of columns that are left."""
    reduction = reduction or Reduction()
    n_rows, n_columns = reduction.n_rows(motion.n_frames), reduction.n_columns(motion.skeleton)
    return {
        bits: [payload_size(n_rows, n_columns, fdf, bits, segment).bytes / _KB for fdf in range(n_columns + 1)]
        for bits in FIGURE_BITS
    }


def sweep(
    evaluator: Evaluator, segment: int, *, known: Collection[int] = (), cancel: Cancel | None = None
) -> Iterator[list[Trial]]:
    """Yield the trials of one FDF after the other, of all b of the figures, till all below m but the `known` have come.

    One thread works, so that whoever looks on is not made to wait. `cancel` ends it early.
    """
    order = coarse_first(evaluator.motion.skeleton.n_columns)
    columns = [Column(fdf, segment, FIGURE_BITS) for fdf in order if fdf not in known]
    return run_columns(evaluator, columns, cancel=cancel, n_threads=1)


def coarse_first(n_columns: int) -> list[int]:
    """Return the FDFs from 0 to `n_columns` - 1: the ends and every 16th first, then those between."""
    order = dict.fromkeys([*range(0, n_columns, _FIRST_STEP), max(n_columns - 1, 0)])
    step = _FIRST_STEP
    while step > 1:
        step //= 2
        order |= dict.fromkeys(range(0, n_columns, step))
    return list(order)


def def_lines(trials: Sequence[Trial]) -> dict[int, list[tuple[float, float]]]:
    """Return for each b the points (FDF, DEF) tried so far, FDF ascending, DEF held above what can be drawn."""
    lines: dict[int, list[tuple[float, float]]] = {bits: [] for bits in FIGURE_BITS}
    for trial in sorted(trials, key=lambda t: t.paper.fdf):
        lines[trial.paper.bits].append((float(trial.paper.fdf), drawn_def(trial.def_)))
    return lines


def drawn_def(def_: float) -> float:
    """Return where a DEF is drawn on a logarithmic axis."""
    return max(def_, _LEAST_DEF)
