"""The binary range coder, compiled: one decision at a time, each with a probability of 16 bits.

`state` of an encoder is (low, range, bytes written), of a decoder (code, range, bytes read), all int64. Importing this
module imports numba.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from qmd_studio.arrays import IntArray

ByteArray: TypeAlias = NDArray[np.uint8]
Cells: TypeAlias = NDArray[Any]
"""The adaptive models: (cells, 2) int32, the probability of a one in 65,536ths and how much it has seen."""

EVEN = 1 << 15
_LEAST = 48
_MOST_SEEN = 255
_RATES = 327680 // (5 * np.arange(_MOST_SEEN + 1) + 8)
"""What a cell learns of a decision, in 65,536ths, by what it has seen: a division would cost more than all the rest."""

_WORD = (1 << 32) - 1
_NARROW = 1 << 24
_BEYOND = 4
"""The bytes a decoder may read past the end, as zeros: it reads four ahead."""


@njit(cache=True, nogil=True)
def new_encoder() -> IntArray:
    """Return the state of an encoder that has written nothing."""
    return np.array([0, _WORD, 0], dtype=np.int64)


@njit(cache=True, nogil=True)
def encode_bit(state: IntArray, out: ByteArray, one: int, bit: int) -> None:
    """Write a decision whose chance of being 1 is `one` / 65,536."""
    bound = (state[1] >> 16) * one
    if bit:
        state[1] = bound
    else:
        state[0] += bound
        state[1] -= bound
        if state[0] > _WORD:
            state[0] &= _WORD
            _carry(out, state[2])
    while state[1] < _NARROW:
        out[state[2]] = state[0] >> 24
        state[2] += 1
        state[0] = (state[0] << 8) & _WORD
        state[1] <<= 8


@njit(cache=True, nogil=True)
def finish(state: IntArray, out: ByteArray) -> int:
    """Write what the last decisions still need and return the length; a decoder reads zeros past the end."""
    for n_bytes in range(5):
        rest = (1 << (32 - 8 * n_bytes)) - 1
        low = (state[0] + rest) & ~rest
        if low < state[0] + state[1]:
            break
    if low > _WORD:
        low &= _WORD
        _carry(out, state[2])
    for byte in range(n_bytes):
        out[state[2]] = (low >> (24 - 8 * byte)) & 255
        state[2] += 1
    return int(state[2])


@njit(cache=True, nogil=True)
def _carry(out: ByteArray, end: int) -> None:
    at = end - 1
    while out[at] == 255:
        out[at] = 0
        at -= 1
    out[at] += 1


@njit(cache=True, nogil=True)
def new_decoder(data: ByteArray) -> IntArray:
    """Return the state of a decoder at the start of `data`."""
    code = 0
    for at in range(4):
        code = (code << 8) | (data[at] if at < len(data) else 0)
    return np.array([code, _WORD, 4], dtype=np.int64)


@njit(cache=True, nogil=True)
def decode_bit(code: int, width: int, at: int, data: ByteArray, one: int) -> tuple[int, int, int, int]:
    """Read a decision whose chance of being 1 is `one` / 65,536.

    A decoder's state comes and goes as plain numbers, which stay in registers. Returns the bit and the state.
    """
    bound = (width >> 16) * one
    if code < bound:
        width = bound
        bit = 1
    else:
        code -= bound
        width -= bound
        bit = 0
    while width < _NARROW:
        code = (code << 8) | (data[np.uint64(at)] if at < len(data) else 0)
        width <<= 8
        at += 1
    return bit, code, width, at


@njit(cache=True, nogil=True)
def overrun(state: IntArray, data: ByteArray) -> bool:
    """Return whether a decoder has read more than an encoder can have written."""
    return bool(state[2] > len(data) + _BEYOND)


@njit(cache=True, nogil=True)
def chance(cells: Cells, at: int) -> int:
    """Return the probability of a one that cell number `at` stands for, never quite 0 or 1."""
    return int(min(max(cells[at, 0], _LEAST), (1 << 16) - _LEAST))


@njit(cache=True, nogil=True)
def adapt(cells: Cells, at: int, bit: int) -> None:
    """Let cell number `at` learn a decision, the less the more it has seen."""
    rate = _RATES[cells[at, 1]]
    if bit:
        cells[at, 0] += ((65536 - cells[at, 0]) * rate) >> 16
    else:
        cells[at, 0] -= (cells[at, 0] * rate) >> 16
    if cells[at, 1] < _MOST_SEEN:
        cells[at, 1] += 1
