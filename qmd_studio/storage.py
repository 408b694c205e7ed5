"""The one way to write a user's file: whole or not at all, so that a crash never leaves half of one."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path
from typing import BinaryIO

from qmd_studio.errors import StorageError

MAX_FILE_BYTES = 1 << 30
"""Larger files are refused before they are read: no motion or avatar this studio plays comes near a gigabyte."""


def read_bytes(path: Path | str, *, limit: int = MAX_FILE_BYTES) -> bytes:
    """Read a whole file of at most `limit` bytes.

    Raises `StorageError` where the file is missing, is a folder, cannot be read or is larger than `limit`.
    """
    path = Path(path)
    try:
        with path.open("rb") as stream:
            data = _read_at_most(stream, limit + 1)
    except IsADirectoryError as problem:
        raise StorageError("is a folder", path=path, wanted="a file", hint="Name a file that is in it") from problem
    except (OSError, ValueError) as problem:  # ValueError: no file can have this name
        raise StorageError(
            _reason(problem), path=path, hint="Check the name and that you may read the file"
        ) from problem
    if len(data) > limit:
        raise StorageError("the file is too large to open", path=path, wanted=f"at most {limit:,} bytes")
    return data


def write_atomic(path: Path | str, data: bytes) -> None:
    """Write `data` to `path` so that the name holds the old bytes or the new ones at every instant.

    A temporary file in the same folder is written, flushed and fsynced, then renamed over `path`, and the folder is
    fsynced. A link is followed, an existing file keeps its permissions. Raises `StorageError`; the old file then still
    stands and the temporary one is gone. A device or a pipe is refused: the renaming would put a file in its place.
    """
    target = _target(path)
    if _is_special(target):
        raise StorageError(
            "this is a device or a pipe, which cannot be written whole or not at all",
            path=path,
            wanted="the name of a file",
            hint="Write a file and send that on",
        )
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(6)}.tmp")
    try:
        _write_and_sync(temporary, data, mode=_mode_of(target))
        os.replace(temporary, target)
        _sync_folder(target.parent)
    except OSError as problem:
        raise StorageError(
            f"the file could not be written: {_reason(problem)}",
            path=path,
            hint=_way_out(target, problem),
        ) from problem
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def _read_at_most(stream: BinaryIO, count: int) -> bytes:
    """Return up to `count` bytes, taking memory for what is there rather than for `count`, as one `read` would."""
    told = os.fstat(stream.fileno()).st_size + 1
    data = stream.read(min(count, told))
    if len(data) < min(count, told):
        return data
    pieces = [data]  # a file that grows, or one that tells no size, such as a pipe
    count -= len(data)
    while count > 0 and (piece := stream.read(min(count, 1 << 22))):
        pieces.append(piece)
        count -= len(piece)
    return b"".join(pieces)


def _target(path: Path | str) -> Path:
    try:
        return Path(os.path.realpath(path))
    except ValueError as problem:
        raise StorageError(f"no file can have this name: {problem}", path=path, hint="Choose another name") from problem


def _way_out(target: Path, problem: OSError) -> str:
    if isinstance(problem, FileNotFoundError) and not target.parent.exists():
        return f"There is no folder {target.parent}; make it first, or choose another"
    if isinstance(problem, IsADirectoryError):
        return "A folder has this name; choose another name"
    return "Choose another folder or free some room; what stood there before is untouched"


def _is_special(target: Path) -> bool:
    try:
        mode = target.stat().st_mode
    except OSError:
        return False  # nothing stands there yet, or what is amiss will show when it is written
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _mode_of(target: Path) -> int | None:
    try:
        return target.stat().st_mode & 0o777
    except OSError:
        return None  # a new file, whose permissions are the user's default


def _write_and_sync(path: Path, data: bytes, *, mode: int | None) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666 if mode is None else mode)
    with os.fdopen(descriptor, "wb") as stream:
        if mode is not None:
            path.chmod(mode)  # the default mask has taken away what the old file granted
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def _sync_folder(folder: Path) -> None:
    if os.name == "nt":
        return  # Windows can neither open nor fsync a folder
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _reason(problem: OSError | ValueError) -> str:
    return (getattr(problem, "strerror", None) or str(problem)).lower()
