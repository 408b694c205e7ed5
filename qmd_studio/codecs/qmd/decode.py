"""QMD of either version to motion; version 1 is looked up and added."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.compact import payload as compact_payload
from qmd_studio.codecs.compact.decode import decode_payload as decode_compact
from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.payload import Payload, Segment, unpack
from qmd_studio.codecs.qmd.skeleton_block import SkeletonBlock, unpack_skeleton_block
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.errors import FormatError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton

_SMALL = 1 << 16
"""Up to this many values a motion is decoded before the compiled code would have been loaded."""


def decode(data: bytes, skeleton: Skeleton | None = None) -> Motion:
    """Return the motion that a QMD file holds.

    `skeleton` is used where the file has no skeleton block of its own. Raises `FormatError` for a damaged file, and for
    one that needs a skeleton and got none, or one with another number of columns.
    """
    parts = container.parse(data)
    contents = (
        compact_payload.unpack(parts.payload) if parts.version == container.COMPACT_VERSION else unpack(parts.payload)
    )
    block = _block_of(parts, contents.n_frames, contents.n_columns, skeleton)
    if block.skeleton.n_columns != contents.n_columns:
        raise FormatError(
            "the skeleton does not fit the motion",
            wanted=f"{contents.n_columns} columns",
            got=f"{block.skeleton.n_columns} in {block.skeleton.name!r}",
            hint="Give the skeleton that the motion was made on",
        )
    decoded = decode_payload(contents) if isinstance(contents, Payload) else decode_compact(contents)
    return Motion(block.skeleton, motion_matrix(decoded, block.skeleton), parts.fps, block.name, block.mask)


def decode_payload(contents: Payload) -> Float32Array:
    """Return what a payload holds, (n_frames, n_columns) float32 radians and ASF units.

    Each value is the one before it plus an exact difference or a table entry, in float32, one after another: the
    encoder counts on exactly this arithmetic. Raises `FormatError` where the sums leave float32's range.
    """
    decoded = np.empty((contents.n_rows + 1, len(contents.pose)), np.float32)
    decoded[0] = contents.pose
    if decoded.size <= _SMALL:
        _add_up(contents.segments, decoded)
    else:
        _add_up_compiled(contents.segments, decoded)
    if not np.isfinite(decoded[-1]).all():  # a sum that has left the range never comes back
        raise FormatError("the motion leaves the range of float32", hint="The file's table is not that of a motion")
    return decoded


def _add_up(segments: tuple[Segment, ...], decoded: Float32Array) -> None:
    """Fill in all rows of `decoded` after the first."""
    row = 1
    for segment in segments:
        rows = decoded[row : row + segment.n_rows]
        rows[:, : segment.fdf] = segment.exact
        rows[:, segment.fdf :] = segment.table[segment.indices]
        row += segment.n_rows
    with np.errstate(over="ignore", invalid="ignore"):  # looked for afterwards
        np.add.accumulate(decoded, axis=0, out=decoded)


def _add_up_compiled(segments: tuple[Segment, ...], decoded: Float32Array) -> None:
    """Do what `_add_up` does, to the last bit, several times as fast."""
    from qmd_studio.codecs.qmd.kernels import accumulate  # compiled code, loaded where it is first needed

    row = 0
    for segment in segments:
        rows = decoded[row + 1 : row + 1 + segment.n_rows]
        accumulate(segment.table, decoded[row], segment.exact, segment.indices, rows)
        row += segment.n_rows


def _block_of(parts: container.Container, n_frames: int, n_columns: int, skeleton: Skeleton | None) -> SkeletonBlock:
    if parts.skeleton_block:
        return unpack_skeleton_block(parts.skeleton_block, n_frames=n_frames, payload_bytes=len(parts.payload))
    if skeleton is None:
        raise FormatError(
            "the file has no skeleton of its own",
            wanted=f"a skeleton with {n_columns} columns",
            hint="Convert it, and give a motion on the same skeleton (the .amc it came from, say) with --skeleton",
        )
    return SkeletonBlock(skeleton)
