"""NPZ: NumPy arrays in a zip, for scripts: `np.load(path)["X"]` is the motion matrix.

Arrays: X (n_frames, n_columns) float64 radians and metres; mask, of the same shape, where there is one; and
description, the bytes of a JSON text with frame rate, name and skeleton. Nothing is pickled.
"""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.errors import FormatError
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.formats.motion_description import describe, parse_description
from qmd_studio.formats.npy import parse_npy
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton_json import MAX_JSON_BYTES

_NAMES = ("description", "X", "mask")
_MOST_MEMBERS = 16
_MOST_BYTES = 1 << 30
_DEFLATE_RATIO = 1032
"""Deflate makes no more than this of a byte; a member that declares more is lying."""
_HEADER_ALLOWANCE = 4096


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is a zip whose first member is an array."""
    if not head.startswith(b"PK\x03\x04") or len(head) < 30:
        return False
    return head[30 : 30 + int.from_bytes(head[26:28], "little")].endswith(b".npy")


def write(motion: Motion) -> bytes:
    """Return an NPZ file that holds `motion` to the last bit."""
    arrays: dict[str, NDArray[Any]] = {
        "description": np.frombuffer(describe(motion).encode(), dtype=np.uint8),
        "X": motion.X,
    }
    if motion.mask is not None:
        arrays["mask"] = motion.mask
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read an NPZ file that `write` wrote, or one of that kind.

    The members are counted and their declared sizes held against the bytes there are before anything is inflated.
    Raises `FormatError` naming the array.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = _members(archive)
            description = parse_description(_array(archive, members, "description", MAX_JSON_BYTES).tobytes())
            X = _array(archive, members, "X", _MOST_BYTES)
            mask = _array(archive, members, "mask", X.size) if "mask" in members else None
    except (zipfile.BadZipFile, zlib.error, struct.error, EOFError, ValueError, RuntimeError, OSError) as problem:
        raise FormatError("the zip cannot be read", got=str(problem)[:80], hint="Get a whole copy") from None
    if X.ndim != 2 or X.dtype.kind != "f":
        raise FormatError("X is no matrix of numbers", at="array 'X'", got=f"{X.dtype} {X.shape}")
    if mask is not None and mask.dtype != np.bool_:
        raise FormatError("the mask is not true and false", at="array 'mask'", wanted="bool", got=str(mask.dtype))
    return description.loaded(X.astype(np.float64, copy=False), mask, options)


def _members(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Return the known members by array name, their declared sizes checked."""
    entries = archive.infolist()
    if len(entries) > _MOST_MEMBERS:
        raise FormatError("the zip has too many members", wanted=f"at most {_MOST_MEMBERS}", got=str(len(entries)))
    members: dict[str, zipfile.ZipInfo] = {}
    for entry in entries:
        name = entry.filename.removesuffix(".npy")
        if name not in _NAMES:
            continue
        if name in members:
            raise FormatError("the zip holds an array twice", at=f"array {name!r}")
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) or entry.flag_bits & 1:
            raise FormatError("the array is packed in a way that is not read", at=f"array {name!r}", wanted="deflate")
        if entry.file_size > _DEFLATE_RATIO * entry.compress_size + _HEADER_ALLOWANCE:
            got = f"{entry.file_size} bytes from {entry.compress_size}"
            raise FormatError("the array declares more than its bytes can hold", at=f"array {name!r}", got=got)
        members[name] = entry
    for name in ("description", "X"):
        if name not in members:
            raise FormatError(
                "the zip holds no motion",
                wanted=f"an array {name!r}",
                got=", ".join(members) or "none of the studio's arrays",
                hint="Only NPZ files that the studio wrote, or that are made alike, can be opened",
            )
    return members


def _array(archive: zipfile.ZipFile, members: dict[str, zipfile.ZipInfo], name: str, most_bytes: int) -> NDArray[Any]:
    entry = members[name]
    limit = most_bytes + _HEADER_ALLOWANCE
    if entry.file_size > limit:
        raise FormatError("the array is too large", at=f"array {name!r}", wanted=f"at most {limit} bytes")
    with archive.open(entry) as stream:
        return parse_npy(stream.read(entry.file_size + 1), name)


FORMAT = Format(name="npz", title="NumPy archive", suffixes=(".npz",), sniff=sniff, read=read, write=write)
