"""Writing what was measured: a name that says the settings, and a file that never replaces a different one unasked."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import StorageError
from qmd_studio.storage import read_bytes, write_atomic

_FORBIDDEN = frozenset('<>:"/\\|?*')
_SETTINGS_IN_NAME = re.compile(r"(?<=.)__(fdf\d+_b\d+_nd\d+(_[a-z0-9.]+)*|within[0-9.e-]+mm)(-\d+)?$")
_MAX_NUMBER = 9999


@dataclass(frozen=True, slots=True)
class Exported:
    """A file that now holds the bytes; `written` is False where it held just these already."""

    path: Path
    n_bytes: int
    written: bool


def suggested_name(stem: str, settings: QmdSettings, n_rows: int) -> str:
    """Return the file name for an encoding of `n_rows` differences, "walk__fdf6_b8_nd342.qmd".

    The paper's encoder adds "_paper", and k, RQT and "_width" where they are not its defaults; the plain one adds
    "_plain". A bounded file is named after its bound, "walk__within1mm.qmd", for the rest was not asked for.
    Characters that a file system refuses become "_"; settings that an earlier export left at the end of the stem go.
    """
    stem = _SETTINGS_IN_NAME.sub("", stem)
    cleaned = "".join("_" if c in _FORBIDDEN or ord(c) < 32 else c for c in stem).strip(". ") or "motion"
    if settings.encoder is Encoder.BOUNDED:
        return f"{cleaned}__within{settings.max_error_mm:g}mm.qmd"
    name = f"{cleaned}__fdf{settings.fdf}_b{settings.bits}_nd{settings.segment or n_rows}"
    if settings.encoder is not Encoder.CLOSED:
        name += f"_{settings.encoder}"
    if settings.encoder is Encoder.PAPER:
        name += "" if math.isinf(settings.k) else f"_k{settings.k:g}"
        name += "" if settings.rqt == QmdSettings().rqt else f"_rqt{settings.rqt}"
        name += "" if settings.buckets is Buckets.FREQUENCY else f"_{settings.buckets}"
    return f"{name}.qmd"


def export_numbered(data: bytes, path: Path) -> Exported:
    """Write `data` to `path`, or to `path` with -2, -3 … where another file stands there.

    A file that already holds these very bytes is left as it is. Raises `StorageError` where nothing can be written.
    """
    for number in range(1, _MAX_NUMBER + 1):
        candidate = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
        if not candidate.exists():
            write_atomic(candidate, data)
            return Exported(candidate, len(data), written=True)
        if _holds(candidate, data):
            return Exported(candidate, len(data), written=False)
    raise StorageError("every numbered name is taken", path=path, hint="Choose another name or folder")


def export_over(data: bytes, path: Path) -> Exported:
    """Write `data` to `path`, which the user named; what stood there is replaced. Raises `StorageError`."""
    write_atomic(path, data)
    return Exported(path, len(data), written=True)


def _holds(path: Path, data: bytes) -> bool:
    try:
        return path.is_file() and path.stat().st_size == len(data) and read_bytes(path) == data
    except (OSError, StorageError):
        return False  # not ours to read: the next number is free of doubt
