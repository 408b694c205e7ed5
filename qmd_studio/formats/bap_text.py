"""MPEG-4 body animation parameters as text (.bap): for each frame a line of mask and a line of values.

    # comments stand anywhere
    3.1 name 25 2                      version, name, frames a second, number of frames
    0 1 0 0 1 ...                      the mask: one 0 or 1 for each parameter, by number
    0 -3491 17453                      the frame's number, then a value for each 1

Values are hundred-thousandths of a radian, and millimetres for the root. Versions say little: what counts is the length
of the mask. 169 is the older numbering, 186 the standard's, 296 has the extensions, 295 is written by Greta; with any
other length the n-th entry is parameter n.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.bap_text_write import MAX_FILE_VALUE, write_bap_text
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.motion.bap import N_BAPS, N_DEFINED_BAPS, N_OLD_BAPS, bap_skeleton, bap_table, column_of
from qmd_studio.motion.motion import FRAME_RATES, Motion

MAX_HELD_FRAMES = 3000
"""So many frames may be missing between the frame numbers of a file; its poses are held over them."""

_FAP_MASK_LENGTHS = (66, 68, 69)
_LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class _Line:
    number: int
    tokens: list[str]
    is_last: bool
    is_cut: bool
    """Whether the file ends in this line, without a line end: its last token may be torn."""

    @property
    def at(self) -> str:
        return f"line {self.number}"


@dataclass(frozen=True, slots=True)
class _Header:
    version: str
    name: str
    fps: float
    n_frames: float | None


@dataclass(frozen=True, slots=True)
class _Frame:
    number: int
    line: int
    given: IntArray
    """The parameters that this frame gives, as places in the mask."""
    values: FloatArray


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read the bytes of a .bap file onto the H-Anim skeleton, with 296 columns only where it uses extensions.

    A parameter that a frame leaves out keeps its last value, 0 before the first; the mask is kept. An incomplete last
    frame is dropped with a warning. Frame numbers with an even step divide the frame rate; over uneven gaps the pose
    is held. Raises `FormatError` for anything else that does not fit.
    """
    lines = _lines(data)
    header = _read_header(lines, options)
    warnings: list[str] = []
    n_mask, frames = _read_frames(lines, header, warnings)
    if not frames:
        raise FormatError(
            "the file holds no complete frame", wanted="a line of mask and a line of values", got=f"{len(data)} bytes"
        )
    if header.n_frames != len(frames):
        told = "no number of frames" if header.n_frames is None else f"{header.n_frames:.15g} frames"
        warnings.append(f"The header gives {told}; the file holds {len(frames)} and all are read.")
    rows, step = _rows(frames, warnings)
    fps = header.fps / step if options.fps is None else options.fps
    name = header.name or (options.path.stem if options.path else "")
    motion = _motion(frames, rows, _ids_of_mask(n_mask), name=name, fps=fps)
    notes = [f"Version {header.version}, masks of {n_mask}{' (older numbering)' if n_mask == N_OLD_BAPS else ''}."]
    if fps < header.fps:
        notes.append(f"Frame numbers go by {step}: {header.fps:g} frames a second are read as {motion.fps:g}.")
    return Loaded(skeleton=motion.skeleton, motion=motion, warnings=tuple(warnings), notes=tuple(notes))


def sniff(head: bytes) -> bool:
    """Return whether `head` starts like a .bap file: a version and a rate, then a line of noughts and ones."""
    try:
        lines = _lines(head)
        header = next(lines)
        mask = next(lines)
    except StopIteration:
        return False
    is_header = len(header.tokens) >= 3 and _is_version(header.tokens[0]) and _number(header.tokens[-1]) is not None
    is_mask = set(mask.tokens) <= {"0", "1"} and (len(mask.tokens) > 1 or not mask.is_last)
    return is_header and is_mask and len(mask.tokens) not in _FAP_MASK_LENGTHS


FORMAT = Format(
    name="bap",
    title="MPEG-4 body animation parameters",
    suffixes=(".bap",),
    sniff=sniff,
    read=read,
    write=write_bap_text,
)


def _lines(data: bytes) -> Iterator[_Line]:
    """Yield the lines that say something; the header may hold a '#', other lines end there."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    texts = [line if not line.lstrip().startswith("#") else "" for line in _LINE_END.split(text)]
    n_lines = max((number for number, line in enumerate(texts, 1) if line.strip()), default=0)
    header_seen = False
    for number, line in enumerate(texts[:n_lines], 1):
        tokens = (line.partition("#")[0] if header_seen else line).split()
        if tokens:
            header_seen = True
            yield _Line(number, tokens, is_last=number == n_lines, is_cut=number == len(texts))


def _read_header(lines: Iterator[_Line], options: ReadOptions) -> _Header:
    line = next(lines, None)
    wanted = "version, name, frames a second, number of frames"
    if line is None:
        raise FormatError("the file is empty", wanted=wanted, got="nothing")
    tokens = line.tokens
    if len(tokens) < 2 or not _is_version(tokens[0]):
        raise FormatError("this is not a BAP header", at=line.at, wanted=wanted, got=_shown(tokens))
    if len(tokens) > 2 and _looks_numeric(tokens[-2]):
        name, rate, count = tokens[1:-2], _number(tokens[-2]), _number(tokens[-1])
    else:  # one number only: the rate, the number of frames being left out
        name, rate, count = tokens[1:-1], _number(tokens[-1]), None
    fps = options.fps if options.fps is not None else rate
    if fps is None or not FRAME_RATES[0] <= fps <= FRAME_RATES[1]:
        raise FormatError(
            "the header gives no frame rate",
            at=line.at,
            wanted=wanted,
            got=_shown(tokens),
            hint="Say the rate yourself",
        )
    return _Header(tokens[0], " ".join(name), fps, count)


def _read_frames(lines: Iterator[_Line], header: _Header, warnings: list[str]) -> tuple[int, list[_Frame]]:
    """Return the length of the masks and the complete frames."""
    n_mask = 0
    frames: list[_Frame] = []
    masks: dict[str, IntArray] = {}
    for line in lines:
        key = " ".join(line.tokens)
        if key not in masks:
            masks[key] = _read_mask(line, n_mask, header)
            n_mask = n_mask or len(line.tokens)
        values = next(lines, None)
        if values is None:
            warnings.append(_dropped(line, f"{len(line.tokens)} of {n_mask} entries of its mask, no values"))
            break
        frame = _read_values(values, masks[key], warnings)
        if frame is None:
            break
        frames.append(frame)
    return n_mask, frames


def _read_mask(line: _Line, n_mask: int, header: _Header) -> IntArray:
    strange = next((token for token in line.tokens if token not in ("0", "1")), None)
    if strange is not None:
        raise FormatError("the mask is not noughts and ones", at=line.at, wanted="0 or 1", got=repr(strange[:20]))
    n_tokens = len(line.tokens)
    if n_mask and n_tokens != n_mask and not (line.is_last and n_tokens < n_mask):
        raise FormatError("the masks differ in length", at=line.at, wanted=f"{n_mask} entries", got=str(n_tokens))
    if n_tokens > N_BAPS:
        raise FormatError("the mask is too long", at=line.at, wanted=f"at most {N_BAPS} entries", got=str(n_tokens))
    if n_tokens in _FAP_MASK_LENGTHS and header.version.startswith("2."):
        raise FormatError(
            "this file animates a face, not a body",
            at=line.at,
            wanted="masks of 186 or 296 entries",
            got=f"{n_tokens}, as facial animation parameters have",
            hint="Open a .bap file",
        )
    return np.array([place for place, token in enumerate(line.tokens) if token == "1"], dtype=np.int64)


def _read_values(line: _Line, given: IntArray, warnings: list[str]) -> _Frame | None:
    """Return the frame, or None (with a warning) where the file breaks off in it."""
    wanted = f"a frame number and {len(given)} values"
    tokens, n_values = line.tokens, len(line.tokens) - 1
    torn = line.is_cut and n_values <= len(given) and _is_torn(tokens[-1])
    numbers = _numbers(line, tokens[:-1] if torn else tokens, wanted)
    if torn or (line.is_last and n_values < len(given)):
        warnings.append(_dropped(line, f"{n_values - torn} of {len(given)} values"))
        return None
    if n_values != len(given):
        raise FormatError("the values do not fit the mask", at=line.at, wanted=wanted, got=f"{n_values} values")
    number = float(numbers[0])
    if number != math.floor(number) or not 0 <= number <= MAX_FILE_VALUE:
        raise FormatError("this is no frame number", at=line.at, wanted=wanted, got=repr(tokens[0][:20]))
    return _Frame(int(number), line.number, given, numbers[1:])


def _numbers(line: _Line, tokens: list[str], wanted: str) -> FloatArray:
    try:
        numbers = np.array(list(map(float, tokens)), dtype=np.float64)
    except ValueError:
        numbers = np.full(len(tokens), np.nan)
    if not np.isfinite(numbers).all():
        strange = next((token for token in tokens if _number(token) is None), tokens[0])
        raise FormatError("a value is not a number", at=line.at, wanted=wanted, got=repr(strange[:20]))
    return numbers


def _rows(frames: list[_Frame], warnings: list[str]) -> tuple[IntArray, int]:
    """Return the row of X that each frame goes to, and the even step of the frame numbers (1 where it is uneven)."""
    numbers = np.array([frame.number for frame in frames], dtype=np.int64)
    steps = np.diff(numbers)
    consecutive = np.arange(len(frames), dtype=np.int64)
    if len(steps) == 0 or (steps == 1).all():
        return consecutive, 1
    if (steps < 1).any():
        frame = frames[int(np.argmax(steps < 1)) + 1]
        warnings.append(f"Line {frame.line}: frame number {frame.number} does not go up; frames are read as they come.")
        return consecutive, 1
    if len(steps) > 1 and (steps == steps[0]).all():
        return consecutive, int(steps[0])
    n_held = int(numbers[-1] - numbers[0]) + 1 - len(frames)
    first = frames[int(np.argmax(steps > 1)) + 1]
    if n_held > MAX_HELD_FRAMES:
        raise FormatError(
            "too many frames are missing between the frame numbers",
            at=f"line {first.line}",
            wanted=f"at most {MAX_HELD_FRAMES}",
            got=str(n_held),
        )
    warnings.append(f"Line {first.line}: frame numbers skip; the pose is held over {n_held} missing frames.")
    return numbers - numbers[0], 1


def _motion(frames: list[_Frame], rows: IntArray, ids: IntArray, *, name: str, fps: float) -> Motion:
    used = np.unique(np.concatenate([frame.given for frame in frames]))
    skeleton = bap_skeleton(extensions=bool((ids[used] > N_DEFINED_BAPS).any()))
    columns = np.full(len(ids), -1, dtype=np.int64)
    columns[used] = [column_of(int(bap_id)) for bap_id in ids[used]]
    X = np.zeros((int(rows[-1]) + 1, skeleton.n_columns))
    mask = np.zeros(X.shape, dtype=np.bool_)
    for row, frame in zip(rows, frames, strict=True):
        X[row, columns[frame.given]] = frame.values
        mask[row, columns[frame.given]] = True
    X = _held(X, mask) * [bap_table()[(column.bap_id or 0) - 1].si_per_unit for column in skeleton.columns]
    return Motion(skeleton, X, fps, name=name, mask=mask)


def _held(X: FloatArray, mask: BoolArray) -> FloatArray:
    """Return X with the last given value wherever none is given; what stands before the first is 0 already."""
    last = np.where(mask, np.arange(len(X))[:, None], 0)
    np.maximum.accumulate(last, axis=0, out=last)
    return np.asarray(np.take_along_axis(X, last, axis=0))


def _ids_of_mask(n_mask: int) -> IntArray:
    """Return the parameter that each entry of a mask stands for."""
    if n_mask != N_OLD_BAPS:
        return np.arange(1, n_mask + 1, dtype=np.int64)
    by_old = {parameter.old_id: parameter.id for parameter in bap_table() if parameter.old_id is not None}
    return np.array([by_old[old_id] for old_id in range(1, N_OLD_BAPS + 1)], dtype=np.int64)


def _is_version(token: str) -> bool:
    return re.fullmatch(r"[vV]?\d{1,3}(\.\d{1,3}){0,2}", token) is not None


def _looks_numeric(token: str) -> bool:
    return (
        _number(token) is not None or re.fullmatch(r"[-+]?(nan|inf(inity)?|[\d.]+e[-+]?\d+)", token.lower()) is not None
    )


def _number(token: str) -> float | None:
    """Return the finite number that `token` is, or None."""
    try:
        number = float(token)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _is_torn(token: str) -> bool:
    """Return whether `token` can be the beginning of a number that the file breaks off in."""
    return re.fullmatch(r"[-+]?\.?|[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?", token) is not None


def _dropped(line: _Line, got: str) -> str:
    return f"Line {line.number}: the file breaks off in its last frame ({got}); that frame is dropped."


def _shown(tokens: list[str]) -> str:
    return repr(" ".join(tokens[:6])[:60])
