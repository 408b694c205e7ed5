"""One side of the comparison: its settings, what they cost, and how far they stray."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip
from qmd_studio.project.state import Side
from qmd_studio.tuning.size_figures import SizeFigures, raw_figures, size_figures
from qmd_studio.ui.codec_lab_figures import Figures
from qmd_studio.ui.size_bar import SizeBreakdownView
from qmd_studio.ui.tuning_worker import TuningWorker

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from qmd_studio.tuning.report import EncodeReport


class SideMeter(QObject):
    """Measures one side and shows its `figures` and `breakdown`.

    `measured` is emitted with each report, also with those of settings that a moving hand has left already (see
    `up_to_date`); `cleared` when there is none any more, `failed` with why the settings cannot be measured.
    """

    measured = Signal(object)
    cleared = Signal()
    failed = Signal(object)

    def __init__(self, side: Side, parent: QWidget) -> None:
        super().__init__(parent)
        self.side = side
        self.worker = TuningWorker(self)
        self.figures, self.breakdown = Figures(side, parent), SizeBreakdownView(parent, name=side.upper())
        self.clip: Clip | None = None
        self.settings: QmdSettings | None = None
        self.report: EncodeReport | None = None
        self.worker.measured.connect(self._take)
        self.worker.failed.connect(self.fail)

    @property
    def is_original(self) -> bool:
        """Whether this side shows the clip as it is."""
        return self.clip is not None and self.settings is None

    @property
    def up_to_date(self) -> bool:
        """Whether the report is of the settings that are shown."""
        return self.report is not None and self.report.settings == self.settings

    @property
    def exact(self) -> bool:
        """Whether the report is of the settings that are shown, and no draft."""
        return self.report is not None and self.up_to_date and not self.report.draft

    def show_settings(self, clip: Clip, settings: QmdSettings | None, *, draft: bool = False) -> bool:
        """Show what `settings` make of `clip`, None for the clip itself; return whether anything is new.

        A `draft` is enough while a slider is held; `finish` has the rest done.
        """
        same_motion = self.clip is not None and clip.motion is self.clip.motion
        if not same_motion:
            self.forget()
        fitted = None if settings is None else self._fitted(clip, settings)
        unchanged = same_motion and fitted == self.settings
        self.clip, self.settings = clip, fitted
        self.breakdown.setVisible(settings is not None)
        if unchanged:
            return False
        if settings is None:
            self.worker.cancel()
            self.forget()
            self.figures.show_original(raw_figures(clip.motion))
        elif fitted is not None:
            self._request(clip, fitted, draft=draft)
        return True

    def finish(self) -> None:
        """Have the settings measured that a held slider was left at, if only their draft is there."""
        drafted = self.report is not None and self.report.draft and not self.worker.pending
        if drafted and self.clip is not None and self.settings is not None:
            self.worker.request(self.clip.motion, self.settings)

    def leave(self) -> None:
        """Show nothing: no clip is open."""
        self.worker.cancel()
        self.clip = self.settings = None
        self.forget()

    def fail(self, problem: QmdStudioError) -> None:
        """Show that these settings cannot be measured."""
        self.worker.cancel()
        self.forget()
        self.failed.emit(problem)

    def forget(self) -> None:
        """Drop what was measured."""
        self.figures.show_nothing()
        if self.report is not None:
            self.report = None
            self.cleared.emit()

    def _fitted(self, clip: Clip, settings: QmdSettings) -> QmdSettings | None:
        n_columns = clip.motion.skeleton.n_columns
        try:
            return settings.fitted(n_columns).checked(n_columns, clip.motion.n_frames - 1)
        except QmdStudioError as problem:
            self.fail(problem)
            return None

    def _request(self, clip: Clip, settings: QmdSettings, *, draft: bool) -> None:
        try:
            size: SizeFigures = size_figures(clip.motion, settings)
        except QmdStudioError as problem:
            self.fail(problem)
            return
        self.figures.show_size(size)
        self.breakdown.show_size(size)
        self.figures.wait()
        self.worker.request(clip.motion, settings, draft=draft)

    def _take(self, report: EncodeReport) -> None:
        self.report = report
        self.figures.show_report(report, stale=not self.up_to_date)
        self.measured.emit(report)
