"""The number block of a BVH file: text to a matrix, strictly, and without trusting the count that the header gives."""

from __future__ import annotations

import io
import re
import sys
from array import array
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.bvh_hierarchy import SHOWN_CHARACTERS, parse_number

_COUNT = re.compile(rb"\s*MOTION\s*Frames\s*:?\s*([^\s:]+)", re.IGNORECASE)
_TIME = re.compile(rb"\s*Frame\s*Time\s*:?\s*([^\s:]+)", re.IGNORECASE)
_INK = re.compile(rb"\S")
_END_MARKS = (b"\x1a", b"\x00")
"""Old editors end a file with Ctrl-Z, or fill it up with zeros."""
_LARGE_BYTES = 1 << 22
_HUGE_BYTES = 1 << 27
_NEWLINE = re.compile(rb"\r\n|\r|\n")


@dataclass(frozen=True, slots=True)
class MotionHead:
    """What stands between MOTION and the numbers; `end` is the byte where the numbers begin."""

    n_frames: int
    frame_time: str
    count_line: int
    time_line: int
    end: int


@dataclass(frozen=True, slots=True)
class Rows:
    """The whole rows (n_rows, n_columns), and how many values of a last, incomplete row follow from `line` on."""

    values: FloatArray
    left_over: int
    line: int


def parse_head(data: bytes, start: int) -> MotionHead:
    """Parse "MOTION", "Frames: n" and "Frame Time: t" from byte `start`; raises `FormatError` with the line."""
    count = _COUNT.match(data, start)
    if count is None:
        raise FormatError("MOTION has no frame count", at=f"line {line_at(data, start)}", wanted="Frames: and a number")
    count_line = line_at(data, count.start(1))
    if not re.fullmatch(rb"[0-9]{1,18}", count.group(1)):
        raise FormatError(
            "the frame count is not a number", at=f"line {count_line}", wanted="Frames: and a number", got=_shown(count)
        )
    time = _TIME.match(data, count.end())
    if time is None:
        place = f"line {line_at(data, count.end())}"
        raise FormatError("MOTION has no frame time", at=place, wanted="Frame Time: and seconds")
    return MotionHead(
        n_frames=int(count.group(1)),
        frame_time=time.group(1).decode("latin-1"),
        count_line=count_line,
        time_line=line_at(data, time.start(1)),
        end=time.end(),
    )


def parse_rows(data: bytes, n_columns: int, start: int = 0) -> Rows:
    """Parse the numbers of `data` from byte `start` into rows of `n_columns` (at least 1), however the lines break.

    Raises `FormatError` with the line for a word that is not a finite number and for a line that does not end where a
    row ends. The text is not copied on the way: large files are what time and memory are spared for.
    """
    first_line = line_at(data, start)
    if data.endswith(_END_MARKS):
        data = data.rstrip(b"\x00\x1a \t\r\n")
    if data.find(b",", start) >= 0 and data.find(b".", start) < 0:
        data = data.replace(b",", b".")
    if _INK.search(data, start) is None:
        return Rows(np.zeros((0, n_columns)), 0, first_line)
    if _compiling_pays(len(data) - start):
        from qmd_studio.formats.number_kernel import parse_even_rows

        matrix = parse_even_rows(data, n_columns, start)
        if matrix is not None:
            return Rows(matrix, 0, first_line)
    try:
        # NumPy's C reader is strict, and it grows with what is there, not with the count.
        values = np.loadtxt(_lines(data, start, "ascii"), dtype=np.float64, comments=None, ndmin=2)
    except ValueError:
        return _rows_by_word(_lines(data, start, "latin-1"), n_columns, first_line)
    if values.shape[1] != n_columns or not np.isfinite(np.vdot(values, values)):  # needs no array of its own
        return _rows_by_word(_lines(data, start, "latin-1"), n_columns, first_line)
    return Rows(values, 0, first_line)


def _compiling_pays(n_bytes: int) -> bool:
    """Tell whether a block is worth the compiled reader: one that gains more than numba takes to load, if it has to.

    Both readers round every number right, so the choice shows in the time only.
    """
    return n_bytes >= (_LARGE_BYTES if "numba" in sys.modules else _HUGE_BYTES)


def line_at(data: bytes, position: int) -> int:
    """Return the line, counted from 1, of byte `position`; CR, LF and CRLF each end a line."""
    return 1 + sum(1 for _ in _NEWLINE.finditer(data, 0, position))


def _rows_by_word(lines: Iterator[str], n_columns: int, first_line: int) -> Rows:
    """Parse word by word: the slow way that copes with broken lines and can say what is wrong where."""
    values = array("d")
    filled, row_line = 0, first_line
    for number, line in enumerate(lines, first_line):
        words = line.split()
        if not words:
            continue
        if filled == 0:
            row_line = number
        if filled + len(words) > n_columns and (filled or len(words) % n_columns):
            got = filled or len(words)
            raise FormatError(
                "a frame has the wrong number of values",
                at=f"line {row_line}",
                wanted=f"{n_columns} values, one for each channel",
                got=str(got),
            )
        values.extend(_number(word, number) for word in words)
        filled = (filled + len(words)) % n_columns
    whole = len(values) // n_columns
    matrix = np.frombuffer(values, dtype=np.float64)[: whole * n_columns].reshape(whole, n_columns).copy()
    return Rows(matrix, filled, row_line)


def _number(word: str, line: int) -> float:
    try:
        return parse_number(word)
    except ValueError:
        shown = word if len(word) <= SHOWN_CHARACTERS else f"{word[:SHOWN_CHARACTERS]}…"
        raise FormatError("this is no number", at=f"line {line}", wanted="a finite number", got=shown) from None


def _lines(data: bytes, start: int, encoding: str) -> Iterator[str]:
    """Return the lines from byte `start`, which CR, LF and CRLF each end."""
    stream = io.BytesIO(data)
    stream.seek(start)
    return io.TextIOWrapper(stream, encoding=encoding, newline=None)


def _shown(found: re.Match[bytes]) -> str:
    return found.group(1)[:SHOWN_CHARACTERS].decode("latin-1")
