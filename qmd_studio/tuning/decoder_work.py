"""How often a file makes the decoder in C do each thing: what its instructions and its memory are reckoned from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import IntArray
from qmd_studio.codecs.compact import payload as compact_payload
from qmd_studio.codecs.compact.decode import decode_integers
from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.payload import unpack
from qmd_studio.codecs.qmd.settings import index_bytes

_NARROW, _WIDE = 8, 16
"""At these widths every value of an index lies in the table, and none is checked."""

_FLOAT_BYTES = 4
_MODELS = 146 * 47
"""The models of the compact profile: lists of 47, one for each context of each class."""

_MODEL_BYTES = 3

_COMPACT_AMOUNTS = ("compact_block", "compact_number", "compact_decision", "compact_turn", "compact_product")
"""What a file of version 2 is read through for: blocks, numbers, decisions of the range coder, and in the sums of sines
the turns of the loop and the products."""


@dataclass(frozen=True, slots=True)
class DecoderWork:
    """Amounts by the names of `decoder_cost.csv`, of playing all of a file and of opening it, and its memory."""

    n_frames: int
    n_columns: int
    playing: dict[str, float]
    opening: dict[str, float]
    additions: float
    table_bytes: int = 0
    work_bytes: int = 0


@dataclass(frozen=True, slots=True)
class Part:
    """The counts of a segment of version 1."""

    rows: int
    fdf: int
    bits: int


def work_of_file(data: bytes) -> DecoderWork:
    """Return the work that a file of either version makes; raises `FormatError` for a damaged one."""
    parts = container.parse(data)
    if parts.version == container.COMPACT_VERSION:
        return compact_work(compact_payload.unpack(parts.payload), len(data))
    contents = unpack(parts.payload)
    return paper_work([Part(s.n_rows, s.fdf, s.bits) for s in contents.segments], contents.n_columns, len(data))


def paper_work(parts: list[Part], n_columns: int, file_bytes: int) -> DecoderWork:
    """Return the work that a file of version 1 makes, whose segments are `parts`: the same for any motion."""

    def indices(width: int) -> float:
        return sum(part.rows * (n_columns - part.fdf) for part in parts if index_bytes(part.bits) == width)

    n_rows = sum(part.rows for part in parts)
    return DecoderWork(
        n_frames=n_rows + 1,
        n_columns=n_columns,
        playing={
            "play_frame": n_rows + 1,
            "play_exact": sum(part.rows * part.fdf for part in parts),
            "play_index_8": indices(1),
            "play_index_16": indices(2),
            "play_segment": len(parts),
            "play_first_pose": n_columns,
        },
        opening={
            "open_byte": file_bytes,
            "open_float": n_columns + sum(2**part.bits + part.rows * part.fdf for part in parts),
            "open_index_16": sum(p.rows * (n_columns - p.fdf) for p in parts if _NARROW < p.bits < _WIDE),
            "open_segment": len(parts),
        },
        additions=n_rows * n_columns,
        table_bytes=_FLOAT_BYTES * 2 ** max(part.bits for part in parts),
    )


def compact_work(contents: compact_payload.Payload, file_bytes: int) -> DecoderWork:
    """Return the work that a file of version 2 makes, as its numbers decide; raises `FormatError` as decoding does."""
    m = contents.n_columns
    codes, pose, segments = decode_integers(contents)
    work = dict.fromkeys(_COMPACT_AMOUNTS, 0.0)
    longest = 0
    for number, (at, keys, rows) in enumerate(segments):
        before = keys[:0] if number == 0 else pose[np.newaxis]  # the reference pose is the first segment's first key
        _count_numbers(work, np.diff(np.concatenate([before, keys]), axis=0))
        longest = max(longest, int(np.diff(at).max(initial=0)))
        for i in range(len(at) - 1):
            length, block = int(at[i + 1] - at[i]), rows[at[i] - i : at[i + 1] - i - 1]
            used = block[: int(np.flatnonzero(block.any(axis=1)).max(initial=-1)) + 1]
            _count_numbers(work, used)
            work["compact_block"] += 1
            work["compact_turn"] += length * used.size
            work["compact_product"] += length * np.count_nonzero(used)
    prelude = np.concatenate([np.diff(codes, prepend=128), pose])
    return DecoderWork(
        n_frames=contents.n_frames,
        n_columns=m,
        playing={
            "compact_frame": contents.n_frames,
            "compact_value": contents.n_frames * m,
            "compact_segment": len(segments),
            **work,
        },
        opening={
            "open_byte": file_bytes,
            "compact_open": 1,
            "compact_open_number": prelude.size,
            "compact_open_decision": _decisions(prelude),
        },
        additions=contents.n_frames * m,
        work_bytes=_compact_bytes(m, longest),
    )


def _count_numbers(work: dict[str, float], values: IntArray) -> None:
    work["compact_number"] += values.size
    work["compact_decision"] += _decisions(values)


def _compact_bytes(m: int, longest: int) -> int:
    numbers = 4 * m + longest + 1 + 2 * max(longest - 1, 0) * m
    return 4 * numbers + _MODEL_BYTES * _MODELS + m


def _decisions(values: IntArray) -> float:
    """Return how many decisions of the range coder the numbers take."""
    sizes = np.abs(values).astype(np.float64)
    octave = np.floor(np.log2(np.maximum(sizes, 1.0)))
    bucket = np.where(sizes < 4, sizes, 2 * octave + (sizes >= 1.5 * 2**octave))
    return float((bucket + 1 + np.where(sizes >= 4, octave - 1, 0) + (sizes > 0)).sum())
