"""Motion to QMD: the table and the indices of each segment, packed and put in the container."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import Float32Array, IntArray
from qmd_studio.codecs.qmd import container, payload, tables
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
        decoded=motion.with_values(motion_matrix(encoded.decoded, motion.skeleton)),
    )


def size_of(motion: Motion, settings: QmdSettings) -> SizeBreakdown:
    """Return the size of the payload that `settings` give, from the closed form."""
    n_columns = motion.skeleton.n_columns
    return payload_size(motion.n_frames - 1, n_columns, settings.fdf, settings.bits, settings.segment)


def encode_matrix(matrix: Float32Array, levels: IntArray, settings: QmdSettings) -> EncodedMatrix:
    """Encode (n_frames, n_columns) float32 radians and ASF units; `settings` are checked, `levels` are the columns'."""
    n_rows, n_columns = len(matrix) - 1, matrix.shape[1]
    if n_columns == 0:
        raise CodecError("the motion has no column to encode", hint="Open a motion whose joints move")
    decoded = np.empty_like(matrix)
    decoded[0] = matrix[0]
    segments = []
    for start in range(0, max(n_rows, 1), settings.segment or max(n_rows, 1)):
        stop = min(n_rows, start + settings.segment) if settings.segment else n_rows
        rows = slice(start, stop + 1)
        segments.append(_encode_segment(matrix[rows], decoded[rows], levels, settings))
    return EncodedMatrix(Payload(matrix[0], tuple(segments)), np.ascontiguousarray(decoded.T))


def _encode_segment(matrix: Float32Array, decoded: Float32Array, levels: IntArray, settings: QmdSettings) -> Segment:
    """Encode the rows between the frames of `matrix`; `decoded` has the decoder's first pose, and gets the rest."""
    fdf, bits = settings.fdf, settings.bits
    differences = np.diff(matrix, axis=0)
    if settings.encoder is Encoder.PAPER:
        buckets = tables.equal_frequency_buckets(differences[:, fdf:], bits=bits, rqt=settings.rqt)
        table = tables.averaged_table(differences[:, fdf:], buckets, levels=levels[fdf:], bits=bits, k=settings.k)
        steps = np.concatenate([differences[:, :fdf], table[buckets]], axis=1)
        decoded[1:] = np.add.accumulate(np.concatenate([decoded[:1], steps]), axis=0)[1:]
        return Segment(bits, table, differences[:, :fdf], payload.as_indices(buckets, bits))
    table = tables.companded_table(differences[:, fdf:], bits=bits)
    exact, indices = _closed_loop(matrix, decoded, table, fdf)
    return Segment(bits, table, exact, payload.as_indices(indices, bits))


def _closed_loop(
    matrix: Float32Array, decoded: Float32Array, table: Float32Array, fdf: int
) -> tuple[Float32Array, IntArray]:
    middles = (table[1:] + table[:-1]) * np.float32(0.5)
    exact = np.empty((len(matrix) - 1, fdf), np.float32)
    indices = np.empty((len(matrix) - 1, matrix.shape[1] - fdf), np.int64)
    for row in range(len(matrix) - 1):
        lacking = matrix[row + 1] - decoded[row]
        exact[row] = lacking[:fdf]
        indices[row] = np.searchsorted(middles, lacking[fdf:])
        decoded[row + 1, :fdf] = decoded[row, :fdf] + exact[row]
        decoded[row + 1, fdf:] = decoded[row, fdf:] + table[indices[row]]
    return exact, indices
