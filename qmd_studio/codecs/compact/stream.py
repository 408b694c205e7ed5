"""A segment's integers to a stream of bytes and back, compiled. Importing this module imports numba.

The key poses are (keys, m) integers in half steps, the coefficients of all blocks lie one under the other in (rows, m).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from qmd_studio.arrays import IntArray
from qmd_studio.codecs.compact.coder import ByteArray, finish, new_decoder, new_encoder, overrun
from qmd_studio.codecs.compact.model import (
    FIRST_KEY,
    LATER_KEY,
    ROW_0,
    ROWS,
    SECOND_KEY,
    STEP,
    cell_of,
    context_of,
    expected_coefficient,
    expected_key,
    new_cells,
    read_integer,
    write_integer,
)

OK, ENDS_EARLY, OUT_OF_RANGE = 0, 1, 2
LARGEST_KEY = 1 << 30
"""The largest size of a number in a key pose."""

NO_SIZES = np.zeros((4, 0), np.int64)
START = 16
_FIRST_STEP = 128
_BYTES_AN_INTEGER = 64
"""The bytes that no integer takes: 47 decisions of at most 10.5 bits each, and 23 even ones."""


@njit(cache=True, nogil=True)
def write_prelude(prior: ByteArray, steps: IntArray, pose: IntArray) -> ByteArray:
    """Return the stream of the columns' step codes (m,) and the reference pose (m,)."""
    m = len(steps)
    cells, state = new_cells(prior), new_encoder()
    out = np.zeros(_BYTES_AN_INTEGER * 2 * m + 64, np.uint8)
    last = _FIRST_STEP
    for j in range(m):
        write_integer(state, out, cells, cell_of(STEP, 0), steps[j] - last)
        last = steps[j]
    nothing = np.zeros(m, np.int64)
    write_key(state, out, cells, pose, (nothing, nothing, NO_SIZES), FIRST_KEY)
    return out[: finish(state, out)].copy()


@njit(cache=True, nogil=True)
def read_prelude(prior: ByteArray, data: ByteArray, steps: IntArray, pose: IntArray) -> int:
    """Fill in `steps` and `pose` (m,) from a stream; return OK or what is wrong with it."""
    m = len(steps)
    cells, state = new_cells(prior), new_decoder(data)
    last = _FIRST_STEP
    for j in range(m):
        last += read_integer(state, data, cells, cell_of(STEP, 0))
        if not 0 <= last <= 255:
            return OUT_OF_RANGE
        if overrun(state, data):
            return ENDS_EARLY
        steps[j] = last
    nothing = np.zeros(m, np.int64)
    return int(read_key(state, data, cells, pose, (nothing, nothing, NO_SIZES), FIRST_KEY))


@njit(cache=True, nogil=True)
def write_key(state, out, cells, key, known, kind):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Write a key pose (m,); `known` are the key before, its step from the one before it, and its block's sizes."""
    last, step_before, sizes = known
    left = left2 = START
    for j in range(len(key)):
        low, next_low = (sizes[2, j + 2], sizes[3, j + 2]) if kind == LATER_KEY else (0, 0)
        context = context_of(expected_key(kind, left, left2, abs(step_before[j]), low, next_low))
        step = key[j] - last[j]
        write_integer(state, out, cells, cell_of(kind, context), step)
        left, left2 = abs(step), left


@njit(cache=True, nogil=True)
def read_key(state, data, cells, key, known, kind):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Read what `write_key` wrote into `key` (m,); return OK or what is wrong."""
    last, step_before, sizes = known
    left = left2 = START
    for j in range(len(key)):
        low, next_low = (sizes[2, j + 2], sizes[3, j + 2]) if kind == LATER_KEY else (0, 0)
        context = context_of(expected_key(kind, left, left2, abs(step_before[j]), low, next_low))
        step = read_integer(state, data, cells, cell_of(kind, context))
        key[j] = last[j] + step
        if abs(key[j]) > LARGEST_KEY:
            return OUT_OF_RANGE
        if overrun(state, data):
            return ENDS_EARLY
        left, left2 = abs(step), left
    return OK


@njit(cache=True, nogil=True)
def write_segment(
    prior: ByteArray, pose: IntArray, at: IntArray, keys: IntArray, rows: IntArray, first: bool
) -> ByteArray:
    """Return the stream of a segment whose keys (k, m) lie `at` (k,) and whose blocks' coefficients are `rows`.

    `rows` (frames that are not keys, m) holds block after block. `first` says that the first key is `pose`.
    """
    n_keys, m = keys.shape
    cells, state = new_cells(prior), new_encoder()
    out = np.zeros(_BYTES_AN_INTEGER * m + 64, np.uint8)
    sizes, before = new_sizes(at, m), new_sizes(at, m)
    step, nothing = np.zeros(m, np.int64), np.zeros(m, np.int64)
    if not first:
        write_key(state, out, cells, keys[0], (pose, nothing, before), FIRST_KEY)
    used_before = 0
    for i in range(1, n_keys):
        room = state[2] + _BYTES_AN_INTEGER * (m * (at[i] - at[i - 1]) + 1)
        if room > len(out):
            longer = np.zeros(2 * room, np.uint8)
            longer[: len(out)] = out
            out = longer
        write_key(state, out, cells, keys[i], (keys[i - 1], step, before), LATER_KEY if i > 1 else SECOND_KEY)
        step = keys[i] - keys[i - 1]
        block = rows[at[i - 1] - i + 1 : at[i] - i]
        if not len(block):
            continue
        used = len(block)
        while used > 0 and not block[used - 1].any():
            used -= 1
        write_integer(state, out, cells, cell_of(ROWS, 0), used - used_before)
        used_before = used
        sizes[:] = 0
        for f in range(used):
            kind = ROW_0 + min(f, 2)
            for j in range(m):
                context = context_of(expected_coefficient(sizes, before, i > 1, abs(step[j]), f, j))
                write_integer(state, out, cells, cell_of(kind, context), block[f, j])
                sizes[f + 2, j + 2] = abs(block[f, j])
        sizes, before = before, sizes
    return out[: finish(state, out)].copy()


@njit(cache=True, nogil=True)
def read_segment(
    prior: ByteArray, data: ByteArray, pose: IntArray, at: IntArray, keys: IntArray, rows: IntArray, first: bool
) -> int:
    """Fill in `keys` and `rows` (all zeros before) from what `write_segment` wrote; return OK or what is wrong."""
    n_keys, m = keys.shape
    cells, state = new_cells(prior), new_decoder(data)
    sizes, before = new_sizes(at, m), new_sizes(at, m)
    step, nothing = np.zeros(m, np.int64), np.zeros(m, np.int64)
    keys[0] = pose
    if not first:
        wrong = read_key(state, data, cells, keys[0], (pose, nothing, before), FIRST_KEY)
        if wrong:
            return int(wrong)
    used = 0
    for i in range(1, n_keys):
        known = (keys[i - 1], step, before)
        wrong = read_key(state, data, cells, keys[i], known, LATER_KEY if i > 1 else SECOND_KEY)
        if wrong:
            return int(wrong)
        step = keys[i] - keys[i - 1]
        block = rows[at[i - 1] - i + 1 : at[i] - i]
        if not len(block):
            continue
        used += read_integer(state, data, cells, cell_of(ROWS, 0))
        if not 0 <= used <= len(block):
            return OUT_OF_RANGE
        sizes[:] = 0
        for f in range(used):
            kind = ROW_0 + min(f, 2)
            for j in range(m):
                context = context_of(expected_coefficient(sizes, before, i > 1, abs(step[j]), f, j))
                value = read_integer(state, data, cells, cell_of(kind, context))
                block[f, j] = value
                sizes[f + 2, j + 2] = abs(value)
            if overrun(state, data):
                return ENDS_EARLY
        sizes, before = before, sizes
    return OK


@njit(cache=True, nogil=True)
def new_sizes(at: IntArray, m: int) -> IntArray:
    """Return room for the magnitudes of the longest block, with the zeros around it that contexts look at."""
    longest = 0
    for i in range(1, len(at)):
        longest = max(longest, at[i] - at[i - 1])
    return np.zeros((longest + 3, m + 2), np.int64)
