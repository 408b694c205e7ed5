"""Motion to QMD: the table and the indices of each segment, packed and put in the container."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from threading import Event

import numpy as np

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd import container, payload, tables
from qmd_studio.codecs.qmd.choice import Choose, chooser
from qmd_studio.codecs.qmd.decode import decode_payload
from qmd_studio.codecs.qmd.payload import Payload, Segment
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown, payload_size
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import codec_matrix, motion_matrix
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton

DRAFT_REFRESH = 8
"""A draft works out every so many rows what the columns do to the joints: a third of the time, 1.6 times the error."""


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

    Raises `CodecError` for settings out of range, a motion without columns, values that float32 cannot hold, and a
    bound that no setting meets.
    """
    settings = (settings or QmdSettings().fitted(motion.skeleton.n_columns)).checked(
        motion.skeleton.n_columns, motion.n_frames - 1
    )
    encoded = encode_matrix(codec_matrix(motion), motion.skeleton, settings)
    block = pack_skeleton_block(motion) if with_skeleton else b""
    return Encoded(
        data=container.build(payload.pack(encoded.payload), block, motion.fps, settings),
        size=encoded.payload.size,
        skeleton_bytes=len(block),
        decoded=motion.with_values(motion_matrix(encoded.decoded.T, motion.skeleton)),
    )


def size_of(motion: Motion, settings: QmdSettings) -> SizeBreakdown:
    """Return the size of the payload that `settings` give, from the closed form.

    Raises `CodecError` for the bounded encoder, whose size is not known before it has run.
    """
    if settings.encoder is Encoder.BOUNDED:
        raise CodecError("the size of a bounded file is known only once it is encoded")
    n_columns = motion.skeleton.n_columns
    return payload_size(motion.n_frames - 1, n_columns, settings.fdf, settings.bits, settings.segment)


def encode_matrix(
    matrix: Float32Array,
    skeleton: Skeleton,
    settings: QmdSettings,
    *,
    draft: bool = False,
    cancel: Event | None = None,
) -> EncodedMatrix:
    """Encode (n_frames, n_columns) float32 radians and ASF units on `skeleton`; `settings` are checked.

    A `draft`, for a slider that is being dragged, may take a quicker choice of the indices; its size is the same.
    The bounded encoder, which takes long, raises `Cancelled` soon after `cancel` is set.
    """
    if matrix.shape[1] == 0:
        raise CodecError("the motion has no column to encode", hint="Open a motion whose joints move")
    if settings.encoder is Encoder.PAPER:
        return _encode_open_loop(matrix, skeleton, settings)
    if settings.encoder is Encoder.BOUNDED:
        from qmd_studio.codecs.qmd.bounded import encode_bounded  # the search, and compiled code with it

        found = encode_bounded(matrix, skeleton, settings.max_error_mm, cancel)
        return EncodedMatrix(found, np.ascontiguousarray(decode_payload(found).T))
    refresh = DRAFT_REFRESH if draft else 1
    by_joints = settings.encoder is Encoder.CLOSED
    return _encode_closed_loop(matrix, chooser(skeleton, settings.fdf, refresh if by_joints else None), settings)


def _encode_open_loop(matrix: Float32Array, skeleton: Skeleton, settings: QmdSettings) -> EncodedMatrix:
    """Encode as the paper does: each segment by itself, from the original differences."""
    fdf, bits = settings.fdf, settings.bits
    levels = np.array(skeleton.levels[fdf:], dtype=np.int64)
    sort = tables.equal_width_buckets if settings.buckets is Buckets.WIDTH else tables.equal_frequency_buckets
    segments = []
    for rows in segment_rows(len(matrix) - 1, settings.segment):
        differences = np.diff(matrix[rows], axis=0)
        quantised = differences[:, fdf:]
        buckets = sort(quantised, bits=bits, rqt=settings.rqt)
        table = tables.averaged_table(quantised, buckets, levels=levels, bits=bits, k=settings.k)
        exact = np.ascontiguousarray(differences[:, :fdf])
        segments.append(Segment(bits, table, exact, buckets.astype(payload.index_type(bits))))
    contents = Payload(matrix[0], tuple(segments))
    return EncodedMatrix(contents, np.ascontiguousarray(decode_payload(contents).T))


def _encode_closed_loop(matrix: Float32Array, choose: Choose, settings: QmdSettings) -> EncodedMatrix:
    """Encode each difference from where the decoder stands, its state carried on from segment to segment."""
    fdf, bits = settings.fdf, settings.bits
    n_frames, n_columns = matrix.shape
    decoded = np.empty((n_columns, n_frames), np.float32)
    decoded[:, 0] = pose = matrix[0].copy()
    segments = []
    for rows in segment_rows(n_frames - 1, settings.segment):
        part, n_rows = matrix[rows], rows.stop - rows.start - 1
        table = tables.companded_table(np.diff(part[:, fdf:], axis=0), bits=bits)
        exact = np.empty((n_rows, fdf), np.float32)
        indices = np.empty((n_rows, n_columns - fdf), payload.index_type(bits))
        if n_rows:
            there = decoded[:, rows.start + 1 : rows.stop]
            choose(part, table, tables.middles(table), pose, exact, indices, there)
        segments.append(Segment(bits, table, exact, indices))
    return EncodedMatrix(Payload(matrix[0], tuple(segments)), decoded)


def segment_rows(n_rows: int, segment: int) -> Iterator[slice]:
    """Yield the frames that each segment's differences lie between; a segment of 0 rows where there are none."""
    step = segment or max(n_rows, 1)
    for start in range(0, max(n_rows, 1), step):
        yield slice(start, min(start + step, n_rows) + 1)
