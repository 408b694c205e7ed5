"""Tuning a motion that is reduced before it is encoded: its size, and its error against all of the original."""

from __future__ import annotations

from dataclasses import replace

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.report import EncodeReport
from qmd_studio.tuning.session import TuningSession


class ReducedSession:
    """The motion `motion` under a `reduction`: answers as `TuningSession` does, whose rules hold for it too.

    Sizes and bytes are those of the reduced file; errors are of what a player makes of it, frame by frame of the
    original. Raises `CodecError` where nothing is left, or where what is left cannot be encoded.
    """

    def __init__(self, motion: Motion, reduction: Reduction) -> None:
        self.motion = motion
        self.reduction = reduction
        self.reduced = reduction.reduce(motion)
        self._session = TuningSession(self.reduced)

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

    def evaluate(self, settings: QmdSettings, *, draft: bool = False) -> EncodeReport:
        """Encode, decode, play and measure; raises `CodecError` for bad settings. `draft` as in `TuningSession`.

        A bound in `settings` is kept where frames and columns were kept, and not between them. The report's `data` is
        the reduced file and `decoded` what it holds; `error` is measured on `played`.
        """
        report = self._session.evaluate(settings, draft=draft)
        if self.reduction == Reduction():
            return report
        return replace(report, error=measure(self.motion, self.played(report)))

    def played(self, report: EncodeReport) -> Motion:
        """Return what a player shows of an encoding, with the frames and columns of the original."""
        return self.reduction.restore(report.decoded, self.motion)
