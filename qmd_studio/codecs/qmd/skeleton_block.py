"""The trailing block of a QMD file: the skeleton, the motion's name and its mask, as compressed JSON."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from qmd_studio.arrays import BoolArray
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.motion.skeleton_json import json_text, parse_json, skeleton_from_json, skeleton_to_json

_PREFIX = struct.Struct("<I")
"""The length of the inflated JSON, before the zlib stream."""

_LARGEST_SKELETON = 1 << 20
"""Bytes of JSON: a body of a thousand columns takes a tenth of it."""

_LARGEST_PER_PAYLOAD_BYTE = 8
"""A mask that flips at every value takes up to 8 characters for each, and a value at least a byte of the payload."""

_SMALL_BLOCK = 1 << 16
"""Larger blocks, which are those of long masks, are not remembered."""


@dataclass(frozen=True, slots=True, eq=False)
class SkeletonBlock:
    """What the block holds. `mask` (n_frames, n_columns) as in `Motion`."""

    skeleton: Skeleton
    name: str = ""
    mask: BoolArray | None = None


def pack_skeleton_block(motion: Motion) -> bytes:
    """Return the block's bytes for a motion.

    Raises `CodecError` for a skeleton whose text is too long for readers, `FormatError` for one of too many parts.
    """
    if motion.mask is None:
        return _packed_without_mask(motion.skeleton, motion.name)
    values = _contents(motion.skeleton, motion.name) | {"mask": _flips(motion.mask)}
    return _deflated(values, _limit(payload_bytes=motion.X.size))  # no payload takes fewer bytes than it has values


def unpack_skeleton_block(block: memoryview, *, n_frames: int, payload_bytes: int) -> SkeletonBlock:
    """Return what a block holds.

    The declared inflated length is held against the bytes there are before anything is inflated. Raises `FormatError`
    for a block that is damaged, too large, or describes no skeleton.
    """
    if len(block) < _PREFIX.size:
        raise FormatError("the skeleton block ends early", wanted=f"{_PREFIX.size} bytes", got=str(len(block)))
    declared, limit = _declared(block), _limit(payload_bytes)
    if declared > limit:
        raise FormatError("the skeleton block is too large", wanted=f"at most {limit} bytes", got=str(declared))
    contents = (_known_contents if len(block) <= _SMALL_BLOCK else _contents_of)(bytes(block))
    mask = _mask(contents.flips, n_frames, contents.skeleton.n_columns) if contents.has_mask else None
    return SkeletonBlock(contents.skeleton, contents.name, mask)


@dataclass(frozen=True, slots=True, eq=False)
class _Contents:
    """A block's text, read but for the mask, whose `flips` only a motion of known length can judge."""

    skeleton: Skeleton
    name: str
    has_mask: bool
    flips: Any


def _contents_of(block: bytes) -> _Contents:
    values = _inflated(block)
    if not isinstance(values.get("name"), str):
        raise FormatError("the skeleton block has no name", wanted="an object with name and skeleton")
    skeleton = skeleton_from_json(values.get("skeleton"))
    return _Contents(skeleton, values["name"], "mask" in values, values.get("mask"))


@lru_cache(maxsize=4)
def _known_contents(block: bytes) -> _Contents:
    return _contents_of(block)  # clips of one figure, and one clip played again, carry the same block


@lru_cache(maxsize=8)
def _packed_without_mask(skeleton: Skeleton, name: str) -> bytes:
    return _deflated(_contents(skeleton, name), _limit(0))  # while a slider is dragged it stays what it was


def _contents(skeleton: Skeleton, name: str) -> dict[str, Any]:
    units = {"angle": "rad", "length": "m"}
    return {"name": name, "units": units, "skeleton": skeleton_to_json(skeleton)}


def _limit(payload_bytes: int) -> int:
    return _LARGEST_SKELETON + _LARGEST_PER_PAYLOAD_BYTE * payload_bytes


def _deflated(values: dict[str, Any], limit: int) -> bytes:
    text = json_text(values).encode()
    if len(text) > limit:
        raise CodecError(
            "the skeleton is too large for a QMD file",
            wanted=f"at most {limit} bytes of JSON",
            got=str(len(text)),
            hint="Write the file without its skeleton block",
        )
    return _PREFIX.pack(len(text)) + zlib.compress(text, 9)


def _declared(block: bytes | memoryview) -> int:
    length: int = _PREFIX.unpack_from(block)[0]
    return length


def _inflated(block: bytes) -> dict[str, Any]:
    declared = _declared(block)
    stream = zlib.decompressobj()
    try:
        text = stream.decompress(block[_PREFIX.size :], declared + 1)
        if len(text) != declared or not stream.eof or stream.unused_data:
            raise FormatError("the skeleton block is not as long as it says", wanted=f"{declared} bytes")
    except zlib.error as problem:
        raise FormatError("the skeleton block cannot be inflated", got=str(problem)) from None
    return parse_json(text, limit=declared)


def _flips(mask: BoolArray) -> list[list[int]]:
    """Return for each column the frames at which its mask turns over, starting from False."""
    before = np.concatenate([np.zeros((1, mask.shape[1]), dtype=np.bool_), mask[:-1]])
    return [np.flatnonzero(column).tolist() for column in (mask != before).T]


def _mask(flips: Any, n_frames: int, n_columns: int) -> BoolArray:
    if not isinstance(flips, list) or len(flips) != n_columns:
        raise FormatError("the mask does not fit the skeleton", wanted=f"{n_columns} columns")
    turned = np.zeros((n_frames, n_columns), dtype=np.bool_)
    for column, frames in enumerate(flips):
        if not isinstance(frames, list) or not all(type(f) is int and 0 <= f < n_frames for f in frames):
            raise FormatError(
                "the mask does not fit the motion", at=f"column {column}", wanted=f"frames below {n_frames}"
            )
        turned[frames, column] = True
    return np.logical_xor.accumulate(turned, axis=0)
