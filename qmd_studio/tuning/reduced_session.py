"""Tuning a motion that is reduced before it is encoded: its size, and its error against all of the original."""

from __future__ import annotations

from dataclasses import replace
from threading import Event

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown
from qmd_studio.motion.metrics import MotionError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.report import EncodeReport
from qmd_studio.tuning.session import TuningSession


class ReducedSession:
    """The motion `motion` under a `reduction`: answers as `TuningSession` does, whose rules hold for it too.

    Sizes and bytes are those of the reduced file; errors are of what a player makes of it, frame by frame of the
    original. `whole` is a session of the original, where there is one already. Raises `CodecError` where nothing is
    left, or where what is left cannot be encoded.
    """

    def __init__(self, motion: Motion, reduction: Reduction, whole: TuningSession | None = None) -> None:
        self.motion = motion
        self.reduction = reduction
        self._whole = whole or TuningSession(motion)
        self.reduced = reduction.reduce(motion)
        self._session = self._whole if self.reduces_nothing else TuningSession(self.reduced)

    @property
    def reduces_nothing(self) -> bool:
        """Whether all of the motion is encoded."""
        return self.reduction == Reduction()

    @property
    def skeleton_bytes(self) -> int:
        """The bytes of the block that carries skeleton and names, the same for all settings."""
        return self._session.skeleton_bytes

    def size(self, settings: QmdSettings) -> SizeBreakdown:
        """Return the size of the payload that `settings` give, by formula; raises `CodecError` for bad settings."""
        return self._session.size(settings)

    def file_bytes(self, settings: QmdSettings) -> int:
        """Return the size of the whole file that `settings` give, by formula."""
        return self._session.file_bytes(settings)

    def evaluate(self, settings: QmdSettings, *, draft: bool = False, cancel: Event | None = None) -> EncodeReport:
        """Encode, decode, play and measure; raises as `TuningSession` does. `draft` and `cancel` as there.

        A bound in `settings` is kept where frames and columns were kept, and not between them. The report's `data` is
        the reduced file and `decoded` what it holds; `error` is measured on what is played.
        """
        report = self._session.evaluate(settings, draft=draft, cancel=cancel)
        return report if self.reduces_nothing else replace(report, error=self.measured(report.decoded))

    def measured(self, decoded: Motion) -> MotionError:
        """Return how far what a player shows of `decoded` is from the original."""
        return self._whole.measured_poses(self.played(decoded).X)

    def played(self, decoded: Motion) -> Motion:
        """Return what a player shows of `decoded`, with the frames and columns of the original."""
        return decoded if self.reduces_nothing else self.reduction.restore(decoded, self.motion)
