"""How much the joints mind an error of each column: normal matrices along a motion, and steps to match."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import cholesky

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.codecs.compact.layout import key_frames, n_segments
from qmd_studio.codecs.qmd.units import column_scales
from qmd_studio.motion.motion import Motion

_EVERY = 2
"""Every so many frames of a block are looked at: the matrix changes slowly."""

_MOST_MATRICES = 4000
"""Of a motion of more blocks than this, neighbours share one, so that a million frames fit into memory."""

_FLOOR = 1e-4
"""Added to the diagonal: columns that move nothing get a finite step, and no matrix is singular."""

_LEAST_SENSITIVE = 8
"""Columns below this percentile of sensitivity get its step: what is coarser costs no less and looks worse."""

_CODES = 255
_CODE_OF_ONE = 192
_VALUES_IN_STEP = 20
"""No step is finer than 2^-20 of its column's largest value."""


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivity:
    """A segment (frames `start` to `end`, keys `at`) and the matrices of its blocks, (m, m) squared ASF units each."""

    start: int
    end: int
    at: IntArray
    blocks: tuple[FloatArray, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FrameMatrices:
    """The matrices of single frames of a segment, made when they are asked for.

    `rows` (n_frames, n_columns) are its columns in the skeleton's own units.
    """

    motion: Motion
    rows: FloatArray

    def between(self, start: int, end: int) -> FloatArray:
        """Return (k, m, m) squared ASF units: the matrices of every second frame from `start` to `end`."""
        from qmd_studio.motion.sensitivity import sensitivities as matrices

        found = matrices(self.motion.skeleton, self.rows[start : end + 1 : _EVERY])
        diagonal = np.arange(found.shape[1])
        found[:, diagonal, diagonal] += _FLOOR
        return found


def sensitivities(motion: Motion, *, segment: int, block: int) -> tuple[Sensitivity, ...]:
    """Return the matrices of every segment of a motion; a segment of one frame has one for that frame."""
    from qmd_studio.motion.sensitivity import sensitivities as matrices  # compiled code, loaded where it is needed

    rows = motion.X / column_scales(motion.skeleton)
    length = segment or motion.n_frames
    shared = 1 + motion.n_frames // block // _MOST_MATRICES
    found = []
    for number in range(n_segments(motion.n_frames, segment)):
        start = number * length
        end = min(start + length, motion.n_frames)
        at = key_frames(end - start, block)
        spans = [(start + int(a), start + int(b) + 1) for a, b in pairwise(at)] or [(start, end)]
        blocks: list[FloatArray] = []
        for number_in, (first, last) in enumerate(spans):
            if number_in % shared:
                blocks.append(blocks[-1])
                continue
            H = matrices(motion.skeleton, rows[first:last:_EVERY]).mean(axis=0)
            H[np.diag_indices_from(H)] += _FLOOR
            blocks.append(H)
        found.append(Sensitivity(start, end, at, tuple(blocks)))
    return tuple(found)


def relative_steps(parts: tuple[Sensitivity, ...]) -> FloatArray:
    """Return (m,) steps that all cost the joints the same, one column's given those after it."""
    every = [H for part in parts for H in part.blocks]
    mean = sum(every[1:], every[0]) / len(every)
    sensitivity = np.diag(cholesky(mean, lower=True))
    steps: FloatArray = 1 / np.maximum(sensitivity, np.percentile(sensitivity, _LEAST_SENSITIVE))
    return steps


def step_codes(steps: FloatArray, largest: FloatArray) -> IntArray:
    """Return the codes (m,) nearest to steps, none too fine for columns whose largest magnitudes are `largest`."""
    finest = np.ldexp(np.maximum(largest, 1e-30), -_VALUES_IN_STEP)
    codes = np.maximum(np.rint(8 * np.log2(steps)), np.ceil(8 * np.log2(finest)))
    whole: IntArray = np.clip(codes + _CODE_OF_ONE, 0, _CODES).astype(np.int64)
    return whole
