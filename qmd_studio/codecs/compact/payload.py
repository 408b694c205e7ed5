"""The payload of version 2: counts, the lengths of the streams, and the streams; nothing in it is decoded here."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from qmd_studio.codecs.compact.layout import MAX_BLOCK, n_segments
from qmd_studio.errors import FormatError

_COUNTS = struct.Struct("<IIIB")
"""Frames, columns, frames in a segment (0: all in one), frames from key to key."""

_PAYLOAD_AT = 64
"""Where the payload starts in the file, for messages that name a byte."""

VALUES_PER_BYTE = 128
"""A payload is at least this part of its values, so that a few bytes cannot ask for gigabytes."""

_LONGEST_NUMBER = 5


@dataclass(frozen=True, slots=True)
class Payload:
    """A payload taken apart: its counts, the stream of steps and reference pose, and the segments' streams."""

    n_frames: int
    n_columns: int
    segment: int
    block: int
    prelude: bytes
    streams: tuple[bytes, ...]


def pack(payload: Payload) -> bytes:
    """Return the bytes of a payload, with zeros at the end where it would hold too many values for its length."""
    parts = [_COUNTS.pack(payload.n_frames, payload.n_columns, payload.segment, payload.block)]
    streams = (payload.prelude, *payload.streams)
    parts += [_number(len(stream)) for stream in streams]
    packed = b"".join((*parts, *streams))
    least = -(-payload.n_frames * payload.n_columns // VALUES_PER_BYTE)
    return packed.ljust(least, b"\0")


def unpack(data: memoryview) -> Payload:
    """Take a payload apart; nothing is allocated by a count that the bytes do not bear out.

    Raises `FormatError`, naming the byte of the file, for counts out of range and streams that end early.
    """
    if len(data) < _COUNTS.size:
        raise _bad(0, "the payload ends inside its counts", f"{_COUNTS.size} bytes", len(data))
    n_frames, n_columns, segment, block = _COUNTS.unpack_from(data)
    if not n_frames or not n_columns or not 1 <= block <= MAX_BLOCK or (segment and segment > n_frames):
        wanted = f"frames 1 or more, columns 1 or more, a segment no longer than that, blocks of 1 to {MAX_BLOCK}"
        raise _bad(0, "the counts are out of range", wanted, (n_frames, n_columns, segment, block))
    if n_frames * n_columns > VALUES_PER_BYTE * len(data):
        wanted = f"at most {VALUES_PER_BYTE} values for each byte"
        raise _bad(0, "the payload is too short for what it should hold", wanted, (n_frames, n_columns))
    at = _COUNTS.size
    lengths = []
    for _ in range(1 + n_segments(n_frames, segment)):
        length, at = _number_at(data, at)
        lengths.append(length)
    streams = []
    for length in lengths:
        if length > len(data) - at:
            raise _bad(at, "a stream ends early", f"{length} bytes", len(data) - at)
        streams.append(bytes(data[at : at + length]))
        at += length
    if any(data[at:]):
        raise _bad(at, "something follows the last stream", "nothing but zeros", len(data) - at)
    return Payload(n_frames, n_columns, segment, block, streams[0], tuple(streams[1:]))


def _number(value: int) -> bytes:
    """Return a number in groups of seven bits, the lowest first, the highest bit of a byte saying that more follow."""
    groups = bytearray()
    while value > 127:
        groups.append(value & 127 | 128)
        value >>= 7
    return bytes((*groups, value))


def _number_at(data: memoryview, at: int) -> tuple[int, int]:
    value = 0
    for place in range(_LONGEST_NUMBER):
        if at + place >= len(data):
            break
        byte = data[at + place]
        value |= (byte & 127) << (7 * place)
        if byte < 128:
            return value, at + place + 1
    raise _bad(at, "the length of a stream cannot be read", f"1 to {_LONGEST_NUMBER} bytes", bytes(data[at : at + 5]))


def _bad(at: int, message: str, wanted: str, got: object) -> FormatError:
    return FormatError(message, at=f"byte {_PAYLOAD_AT + at}", wanted=wanted, got=str(got))
