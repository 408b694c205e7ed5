"""One side of the comparison: its settings, what they cost, and how far they stray."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip
from qmd_studio.project.state import Side
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.size_figures import known_figures, raw_figures
from qmd_studio.ui.codec_lab_figures import Figures
from qmd_studio.ui.codec_lab_waiting import Waiting
from qmd_studio.ui.size_bar import SizeBreakdownView
from qmd_studio.ui.tuning_worker import TuningWorker

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from qmd_studio.tuning.lab_report import LabReport


class SideMeter(QObject):
    """Measures one side and shows its `figures` and `breakdown`, and what takes long in `waiting`.

    `measured` is emitted with each report, also with those of settings that a moving hand has left already (see
    `up_to_date`); `cleared` when there is none any more, `failed` with why the settings cannot be measured, `stopped`
    when the user would not wait.
    """

    measured = Signal(object)
    cleared = Signal()
    failed = Signal(object)
    stopped = Signal()

    def __init__(self, side: Side, parent: QWidget) -> None:
        super().__init__(parent)
        self.side = side
        self.worker = TuningWorker(self)
        self.figures, self.breakdown = Figures(side, parent), SizeBreakdownView(parent, name=side.upper())
        self.waiting = Waiting(side, parent)
        self.clip: Clip | None = None
        self.settings: EncodeSettings | None = None
        self.report: LabReport | None = None
        self.worker.measured.connect(self._take)
        self.worker.failed.connect(self.fail)
        self.waiting.stop_wanted.connect(self.stop)
        self.waiting.again_wanted.connect(self.measure)

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

    def show_settings(self, clip: Clip, settings: EncodeSettings | None, *, draft: bool = False) -> bool:
        """Show what `settings` make of `clip`, None for the clip itself; return whether anything is new.

        A `draft` is enough while a slider is held; `finish` has the rest done.
        """
        same_motion = self.clip is not None and clip.motion is self.clip.motion
        if not same_motion:
            self.forget()
        fitted = None if settings is None else self._fitted(clip, settings)
        unchanged = same_motion and fitted == self.settings
        self.clip, self.settings = clip, fitted
        if settings is None:
            self.breakdown.hide()
        if unchanged:
            return False
        if settings is None:
            self.worker.cancel()
            self.waiting.end()
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

    def stop(self) -> None:
        """Measure no further: the settings stay, without figures."""
        self.worker.cancel()
        self.forget()
        self.waiting.stop()
        self.stopped.emit()

    def measure(self) -> None:
        """Measure the settings that are shown, after all."""
        if self.clip is not None and self.settings is not None:
            self._request(self.clip, self.settings, draft=False)

    def leave(self) -> None:
        """Show nothing: no clip is open."""
        self.worker.cancel()
        self.waiting.end()
        self.clip = self.settings = None
        self.forget()

    def fail(self, problem: QmdStudioError) -> None:
        """Show that these settings cannot be measured."""
        self.worker.cancel()
        self.waiting.end()
        self.forget()
        self.failed.emit(problem)

    def forget(self) -> None:
        """Drop what was measured."""
        self.figures.show_nothing()
        if self.report is not None:
            self.report = None
            self.cleared.emit()

    def _fitted(self, clip: Clip, settings: EncodeSettings) -> EncodeSettings | None:
        try:
            return settings.fitted(clip.motion)
        except QmdStudioError as problem:
            self.fail(problem)
            return None

    def _request(self, clip: Clip, settings: EncodeSettings, *, draft: bool) -> None:
        try:
            size = known_figures(clip.motion, settings)
        except QmdStudioError as problem:
            self.fail(problem)
            return
        self.figures.show_size(size)
        if size is not None:
            self.breakdown.show_size(size)
        self.breakdown.setVisible(size is not None)
        self.figures.wait()
        self.waiting.begin()
        self.worker.request(clip.motion, settings, draft=draft)

    def _take(self, report: LabReport) -> None:
        self.report = report
        if not self.worker.pending:
            self.waiting.end()
        self.figures.show_report(report, stale=not self.up_to_date)
        if self.up_to_date:
            self.breakdown.show_size(report.size)
            self.breakdown.show()
        self.measured.emit(report)
