"""What the coder expects of each integer, compiled: contexts from neighbours, half-octave buckets, adaptive cells.

Everything is integer arithmetic, the same in every decoder; resources/help/qmd-compact.md says it step by step.
Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.codecs.compact.coder import (
    EVEN,
    ByteArray,
    Cells,
    adapt,
    chance,
    decode_bit,
    encode_bit,
)

FIRST_KEY, SECOND_KEY, LATER_KEY, ROW_0, ROW_1, ROW_2, STEP, ROWS = range(8)
"""The classes of integers: keys by what is known before them, coefficients by frequency, step codes, row counts."""

N_CLASSES = 8
N_CONTEXTS = 24
N_BUCKETS = 48
PRIOR_BUCKETS = 16
LARGEST = (1 << 24) - 1
"""The largest magnitude that an integer in a stream may have."""

_QUARTERS = np.arange(1 << (N_CONTEXTS // 2))
_OCTAVES = np.frexp(np.maximum(_QUARTERS, 1))[1] - 1
_CONTEXTS = np.where(_QUARTERS < 2, _QUARTERS, 2 * _OCTAVES + ((_QUARTERS >> np.maximum(_OCTAVES - 1, 0)) & 1))
"""The half octave of each number of quarters: what lies beyond the last is in the last context too."""

SEEN_BEFORE = 24
"""How much a new cell counts as having seen."""


@njit(cache=True, nogil=True)
def new_cells(prior: ByteArray) -> Cells:
    """Return the cells that a stream starts with, from the prior (classes, contexts, 16) in 256ths."""
    cells = np.empty((N_CLASSES * N_CONTEXTS * N_BUCKETS, 2), np.int32)
    cells[:, 0] = EVEN
    cells[:, 1] = SEEN_BEFORE
    for kind in range(len(prior)):
        for context in range(N_CONTEXTS):
            for bucket in range(PRIOR_BUCKETS):
                cells[cell_of(kind, context) + bucket, 0] = prior[kind, context, bucket] << 8
    return cells


@njit(cache=True, nogil=True)
def cell_of(kind: int, context: int) -> int:
    """Return the number of the first of the cells for a class and a context."""
    return (kind * N_CONTEXTS + context) * N_BUCKETS


@njit(cache=True, nogil=True)
def bucket_of(size: int) -> int:
    """Return the half octave in which a magnitude lies: 0, 1, 2, 3, then 4 and 5, 6 and 7, 8 to 11, 12 to 15, …"""
    if size < 4:
        return size
    octave = 2
    while size >> (octave + 1):
        octave += 1
    return 2 * octave + ((size >> (octave - 1)) & 1)


@njit(cache=True, nogil=True)
def context_of(expected: int) -> int:
    """Return the context for 64 times an expected magnitude: half octaves of its quarters."""
    return int(_CONTEXTS[min(expected >> 4, len(_CONTEXTS) - 1)])


@njit(cache=True, nogil=True)
def write_integer(state: IntArray, out: ByteArray, cells: Cells, at: int, value: int) -> None:
    """Write `value`, at most `LARGEST` in size, with the cells from `at` on, which learn it."""
    size = abs(value)
    bucket = bucket_of(size)
    for b in range(min(bucket + 1, N_BUCKETS - 1)):
        more = 1 if b < bucket else 0
        encode_bit(state, out, chance(cells, at + b), more)
        adapt(cells, at + b, more)
    for place in range(bucket // 2 - 2, -1, -1):
        encode_bit(state, out, EVEN, (size >> place) & 1)
    if size:
        encode_bit(state, out, EVEN, 1 if value < 0 else 0)


@njit(cache=True, nogil=True)
def read_integer(state: IntArray, data: ByteArray, cells: Cells, at: int) -> int:
    """Read what `write_integer` wrote."""
    code, width, place = state[0], state[1], state[2]
    bucket = 0
    while bucket < N_BUCKETS - 1:
        more, code, width, place = decode_bit(code, width, place, data, chance(cells, at + bucket))
        adapt(cells, at + bucket, more)
        if not more:
            break
        bucket += 1
    size = bucket
    if bucket >= 4:
        size = 2 + (bucket & 1)
        for _ in range(bucket // 2 - 1):
            bit, code, width, place = decode_bit(code, width, place, data, EVEN)
            size = 2 * size + bit
    if size:
        bit, code, width, place = decode_bit(code, width, place, data, EVEN)
        if bit:
            size = -size
    state[0], state[1], state[2] = code, width, place
    return size


@njit(cache=True, nogil=True)
def expected_key(kind: int, left: int, left2: int, step_before: int, low: int, next_low: int) -> int:
    """Return 64 times the expected magnitude of a column's step from key to key.

    From the steps of the two columns to its left, its own step one key earlier, and the two lowest frequencies of its
    block before.
    """
    if kind == FIRST_KEY:
        return 34 * left + 20 * left2
    if kind == SECOND_KEY:
        return 124 * left + 32 * left2
    return 4 * left + 56 * step_before + 58 * low + 24 * next_low


@njit(cache=True, nogil=True)
def expected_coefficient(sizes: IntArray, before: IntArray, had: bool, step: int, f: int, j: int) -> int:
    """Return 64 times the expected magnitude at frequency row `f`, column `j`.

    `sizes` and `before` (rows + 3, columns + 2) are the magnitudes of this block, as far as they are known, and of the
    block before, if there `had` been one; both start with 2 rows and 2 columns of zeros and end with a row of zeros.
    `step` is the size of the column's step from key to key.
    """
    left, left2 = sizes[f + 2, j + 1], sizes[f + 2, j]
    a, b = sizes[f + 1, j + 2], sizes[f, j + 2]
    if not had:
        if f == 0:
            return int(30 * left + 8 * left2 + 109 * step)
        if f == 1:
            return int(243 * a + 40 * left + 63 * left2 + 83 * step)
        return int(139 * a + 48 * b + 8 * left2)
    below, here, above = before[f + 1, j + 2], before[f + 2, j + 2], before[f + 3, j + 2]
    if f == 0:
        return int(58 * step + 75 * here + 162 * above)
    if f == 1:
        return int(171 * a + 24 * left + 9 * left2 + 53 * step + 281 * here + 480 * above + 17 * below)
    return int(108 * a + 36 * b + 27 * here + 25 * above + 9 * below)


@njit(cache=True, nogil=True)
def price(cells: Cells, at: int, bits: FloatArray, value: int) -> float:
    """Return about how many bits `value` takes with the cells from `at` on.

    `bits` (257,) are those of probabilities in 256ths.
    """
    size = abs(value)
    bucket = bucket_of(size)
    total = 0.0
    for b in range(bucket):
        total += bits[(cells[at + b, 0] + 128) >> 8]
    total += bits[256 - ((cells[at + bucket, 0] + 128) >> 8)]
    if size:
        total += 1 + max(bucket // 2 - 1, 0)
    return float(total)


@njit(cache=True, nogil=True)
def learn(cells: Cells, at: int, value: int) -> None:
    """Let the cells from `at` on learn `value` without writing it."""
    bucket = bucket_of(abs(value))
    for b in range(bucket + 1):
        adapt(cells, at + b, 1 if b < bucket else 0)
