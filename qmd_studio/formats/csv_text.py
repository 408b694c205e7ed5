"""CSV: a row of column names with units, then one row a frame; for spreadsheets and scripts.

    # QMD Studio motion
    # {"version": 1, "fps": …, "name": …, "frames": …, "skeleton": …}
    # mask <base64 of the packed bits, row by row>        (only motions with a mask)
    Hips Xposition [m],Hips Zrotation [rad],…
    0.1,-0.25,…

Numbers have as many digits as it takes to read back equal to the last bit.
"""

from __future__ import annotations

import base64
import binascii
import csv
import io
import math

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.formats.motion_description import describe, parse_description
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton

_TITLE = "# QMD Studio motion"
_MASK = "# mask "
_UTF8_BOM = b"\xef\xbb\xbf"
_HINT = "Only CSV files that the studio wrote carry a skeleton; open the original motion instead"


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is the studio's CSV."""
    return head.removeprefix(_UTF8_BOM).startswith(_TITLE.encode())


def write(motion: Motion) -> bytes:
    """Return a CSV file that holds `motion`; raises `FormatError` for one without columns."""
    if motion.skeleton.n_columns == 0:
        raise FormatError("a motion without columns makes no table", wanted="at least 1 column", got="0")
    stream = io.StringIO()
    stream.write(f"{_TITLE}\n# {describe(motion)}\n")
    if motion.mask is not None:
        stream.write(f"{_MASK}{base64.b64encode(np.packbits(motion.mask).tobytes()).decode()}\n")
    csv.writer(stream, lineterminator="\n").writerow(_titles(motion.skeleton))
    for row in motion.X.tolist():
        stream.write(",".join(map(repr, row)) + "\n")
    return stream.getvalue().encode()


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read a CSV file that `write` wrote; raises `FormatError` with the line."""
    lines = io.BytesIO(data.removeprefix(_UTF8_BOM))
    if not lines.readline().startswith(_TITLE.encode()):
        raise FormatError("the file has no description of its skeleton", at="line 1", wanted=_TITLE, hint=_HINT)
    text = _decoded(lines.readline(), 2)
    if not text.startswith("# {"):
        raise FormatError("the file has no description of its skeleton", at="line 2", wanted="# {…}", hint=_HINT)
    description = parse_description(text[2:])
    number, mask = 3, None
    text = _decoded(lines.readline(), number)
    if text.startswith(_MASK):
        mask = _mask(text[len(_MASK) :], (description.n_frames, description.skeleton.n_columns))
        number, text = 4, _decoded(lines.readline(), 4)
    _check_titles(text, _titles(description.skeleton), number)
    X = _rows(lines.read(), description.skeleton.n_columns, number + 1)
    return description.loaded(X, mask, options)


def _titles(skeleton: Skeleton) -> list[str]:
    """Return the head of each column, in one line: "Hips Xposition [m]"."""
    return [f"{' '.join(column.name.split())} [{column.unit}]" for column in skeleton.columns]


def _check_titles(text: str, wanted: list[str], number: int) -> None:
    try:
        titles = next(csv.reader([text.rstrip("\r\n")]), [])
    except csv.Error as problem:
        raise FormatError("the row of column names cannot be read", at=f"line {number}", got=str(problem)) from None
    for index, title in enumerate(wanted):
        found = titles[index] if index < len(titles) else "nothing"
        if found != title:
            place = f"line {number}, column {index + 1}"
            raise FormatError("a column is not the skeleton's", at=place, wanted=title, got=found[:60])
    if len(titles) != len(wanted):
        got = f"{len(titles)} columns"
        raise FormatError("there are columns too many", at=f"line {number}", wanted=str(len(wanted)), got=got)


def _mask(text: str, shape: tuple[int, int]) -> BoolArray:
    try:
        packed = np.frombuffer(base64.b64decode(text.strip(), validate=True), dtype=np.uint8)
    except (binascii.Error, ValueError):
        raise FormatError("the mask cannot be read", at="line 3", wanted="base64") from None
    count = shape[0] * shape[1]
    if shape[0] < 1 or len(packed) != (count + 7) // 8:
        got = f"{len(packed)} bytes"
        raise FormatError("the mask does not fit the motion", at="line 3", wanted=f"{count} bits", got=got)
    return np.unpackbits(packed, count=count).astype(np.bool_).reshape(shape)


def _rows(block: bytes, n_columns: int, first_line: int) -> FloatArray:
    """Parse rows of numbers (n_rows, n_columns)."""
    if not block.strip():
        raise FormatError("the motion has no frame", at=f"line {first_line}", wanted="at least 1 frame", got="0")
    if not block.endswith((b"\n", b"\r")):
        raise FormatError("the last row is cut off", at="the end of the file", wanted="a line end")
    stream = io.TextIOWrapper(io.BytesIO(block), encoding="latin-1")
    try:
        values = np.loadtxt(stream, dtype=np.float64, comments=None, delimiter=",", ndmin=2)
    except ValueError as problem:
        raise _first_problem(block, n_columns, first_line) or FormatError(
            f"the rows cannot be read: {problem}"
        ) from None
    if values.shape[1] != n_columns or not np.isfinite(values).all():
        raise _first_problem(block, n_columns, first_line) or FormatError("the rows do not fit the columns")
    return values


def _first_problem(block: bytes, n_columns: int, first_line: int) -> FormatError | None:
    for number, line in enumerate(io.TextIOWrapper(io.BytesIO(block), encoding="latin-1"), first_line):
        cells = line.strip().split(",")
        if cells == [""]:
            continue
        if len(cells) != n_columns:
            wanted, got = f"{n_columns} values", str(len(cells))
            return FormatError("a row has the wrong number of values", at=f"line {number}", wanted=wanted, got=got)
        for index, cell in enumerate(cells, 1):
            if not _is_number(cell):
                place = f"line {number}, column {index}"
                return FormatError("this is no number", at=place, wanted="a finite number", got=cell[:40] or "nothing")
    return None


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def _decoded(line: bytes, number: int) -> str:
    try:
        return line.decode()
    except UnicodeDecodeError:
        raise FormatError("the text is not UTF-8", at=f"line {number}", wanted="UTF-8") from None


FORMAT = Format(name="csv", title="CSV table", suffixes=(".csv",), sniff=sniff, read=read, write=write)
