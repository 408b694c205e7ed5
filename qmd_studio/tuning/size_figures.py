"""What an encoding costs, in the figures a person compares: bytes, share of the raw motion, bits a second."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from qmd_studio.codecs.qmd.container import HEADER
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown, n_segments, payload_size
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.compact_size import CompactBreakdown
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction

_FLOAT_BYTES = 4


@dataclass(frozen=True, slots=True)
class SizeFigures:
    """The size of an encoding; of the paper's format it is known before anything is encoded.

    `payload` is the paper's file; `frame_bytes` stand before it (magic, checksum, provenance), `skeleton_bytes` after
    it. `raw_bytes` is the motion matrix as float32, the paper's "original", all of it even where less is encoded.
    `n_segments` is the paper's L.
    """

    payload: SizeBreakdown | CompactBreakdown
    frame_bytes: int
    skeleton_bytes: int
    raw_bytes: int
    duration_s: float
    n_segments: int

    @property
    def file_bytes(self) -> int:
        """The bytes of the whole file that is written."""
        return self.payload.bytes + self.frame_bytes + self.skeleton_bytes

    @property
    def percent_of_raw(self) -> float:
        """The payload in per cent of the raw matrix; above 100 where it is larger."""
        return 100.0 * self.payload.bytes / self.raw_bytes if self.raw_bytes else 0.0

    @property
    def kbit_s(self) -> float:
        """The mean rate of the payload played at the clip's frame rate, in 1000 bits a second."""
        return self.payload.bytes * 8 / 1000 / self.duration_s


@dataclass(frozen=True, slots=True)
class RawFigures:
    """What the motion matrix takes as float32, the paper's "original"."""

    bytes: int
    kbit_s: float


def raw_figures(motion: Motion) -> RawFigures:
    """Return the figures of the motion as it is."""
    raw_bytes = motion.n_frames * motion.skeleton.n_columns * _FLOAT_BYTES
    return RawFigures(raw_bytes, raw_bytes * 8 / 1000 / motion.duration_s)


def size_figures(motion: Motion, settings: QmdSettings, reduction: Reduction | None = None) -> SizeFigures:
    """Return the figures of `settings` (checked for the reduced `motion`) from the closed form."""
    reduction = reduction or Reduction()
    n_rows, n_columns = reduction.n_rows(motion.n_frames), reduction.n_columns(motion.skeleton)
    payload = payload_size(n_rows, n_columns, settings.fdf, settings.bits, settings.segment)
    return figures_of(motion, reduction, payload, n_segments(n_rows, settings.segment))


def known_figures(motion: Motion, settings: EncodeSettings) -> SizeFigures | None:
    """Return the figures of `settings` (fitted to `motion`), None where only encoding will tell."""
    if settings.paper is None or not settings.size_is_known:
        return None
    return size_figures(motion, settings.paper, settings.reduction)


def figures_of(
    motion: Motion, reduction: Reduction, payload: SizeBreakdown | CompactBreakdown, segments: int
) -> SizeFigures:
    """Return the figures of a `payload` of so many `segments` that the reduced `motion` was encoded to."""
    return SizeFigures(
        payload=payload,
        frame_bytes=HEADER.size,
        skeleton_bytes=_skeleton_bytes(motion, reduction),
        raw_bytes=motion.X.size * _FLOAT_BYTES,
        duration_s=motion.duration_s,
        n_segments=segments,
    )


@lru_cache(maxsize=16)
def _skeleton_bytes(motion: Motion, reduction: Reduction) -> int:
    """Return the bytes of the block, the same for all settings: a slider must not pay for it on every tick."""
    if motion.mask is None:  # then one frame says all that the block holds
        motion, reduction = replace(motion, X=motion.X[:1]), replace(reduction, fps_divisor=1)
    return len(pack_skeleton_block(reduction.reduce(motion)))
