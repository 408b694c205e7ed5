"""The paper's payload (section 3.4, Figure 3): segments one after another, the initial pose in the first of them."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS, index_bytes
from qmd_studio.codecs.qmd.size import SEGMENT_HEADER_BYTES, SizeBreakdown
from qmd_studio.errors import FormatError

IndexArray: TypeAlias = NDArray[np.unsignedinteger[Any]]
"""Indices as a file holds them: uint8 or uint16."""

_SEGMENT_HEADER = struct.Struct("<iiiB")
_PAYLOAD_AT = 64
"""Where the payload starts in the file, for messages that name a byte."""


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """One segment: `table` (2^bits,) float32, `exact` (rows, FDF) float32, `indices` (rows, m - FDF) uint8 or uint16.

    Values are radians and ASF length units.
    """

    bits: int
    table: Float32Array
    exact: Float32Array
    indices: IndexArray

    @property
    def n_rows(self) -> int:
        """The differences in this segment."""
        return len(self.indices)

    @property
    def fdf(self) -> int:
        """The number of leading columns kept as float32."""
        return int(self.exact.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class Payload:
    """A whole payload: `pose` (m,) float32 and the segments in order."""

    pose: Float32Array
    segments: tuple[Segment, ...]

    @property
    def n_rows(self) -> int:
        """The differences in all segments: one fewer than the frames."""
        return sum(segment.n_rows for segment in self.segments)

    @property
    def size(self) -> SizeBreakdown:
        """The bytes that `pack` gives, part by part."""
        header = len(self.segments) * SEGMENT_HEADER_BYTES
        table = sum(segment.table.nbytes for segment in self.segments)
        exact = sum(segment.exact.nbytes for segment in self.segments)
        index = sum(segment.indices.nbytes for segment in self.segments)
        total = header + table + exact + index + self.pose.nbytes
        return SizeBreakdown(total, header, table, exact, index, self.pose.nbytes)

    @property
    def n_frames(self) -> int:
        """The poses of the motion."""
        return self.n_rows + 1

    @property
    def n_columns(self) -> int:
        """The columns of a pose, the paper's m."""
        return len(self.pose)


def index_type(bits: int) -> np.dtype[np.unsignedinteger[Any]]:
    """Return the type of a table position of `bits` bits: one byte or two."""
    return np.dtype(f"=u{index_bytes(bits)}")


def pack(payload: Payload) -> bytes:
    """Return the bytes of a payload."""
    parts: list[bytes] = []
    for number, segment in enumerate(payload.segments):
        parts.append(_SEGMENT_HEADER.pack(segment.n_rows, len(payload.pose), segment.fdf, segment.bits))
        if number == 0:
            parts.append(_little_endian(payload.pose, "<f4"))
        parts.append(_little_endian(segment.table, "<f4"))
        parts.append(_little_endian(segment.exact, "<f4"))
        parts.append(_little_endian(segment.indices, f"<u{index_bytes(segment.bits)}"))
    return b"".join(parts)


def unpack(data: memoryview) -> Payload:
    """Take a payload apart; nothing is allocated by a count that the bytes do not bear out.

    Raises `FormatError`, naming the byte of the file, for counts out of range, parts that end early, segments that
    disagree on m, and values that are not finite.
    """
    pose: Float32Array | None = None
    segments: list[Segment] = []
    at = 0
    while at < len(data) or pose is None:
        rows, columns, fdf, bits = _segment_header(data, at)
        if pose is not None and (columns != len(pose) or rows == 0):
            raise _bad(at, "a later segment does not fit the first", f"rows, and {len(pose)} columns", (rows, columns))
        at += SEGMENT_HEADER_BYTES
        if pose is None:
            pose, at = _floats(data, at, (columns,), "initial pose")
        table, at = _floats(data, at, (2**bits,), "table")
        exact, at = _floats(data, at, (rows, fdf), "exact columns")
        indices, at = _indices(data, at, (rows, columns - fdf), bits)
        segments.append(Segment(bits, table, exact, indices))
    if len(segments) > 1 and segments[0].n_rows == 0:
        raise _bad(0, "an empty segment is followed by others", "one segment", len(segments))
    return Payload(pose, tuple(segments))


def _segment_header(data: memoryview, at: int) -> tuple[int, int, int, int]:
    if len(data) - at < SEGMENT_HEADER_BYTES:
        raise _bad(at, "a segment's header ends early", f"{SEGMENT_HEADER_BYTES} bytes", len(data) - at)
    rows, columns, fdf, bits = _SEGMENT_HEADER.unpack_from(data, at)
    if rows < 0 or columns < 1 or not 0 <= fdf <= columns or not MIN_BITS <= bits <= MAX_BITS:
        wanted = f"n_d 0 or more, m 1 or more, FDF 0 to m, b {MIN_BITS} to {MAX_BITS}"
        raise _bad(at, "a segment's header is out of range", wanted, (rows, columns, fdf, bits))
    return rows, columns, fdf, bits


def _floats(data: memoryview, at: int, shape: tuple[int, ...], what: str) -> tuple[Float32Array, int]:
    values, end = _array(data, at, shape, what, "<f4")
    floats = values.astype(np.float32, copy=False)
    if not np.isfinite(floats).all():
        wrong = int(np.flatnonzero(~np.isfinite(floats.ravel()))[0])
        raise _bad(at + 4 * wrong, f"a value of the {what} is not a number", "finite", floats.ravel()[wrong])
    return floats, end


def _indices(data: memoryview, at: int, shape: tuple[int, int], bits: int) -> tuple[IndexArray, int]:
    values, end = _array(data, at, shape, "index block", f"<u{index_bytes(bits)}")
    indices: IndexArray = values.astype(index_type(bits), copy=False)
    if bits not in (8, 16) and indices.size and int(indices.max()) >= 2**bits:
        wrong = int(np.argmax(indices.ravel() >= 2**bits))
        raise _bad(at + 2 * wrong, "an index points past its table", f"below {2**bits}", indices.ravel()[wrong])
    return indices, end


def _array(data: memoryview, at: int, shape: tuple[int, ...], what: str, kind: str) -> tuple[NDArray[np.generic], int]:
    count = math.prod(shape)  # Python integers: counts from a file must not wrap around
    size = count * np.dtype(kind).itemsize
    if size > len(data) - at:
        raise _bad(at, f"the {what} ends early", f"{size} bytes", len(data) - at)
    if not count:
        return np.empty(shape, kind), at
    # A copy: the paper's 13-byte header leaves what follows off its natural boundary, where kernels cannot read it.
    return np.frombuffer(data, kind, count, at).copy().reshape(shape), at + size


def _little_endian(values: NDArray[np.generic], kind: str) -> bytes:
    return np.ascontiguousarray(values, dtype=kind).tobytes()


def _bad(at: int, message: str, wanted: str, got: object) -> FormatError:
    return FormatError(message, at=f"byte {_PAYLOAD_AT + at}", wanted=wanted, got=str(got))
