"""The trailing block of a QMD file: the skeleton, the motion's name and its mask, as compressed JSON."""

from __future__ import annotations

import json
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
from qmd_studio.motion.skeleton_json import json_text, skeleton_from_json, skeleton_to_json

_PREFIX = struct.Struct("<I")
"""The length of the inflated JSON, before the zlib stream."""

_LARGEST_SKELETON = 1 << 20
"""Bytes of JSON: a body of a thousand columns takes a tenth of it."""

_LARGEST_PER_PAYLOAD_BYTE = 8
"""A mask that flips at every value takes up to 8 characters for each, and a value at least a byte of the payload."""


@dataclass(frozen=True, slots=True, eq=False)
class SkeletonBlock:
    """What the block holds. `mask` (n_frames, n_columns) as in `Motion`."""

    skeleton: Skeleton
    name: str = ""
    mask: BoolArray | None = None


def pack_skeleton_block(motion: Motion) -> bytes:
    """Return the block's bytes for a motion; raises `CodecError` for a skeleton that readers would not take."""
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
    values = _inflated(bytes(block), _limit(payload_bytes))
    if not isinstance(values, dict) or not isinstance(values.get("name"), str):
        raise FormatError("the skeleton block has no name", wanted="an object with name and skeleton")
    skeleton = skeleton_from_json(values.get("skeleton"))
    mask = _mask(values["mask"], n_frames, skeleton.n_columns) if "mask" in values else None
    return SkeletonBlock(skeleton, values["name"], mask)


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


def _inflated(block: bytes, limit: int) -> Any:
    (declared,) = _PREFIX.unpack_from(block)
    if declared > limit:
        raise FormatError("the skeleton block is too large", wanted=f"at most {limit} bytes", got=str(declared))
    stream = zlib.decompressobj()
    try:
        text = stream.decompress(block[_PREFIX.size :], declared + 1)
        if len(text) != declared or not stream.eof or stream.unused_data:
            raise FormatError("the skeleton block is not as long as it says", wanted=f"{declared} bytes")
        return json.loads(text)
    except (zlib.error, ValueError, RecursionError) as problem:
        raise FormatError(f"the skeleton block cannot be read: {problem}") from problem


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
