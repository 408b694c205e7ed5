"""Integers back to columns: a ramp between key poses, and sines on it. Exact in any order, so equal on any machine.

All sums are integers below 2^53 in size and so exact in double precision too, in whatever order they are added. The one
rounding is that of the sum to float32 and of its product with the step. Importing this module imports numba.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numba import njit

from qmd_studio.arrays import Float32Array, FloatArray, IntArray

STEP_OCTAVES = 24
"""Step code 8 · `STEP_OCTAVES` is 1; each code more is an eighth of an octave more."""

_FRACTION_BITS = 20
_ONE = 1 << _FRACTION_BITS
_HALF = _ONE // 2
_EIGHTHS = np.array([2 ** (i / 8) for i in range(8)], dtype=np.float32)


def step_sizes(codes: IntArray) -> Float32Array:
    """Return the steps (m,) that step codes 0 to 255 stand for, radians and ASF units: 2^((code - 192) / 8)."""
    sizes: Float32Array = np.ldexp(_EIGHTHS[codes & 7], (codes >> 3) - STEP_OCTAVES).astype(np.float32)
    return sizes


@cache
def sines(length: int) -> FloatArray:
    """Return (length - 1, length - 1) the sines of a block of that many frames, as integers: 2^20 is one.

    Row f - 1, frame t - 1: sqrt(2 / length) · sin(pi · f · t / length). No product comes near a tie, so that any good
    sine rounds to the same integers.
    """
    number = np.arange(1, length)
    turned = np.outer(number, number) % (2 * length)
    table: FloatArray = np.rint(_ONE * math.sqrt(2 / length) * np.sin(np.pi * turned / length))
    table.flags.writeable = False
    return table


def synthesise(at: IntArray, keys: IntArray, rows: IntArray, steps: Float32Array) -> Float32Array:
    """Return a segment (frames, m) float32, radians and ASF units, from what its stream holds."""
    sums = np.empty((int(at[-1]) + 1, keys.shape[1]))
    sums[0] = keys[0] * _HALF
    for i in range(1, len(at)):
        start, end = int(at[i - 1]), int(at[i])
        _add_block(keys[i - 1], keys[i], rows[start - i + 1 : end - i], sines(end - start), sums[start + 1 : end + 1])
    scale = np.ldexp(steps, -_FRACTION_BITS).astype(np.float32)
    decoded: Float32Array = sums.astype(np.float32)
    decoded *= scale
    return decoded


@njit(cache=True, nogil=True)
def _add_block(start: IntArray, end: IntArray, rows: IntArray, table: FloatArray, sums: FloatArray) -> None:
    """Fill in `sums` (length, m) for the frames after the key `start`, the key `end` included."""
    length, m = sums.shape
    for t in range(length):
        along = (_ONE * (t + 1) + length) // (2 * length)
        for j in range(m):
            sums[t, j] = start[j] * _HALF + (end[j] - start[j]) * along
    amount = np.empty(m)
    for f in range(length - 1):
        row = rows[f]
        if not row.any():
            continue
        for j in range(m):
            amount[j] = row[j]
        for t in range(length - 1):
            sine = table[f, t]
            for j in range(m):
                sums[t, j] += amount[j] * sine
