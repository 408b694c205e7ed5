"""Rows of decimal numbers to a matrix, compiled: the fast way for large, well-formed blocks of text."""

from __future__ import annotations

from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.compiled import compiled

_POWERS = np.array([float(f"1e{n}") for n in range(23)])
"""The powers of ten that a double holds exactly."""
_EXACT = 1 << 53
_MOST_DIGITS = 18
_ODD_SHARE = 8
"""Where more than one number in so many has no short exact way, the general reader is as good."""


def parse_even_rows(data: bytes, n_columns: int, start: int = 0) -> FloatArray | None:
    """Return the matrix (n_rows, n_columns) of lines that hold `n_columns` numbers each, from byte `start` on.

    Every number is rounded right. Returns None for anything else, such as a word that is no number or a line of
    another length: the general reader then says what is wrong and where.
    """
    if data[-1:] not in (b"\n", b"\r"):
        data += b"\n"  # a line end stops every loop of the kernel
    text = np.frombuffer(data, dtype=np.uint8)
    n_lines = sum(int(np.count_nonzero(text[start:] == end)) for end in b"\n\r")  # bytes.count is ten times as slow
    values = np.empty(min(n_lines * n_columns, (len(data) - start) // 2 + 1))
    odd = np.empty((len(values) // _ODD_SHARE + 1, 3), dtype=np.int64)
    count, n_odd = _parse(text, start, n_columns, values, odd)
    if count < 0:
        return None
    for index, first, end in odd[:n_odd].tolist():
        values[index] = float(data[first:end])  # the kernel has seen that it is a number
    matrix = values[:count].reshape(-1, n_columns)
    return matrix if np.isfinite(matrix).all() else None


@compiled()
def _parse(text: Any, begin: int, n_columns: int, values: FloatArray, odd: IntArray) -> tuple[int, int]:
    """Fill `values` from the bytes `text`, and `odd` (index, start, end) with those that need more care.

    Returns how many there are of both, or -1 and 0 where the text is not even rows. `text` ends with a line end.

    A number of at most 2^53 times or by a power of ten up to 10^22 is two exact doubles and one correctly rounded
    operation (Clinger, "How to read floating point numbers accurately", 1990, section 2).
    """
    n, count, n_odd, in_line = len(text) - 1, 0, 0, 0
    c: Any
    mantissa: Any
    exponent: Any
    power: Any
    i, one = np.uint64(begin), np.uint64(1)  # unsigned indices spare the test for a negative one
    while i < n:
        c = np.int64(text[i])
        if c == 32 or c == 9:
            i += one
            continue
        if c == 10 or c == 13:
            if in_line != 0 and in_line != n_columns:
                return -1, 0
            in_line = 0
            i += one
            continue
        start = i
        negative = c == 45
        if negative or c == 43:
            i += one
            c = np.int64(text[i])
        first = i
        mantissa = 0
        while 48 <= c <= 57:
            mantissa = mantissa * 10 + (c - 48)
            i += one
            c = np.int64(text[i])
        digits, power = np.int64(i - first), 0
        if c == 46:
            i += one
            first = i
            c = np.int64(text[i])
            while 48 <= c <= 57:
                mantissa = mantissa * 10 + (c - 48)
                i += one
                c = np.int64(text[i])
            power = -np.int64(i - first)
            digits -= power
        if digits == 0:
            return -1, 0
        if c == 101 or c == 69:
            i += one
            c = np.int64(text[i])
            minus = c == 45
            if minus or c == 43:
                i += one
                c = np.int64(text[i])
            first = i
            exponent = 0
            while 48 <= c <= 57:
                exponent = min(exponent * 10 + (c - 48), 100_000)
                i += one
                c = np.int64(text[i])
            if i == first:
                return -1, 0
            power += -exponent if minus else exponent
        if (c != 32 and c != 10 and c != 13 and c != 9) or count == len(values):
            return -1, 0
        if digits <= _MOST_DIGITS and mantissa <= _EXACT and -22 <= power <= 22:
            value = np.float64(mantissa)
            value = value * _POWERS[power] if power >= 0 else value / _POWERS[-power]
            values[count] = -value if negative else value
        else:
            if n_odd == len(odd):
                return -1, 0
            odd[n_odd, 0], odd[n_odd, 1], odd[n_odd, 2] = count, start, i
            n_odd += 1
        count += 1
        in_line += 1
    if in_line != 0 and in_line != n_columns:
        return -1, 0
    return count, n_odd
