"""Payloads of version 2 to columns."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from qmd_studio.arrays import Float32Array, IntArray
from qmd_studio.codecs.compact.layout import key_frames
from qmd_studio.codecs.compact.payload import Payload
from qmd_studio.codecs.compact.prior import prior
from qmd_studio.errors import FormatError

Integers: TypeAlias = tuple[IntArray, IntArray, IntArray]
"""A segment's key frames (k,), its key poses (k, m) in half steps, its coefficients (frames that are no keys, m)."""


def decode_payload(contents: Payload) -> Float32Array:
    """Return what a payload holds, (n_frames, n_columns) float32 radians and ASF units.

    Bit for bit the same on every machine. Raises `FormatError` where a stream ends early or holds what no encoder
    writes.
    """
    from qmd_studio.codecs.compact.synthesis import step_sizes, synthesise  # compiled code, loaded where it is needed

    codes, pose = _prelude(contents)
    steps = step_sizes(codes)
    decoded = np.empty((contents.n_frames, contents.n_columns), np.float32)
    length = contents.segment or contents.n_frames
    for number in range(len(contents.streams)):
        decoded[number * length : (number + 1) * length] = synthesise(*_segment(contents, number, pose), steps)
    return decoded


def decode_segment(contents: Payload, number: int) -> Float32Array:
    """Return segment `number` alone, (its frames, n_columns) float32; raises as `decode_payload` does."""
    from qmd_studio.codecs.compact.synthesis import step_sizes, synthesise

    codes, pose = _prelude(contents)
    return synthesise(*_segment(contents, number, pose), step_sizes(codes))


def decode_integers(contents: Payload) -> tuple[IntArray, IntArray, list[Integers]]:
    """Return the step codes (m,), the reference pose (m,) and the integers of each segment."""
    codes, pose = _prelude(contents)
    return codes, pose, [_segment(contents, number, pose) for number in range(len(contents.streams))]


def _prelude(contents: Payload) -> tuple[IntArray, IntArray]:
    """Return the step codes (m,) and the reference pose (m,)."""
    from qmd_studio.codecs.compact.stream import read_prelude

    codes, pose = (np.zeros(contents.n_columns, np.int64) for _ in range(2))
    wrong = read_prelude(prior(), np.frombuffer(contents.prelude, np.uint8), codes, pose)
    _check(wrong, "the stream of steps and reference pose")
    return codes, pose


def _segment(contents: Payload, number: int, pose: IntArray) -> Integers:
    from qmd_studio.codecs.compact.stream import read_segment

    length = contents.segment or contents.n_frames
    n_frames = min(length, contents.n_frames - number * length)
    at = key_frames(n_frames, contents.block)
    keys = np.empty((len(at), contents.n_columns), np.int64)
    rows = np.zeros((n_frames - len(at), contents.n_columns), np.int64)
    data = np.frombuffer(contents.streams[number], np.uint8)
    _check(read_segment(prior(), data, pose, at, keys, rows, number == 0), f"the stream of segment {number}")
    return at, keys, rows


def _check(wrong: int, what: str) -> None:
    if wrong:
        from qmd_studio.codecs.compact.stream import ENDS_EARLY

        problem = "ends early" if wrong == ENDS_EARLY else "holds a number that is out of range"
        raise FormatError(f"{what} {problem}", hint="The file is damaged: fetch or copy it again")
