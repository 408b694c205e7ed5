"""Writing what was measured: a name that says the settings, and a file that never replaces a different one unasked."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import StorageError
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.storage import read_bytes, write_atomic
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction

_FORBIDDEN = frozenset('<>:"/\\|?*')
_SETTINGS_IN_NAME = re.compile(
    r"(?<=.)__(fdf\d+_b\d+_nd\d+(_[a-z0-9.]+)*|(compact_)?(within|mean)[0-9.e-]+mm(_[a-z0-9.]+)*)(-\d+)?$"
)
_MAX_NUMBER = 9999


@dataclass(frozen=True, slots=True)
class Exported:
    """A file that now holds the bytes; `written` is False where it held just these already."""

    path: Path
    n_bytes: int
    written: bool


def suggested_name(stem: str, settings: EncodeSettings, n_frames: int) -> str:
    """Return the file name for an encoding of a motion of `n_frames`, "walk__fdf6_b8_nd342.qmd".

    The paper's encoder adds "_paper", and k, RQT and "_width" where they are not its defaults; the plain one adds
    "_plain". A file made for an error is named after it, "walk__within1mm.qmd", for the rest was not asked for; in the
    compact profile "walk__compact_mean0.5mm_seg120.qmd". What is left out follows: "_every2_level4". Characters that a
    file system refuses become "_"; settings that an earlier export left at the end of the stem go.
    """
    stem = _SETTINGS_IN_NAME.sub("", stem)
    cleaned = "".join("_" if c in _FORBIDDEN or ord(c) < 32 else c for c in stem).strip(". ") or "motion"
    coding, left = settings.coding, _left_in_name(settings.reduction)
    if isinstance(coding, CompactSettings):
        return f"{cleaned}__{_compact_name(coding)}{left}.qmd"
    return f"{cleaned}__{_paper_name(coding, settings.reduction.n_rows(n_frames))}{left}.qmd"


def _compact_name(settings: CompactSettings) -> str:
    mean, worst = settings.mean_error_mm, settings.max_error_mm
    error = f"mean{mean:g}mm" if mean is not None else f"within{worst:g}mm"
    return f"compact_{error}" + (f"_seg{settings.segment}" if settings.segment else "")


def _left_in_name(reduction: Reduction) -> str:
    name = f"_every{reduction.fps_divisor}" if reduction.fps_divisor > 1 else ""
    name += f"_level{reduction.max_level}" if reduction.max_level < MAX_LEVEL else ""
    return name + (f"_loa{reduction.max_loa}" if reduction.max_loa is not None else "")


def _paper_name(settings: QmdSettings, n_rows: int) -> str:
    if settings.encoder is Encoder.BOUNDED:
        return f"within{settings.max_error_mm:g}mm"
    name = f"fdf{settings.fdf}_b{settings.bits}_nd{settings.segment or n_rows}"
    if settings.encoder is not Encoder.CLOSED:
        name += f"_{settings.encoder}"
    if settings.encoder is Encoder.PAPER:
        name += "" if math.isinf(settings.k) else f"_k{settings.k:g}"
        name += "" if settings.rqt == QmdSettings().rqt else f"_rqt{settings.rqt}"
        name += "" if settings.buckets is Buckets.FREQUENCY else f"_{settings.buckets}"
    return name


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
