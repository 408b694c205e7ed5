"""What the bytes of a compact payload are spent on, as far as they can be told apart without decoding."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.codecs.compact.payload import unpack


@dataclass(frozen=True, slots=True)
class CompactBreakdown:
    """The bytes of a payload of version 2; the parts add up to `bytes`.

    `count_bytes` are the counts, the lengths of all streams and what pads a tiny payload; `prelude_bytes` the steps of
    the columns and the reference pose; `stream_bytes` the segments, in which key poses and what lies between them are
    coded together. `n_segments` decode alone.
    """

    bytes: int
    count_bytes: int
    prelude_bytes: int
    stream_bytes: int
    n_segments: int


def compact_breakdown(payload: bytes) -> CompactBreakdown:
    """Return what a payload's bytes are spent on; raises `FormatError` for a damaged one."""
    contents = unpack(memoryview(payload))
    prelude, streams = len(contents.prelude), sum(map(len, contents.streams))
    return CompactBreakdown(
        bytes=len(payload),
        count_bytes=len(payload) - prelude - streams,
        prelude_bytes=prelude,
        stream_bytes=streams,
        n_segments=len(contents.streams),
    )
