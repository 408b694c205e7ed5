"""What a motion is encoded with, whole: the profile of the file with its settings, and what is left out before."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.motion import FRAME_RATES, Motion
from qmd_studio.tuning.reduction import Reduction

COMPACT_DEFAULT = CompactSettings(mean_error_mm=0.5, segment=120)
"""What the compact profile starts from: an error that hardly shows, and segments that a stream can join at."""


class Profile(StrEnum):
    """The two kinds of QMD file."""

    PAPER = "paper"
    """Version 1, the paper's format, which any QMD decoder plays."""
    COMPACT = "compact"
    """Version 2: several times smaller, made for an error."""


@dataclass(frozen=True, slots=True)
class EncodeSettings:
    """The `coding` of a file, in the settings of its profile, and the `reduction` of the motion before it."""

    coding: QmdSettings | CompactSettings = field(default_factory=QmdSettings)
    reduction: Reduction = field(default_factory=Reduction)

    @property
    def profile(self) -> Profile:
        """The profile of the file."""
        return Profile.COMPACT if isinstance(self.coding, CompactSettings) else Profile.PAPER

    @property
    def paper(self) -> QmdSettings | None:
        """The settings of the paper's format, None where the file is a compact one."""
        return self.coding if isinstance(self.coding, QmdSettings) else None

    @property
    def compact(self) -> CompactSettings | None:
        """The settings of the compact profile, None where the file is in the paper's format."""
        return self.coding if isinstance(self.coding, CompactSettings) else None

    @property
    def is_bounded(self) -> bool:
        """Whether FDF, b and segments are sought for a bound."""
        return self.paper is not None and self.paper.encoder is Encoder.BOUNDED

    @property
    def size_is_known(self) -> bool:
        """Whether the size can be told before anything is encoded."""
        return self.paper is not None and not self.is_bounded

    def allowing(self, error_mm: float) -> EncodeSettings:
        """Return these settings with another error where they ask for one."""
        if self.compact is not None:
            if self.compact.mean_error_mm is not None:
                return replace(self, coding=replace(self.compact, mean_error_mm=error_mm))
            return replace(self, coding=replace(self.compact, max_error_mm=error_mm))
        return replace(self, coding=replace(self.coding, max_error_mm=error_mm))

    def fitted(self, motion: Motion) -> EncodeSettings:
        """Return these settings as they are for `motion`: FDF lowered, and frames kept, as far as there is need.

        A level of articulation goes where the skeleton has none. Raises `CodecError` for anything else out of range.
        """
        reduction = fitted_reduction(self.reduction, motion)
        n_rows = reduction.n_rows(motion.n_frames)
        if isinstance(self.coding, CompactSettings):
            return EncodeSettings(self.coding.checked(n_rows + 1), reduction)
        n_columns = reduction.n_columns(motion.skeleton)
        return EncodeSettings(self.coding.fitted(n_columns).checked(n_columns, n_rows), reduction)


def fitted_reduction(reduction: Reduction, motion: Motion) -> Reduction:
    """Return `reduction` without what `motion` cannot have: frames too far apart for a file, levels of articulation."""
    most = max(1, min(int(motion.fps / FRAME_RATES[0]), motion.n_frames))
    max_loa = reduction.max_loa if has_articulation(motion) else None
    return replace(reduction, fps_divisor=min(reduction.fps_divisor, most), max_loa=max_loa)


def has_articulation(motion: Motion) -> bool:
    """Return whether levels of articulation are known of the skeleton's columns."""
    return any(column.bap_id for column in motion.skeleton.columns)
