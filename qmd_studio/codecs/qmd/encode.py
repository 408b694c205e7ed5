"""Motion to QMD: the table and the indices of each segment, packed and put in the container."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import Float32Array, IntArray
from qmd_studio.codecs.qmd import container, payload, tables
from qmd_studio.codecs.qmd.decode import decode_payload
from qmd_studio.codecs.qmd.payload import Payload, Segment
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown, payload_size
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import codec_matrix, motion_matrix
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, slots=True, eq=False)
class Encoded:
    """An encoding: `data` the whole file, the payload's `size`, the bytes of the skeleton block, what it decodes to."""

    data: bytes
    size: SizeBreakdown
    skeleton_bytes: int
    decoded: Motion


@dataclass(frozen=True, slots=True, eq=False)
class EncodedMatrix:
    """A payload, and `decoded` (n_columns, n_frames) float32, column after column: what every decoder makes of it."""

    payload: Payload
    decoded: Float32Array


def encode(motion: Motion, settings: QmdSettings | None = None, *, with_skeleton: bool = True) -> Encoded:
    """Encode a motion as a QMD file, with or without the block that lets it play without its skeleton's own file.

    Raises `CodecError` for settings out of range, a motion without columns, and values that float32 cannot hold.
    """
    settings = (settings or QmdSettings().fitted(motion.skeleton.n_columns)).checked(
        motion.skeleton.n_columns, motion.n_frames - 1
    )
    encoded = encode_matrix(codec_matrix(motion), np.array(motion.skeleton.levels, dtype=np.int64), settings)
    block = pack_skeleton_block(motion) if with_skeleton else b""
    return Encoded(
        data=container.build(payload.pack(encoded.payload), block, motion.fps, settings),
        size=size_of(motion, settings),
        skeleton_bytes=len(block),
        decoded=motion.with_values(motion_matrix(encoded.decoded.T, motion.skeleton)),
    )


def size_of(motion: Motion, settings: QmdSettings) -> SizeBreakdown:
    """Return the size of the payload that `settings` give, from the closed form."""
    n_columns = motion.skeleton.n_columns
    return payload_size(motion.n_frames - 1, n_columns, settings.fdf, settings.bits, settings.segment)


def encode_matrix(matrix: Float32Array, levels: IntArray, settings: QmdSettings) -> EncodedMatrix:
    """Encode (n_frames, n_columns) float32 radians and ASF units; `settings` are checked, `levels` are the columns'."""
    if matrix.shape[1] == 0:
        raise CodecError("the motion has no column to encode", hint="Open a motion whose joints move")
    if settings.encoder is Encoder.PAPER:
        return _encode_open_loop(matrix, levels, settings)
    return _encode_closed_loop(matrix, settings)


def _encode_open_loop(matrix: Float32Array, levels: IntArray, settings: QmdSettings) -> EncodedMatrix:
    """Encode as the paper does: each segment by itself, from the original differences."""
    fdf, bits = settings.fdf, settings.bits
    segments = []
    for rows in _segment_rows(len(matrix) - 1, settings.segment):
        differences = np.diff(matrix[rows], axis=0)
        quantised = differences[:, fdf:]
        buckets = tables.equal_frequency_buckets(quantised, bits=bits, rqt=settings.rqt)
        table = tables.averaged_table(quantised, buckets, levels=levels[fdf:], bits=bits, k=settings.k)
        exact = np.ascontiguousarray(differences[:, :fdf])
        segments.append(Segment(bits, table, exact, buckets.astype(payload.index_type(bits))))
    contents = Payload(matrix[0], tuple(segments))
    return EncodedMatrix(contents, np.ascontiguousarray(decode_payload(contents).T))


def _encode_closed_loop(matrix: Float32Array, settings: QmdSettings) -> EncodedMatrix:
    """Encode each difference from where the decoder stands, its state carried on from segment to segment."""
    from qmd_studio.codecs.qmd.kernels import closed_loop  # compiled code, loaded where it is first needed

    fdf, bits = settings.fdf, settings.bits
    n_frames, n_columns = matrix.shape
    decoded = np.empty((n_columns, n_frames), np.float32)
    decoded[:, 0] = pose = matrix[0].copy()
    segments = []
    for rows in _segment_rows(n_frames - 1, settings.segment):
        part, n_rows = matrix[rows], rows.stop - rows.start - 1
        table = tables.companded_table(np.diff(part[:, fdf:], axis=0), bits=bits)
        exact = np.empty((n_rows, fdf), np.float32)
        indices = np.empty((n_rows, n_columns - fdf), payload.index_type(bits))
        if n_rows:
            there = decoded[:, rows.start + 1 : rows.stop]
            closed_loop(part, table, tables.middles(table), pose, exact, indices, there)
        segments.append(Segment(bits, table, exact, indices))
    return EncodedMatrix(Payload(matrix[0], tuple(segments)), decoded)


def _segment_rows(n_rows: int, segment: int) -> Iterator[slice]:
    """Yield the frames that each segment's differences lie between; a segment of 0 rows where there are none."""
    step = segment or max(n_rows, 1)
    for start in range(0, max(n_rows, 1), step):
        yield slice(start, min(start + step, n_rows) + 1)
