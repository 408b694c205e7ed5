"""Acclaim motion files (AMC): per frame a number, then a line of values for each bone that moves."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf_parse import LARGEST
from qmd_studio.formats.asf_write import check_acclaim, check_readable
from qmd_studio.motion.motion import Motion, check_frame_rate
from qmd_studio.motion.skeleton import ColumnKind

AMC_FPS = 120.0
"""The rate of an AMC that does not say its own; the CMU database's is 120."""

_RATE = b":samples-per-second"
_COMMENT = re.compile(rb"#[^\n]*")
_Layout = dict[str, tuple[int, int]]  # of each bone: how many values, and its line in the first frame
_FRAME = re.compile(rb"^[ \t]*\d{1,18}[ \t]*$", re.MULTILINE)


@dataclass(frozen=True, slots=True, eq=False)
class Amc:
    """A parsed AMC: `values` (n_frames, n_values) as written, `bones` (name, number of values, line in frame 0).

    `degrees` and `fps` are None where the file does not name its angle unit and its frame rate, which few do.
    """

    values: FloatArray
    bones: tuple[tuple[str, int, int], ...]
    degrees: bool | None = None
    fps: float | None = None
    warnings: tuple[str, ...] = ()


def parse_amc(data: bytes) -> Amc:
    """Parse the bytes of an AMC.

    Bones may stand in another order from frame to frame. A last frame that is cut off is left out with a warning; any
    other frame that differs from the first raises `FormatError` with its line.
    """
    text = data.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = _COMMENT.sub(b"", text)
    first = _FRAME.search(text)
    if first is None:
        raise FormatError("the motion file holds no frame", wanted="a line with a frame's number", hint="Is it an AMC?")
    header = text[: first.start()].lower().split()
    line = text.count(b"\n", 0, first.start()) + 1
    body = text[first.start() :]
    frames = _parse_regular(body, line) or _parse_tolerant(body, line)
    degrees = False if b":radians" in header else True if b":degrees" in header else None
    return replace(frames, degrees=degrees, fps=_frame_rate(header))


def _frame_rate(header: list[bytes]) -> float | None:
    """Return the rate that some writers give as `:SAMPLES-PER-SECOND 120`."""
    if _RATE not in header[:-1]:
        return None
    word = header[header.index(_RATE) + 1]
    fps = _number(word)
    check_frame_rate(fps, at=_text(_RATE))
    return fps


def _parse_regular(body: bytes, line: int) -> Amc | None:
    """Parse frames that all look like the first, column by column; None where they don't, or anything is amiss."""
    second = _FRAME.search(body, len(body.split(b"\n", 1)[0]))
    rows = [row.split() for row in body[: second.start() if second else len(body)].split(b"\n")]
    width = sum(len(row) for row in rows)
    words = body.split()
    n_frames, rest = divmod(len(words), width)
    if rest:
        return None
    bones: list[tuple[str, int, int]] = []
    columns: list[int] = []
    place = 1
    for number, row in enumerate(rows[1:], start=line + 1):
        if row:
            if words[place::width].count(row[0]) != n_frames:
                return None
            bones.append((_text(row[0]), len(row) - 1, number))
            columns += range(place + 1, place + len(row))
            place += len(row)
    values = _columns(words, columns, width)
    if values is None or len({name for name, _, _ in bones}) < len(bones):
        return None
    numbers = words[::width]
    if not all(word.isdigit() and len(word) <= 18 for word in numbers):
        return None
    return Amc(values, tuple(bones), warnings=_gaps([int(word) for word in numbers]))


def _columns(words: list[bytes], columns: list[int], width: int) -> FloatArray | None:
    if not columns:
        return None
    try:
        values = np.array([list(map(float, words[column::width])) for column in columns]).T
    except ValueError:
        return None
    underscored = any(b"_" in word for column in columns for word in words[column::width])  # float() takes "1_0"
    return values if (np.abs(values) <= LARGEST).all() and not underscored else None


@dataclass(frozen=True, slots=True)
class _Frame:
    """The lines of one frame, unread: `rows` are (line, words)."""

    number: int
    line: int
    rows: list[tuple[int, list[bytes]]]


def _parse_tolerant(body: bytes, line: int) -> Amc:
    """Parse line by line, by name, so that anything amiss has its place."""
    frames = _split(body, line)
    layout = {_text(words[0]): (len(words) - 1, at) for at, words in frames[0].rows}
    warnings = _gaps([frame.number for frame in frames])
    if len(frames) > 1 and _is_cut_off(frames[-1], layout):
        cut = frames.pop()
        got, wanted = sum(len(words) - 1 for _, words in cut.rows), sum(count for count, _ in layout.values())
        last = cut.rows[-1][0] if cut.rows else cut.line
        missing = f"the last frame, number {cut.number}, has {got} of {wanted} values and was left out"
        warnings += (f"Line {last}: {missing}",)
    values = np.array([_values(frame, layout) for frame in frames])
    if values.size == 0:
        raise FormatError("the motion file holds no values", at=f"line {line}", wanted="a line for each bone")
    return Amc(values, tuple((name, *place) for name, place in layout.items()), warnings=warnings)


def _split(body: bytes, line: int) -> list[_Frame]:
    frames: list[_Frame] = []
    for at, raw in enumerate(body.split(b"\n"), start=line):
        words = raw.split()
        if len(words) == 1 and words[0].isdigit() and len(words[0]) <= 18:
            frames.append(_Frame(int(words[0]), at, []))
        elif words:
            frames[-1].rows.append((at, words))
    return frames


def _is_cut_off(frame: _Frame, layout: _Layout) -> bool:
    """Return whether the frame's lines are right, but for the last one perhaps, and the last bone is missing."""
    names = [_read_row(row, layout)[0] for row in frame.rows[:-1]]
    with suppress(FormatError):  # a line cut in two
        names += [_read_row(row, layout)[0] for row in frame.rows[-1:]]
    return len(set(names)) == len(names) and next(reversed(layout), None) not in names


def _values(frame: _Frame, layout: _Layout) -> list[float]:
    """Return the frame's values in the order of the first frame."""
    found: dict[str, list[float]] = {}
    for row in frame.rows:
        name, values = _read_row(row, layout)
        if name in found:
            raise FormatError("a bone stands twice in a frame", at=f"line {row[0]}", got=name)
        found[name] = values
    for name in layout:
        if name not in found:
            at = f"line {frame.rows[-1][0] if frame.rows else frame.line}"
            raise FormatError(f"frame {frame.number} has no line for {name}", at=at, wanted=f"{len(layout)} bones")
    return [value for name in layout for value in found[name]]


def _read_row(row: tuple[int, list[bytes]], layout: _Layout) -> tuple[str, list[float]]:
    line, words = row
    name = _text(words[0])
    if name not in layout:
        raise FormatError("a frame has a bone that the first frame lacks", at=f"line {line}", got=name[:40])
    if len(words) - 1 != layout[name][0]:
        wanted, got = str(layout[name][0]), str(len(words) - 1)
        raise FormatError(f"{name} has another number of values than before", at=f"line {line}", wanted=wanted, got=got)
    values = [_number(word) for word in words[1:]]
    for word, value in zip(words[1:], values, strict=True):
        if not abs(value) <= LARGEST:
            got = _text(word)[:40]
            raise FormatError(f"a value of {name} cannot be used", at=f"line {line}", wanted="a finite number", got=got)
    return name, values


def _number(word: bytes) -> float:
    try:
        return np.nan if b"_" in word else float(word)
    except ValueError:
        return np.nan


def _gaps(numbers: list[int]) -> tuple[str, ...]:
    """Return a warning where the frames are not numbered one after the other."""
    steps = np.diff(np.array(numbers, dtype=np.int64))
    if (steps == 1).all():
        return ()
    at = int(np.argmax(steps != 1))
    return (f"Frame number {numbers[at]} is followed by {numbers[at + 1]}; the frames are played without a gap",)


def _text(word: bytes) -> str:
    return word.decode("utf-8", "replace")


def write_amc(motion: Motion) -> bytes:
    """Return the bytes of an AMC in degrees, with 14 digits: reading it and writing it again gives the same bytes.

    A frame rate other than the usual 120 is put in the header, where readers that don't know of it pass over it.
    Raises `FormatError` where the motion is not on an ASF skeleton or on one that an ASF cannot hold, and for values
    too large for readers.
    """
    skeleton = motion.skeleton
    check_acclaim(skeleton)
    turns = np.array([column.kind is ColumnKind.ROTATION for column in skeleton.columns])
    values = motion.X / np.where(turns, np.pi / 180, skeleton.metres_per_unit)
    check_readable(values)
    names = [skeleton.joints[column.joint].name for column in skeleton.columns]
    runs = [(bone.replace("%", "%%"), len(list(group))) for bone, group in groupby(names)]
    template = "".join(f"{bone} {' '.join(['%.14g'] * count)}\n" for bone, count in runs)
    frames = [f"{number}\n{template % tuple(row)}" for number, row in enumerate(values.tolist(), start=1)]
    rate = "" if motion.fps == AMC_FPS else f"{_text(_RATE).upper()} {float(motion.fps)!r}\n"
    return (rate + ":FULLY-SPECIFIED\n:DEGREES\n" + "".join(frames)).encode()
