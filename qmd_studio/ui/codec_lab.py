"""The codec lab: the knobs of the QMD encoder, what they cost, what they do to the motion, and the export."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QFrame, QLabel, QScrollArea, QStackedLayout, QVBoxLayout, QWidget

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import DocumentState
from qmd_studio.tuning.size_figures import size_figures
from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.codec_lab_export import AskPath, ExportBar
from qmd_studio.ui.codec_lab_figures import Figures
from qmd_studio.ui.codec_lab_knobs import Knobs
from qmd_studio.ui.levels_dialog import LevelsDialog
from qmd_studio.ui.notice import Notice
from qmd_studio.ui.size_bar import SizeBreakdownView
from qmd_studio.ui.tuning_worker import TuningWorker

if TYPE_CHECKING:
    from qmd_studio.tuning.report import EncodeReport

VIEW_MODES = ("original", "overlay", "decoded")
"""What the viewport shows of the clip, in the order of Alt+1, 2, 3."""


class CodecLab(QWidget):
    """The contents of the codec lab dock. It reads the document, changes it by commands, and measures on its own.

    `view_mode_changed` carries one of `VIEW_MODES`. `report_ready` carries the `EncodeReport` of the settings that are
    shown, `report_cleared` says that the last one belongs to another clip. `reopen_wanted` carries the path of an
    exported file that the user wants to open.
    """

    view_mode_changed = Signal(str)
    report_ready = Signal(object)
    report_cleared = Signal()
    reopen_wanted = Signal(object)

    def __init__(
        self,
        document: Document,
        playhead: Playhead,
        parent: QWidget | None = None,
        *,
        ask_path: AskPath | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("CodecLab")
        self._document, self._playhead = document, playhead
        self._clip: Clip | None = None
        self._settings: QmdSettings | None = None
        self.report: EncodeReport | None = None
        self.worker = TuningWorker(self)
        self.knobs, self.figures, self.breakdown = Knobs(self), Figures(self), SizeBreakdownView(self)
        self.problem, self.export_bar = Notice(self), ExportBar(ask_path, self)
        self.view = ChoiceBar(self.tr("View"), self._views(), self)
        self._pages = QStackedLayout(self)
        self._pages.addWidget(self._empty_page())
        self._pages.addWidget(self._work_page())
        self._connect()
        self._show(document.state)

    @property
    def view_mode(self) -> str:
        """What the viewport shows: one of `VIEW_MODES`."""
        return self.view.choice

    def set_view_mode(self, mode: str) -> None:
        """Show `mode`, one of `VIEW_MODES`."""
        if mode != self.view.choice:
            self.view.show_choice(mode)
            self.view_mode_changed.emit(mode)

    def export(self) -> None:
        """Write the very bytes that were measured beside the clip's own file: what the button does."""
        self.export_bar.export()

    def export_as(self) -> None:
        """Ask for a name, then write the very bytes that were measured."""
        self.export_bar.export_as()

    def open_levels(self) -> None:
        """Show the table of the columns' levels."""
        if self._clip is not None:
            LevelsDialog(self._document, self._clip.key, self).open()

    def close_down(self) -> None:
        """Stop measuring and listening, before the window goes."""
        self._document.changed.disconnect(self._show, missing_ok=True)
        self.worker.close()

    def _show(self, state: DocumentState) -> None:
        clip = state.active_clip
        self._pages.setCurrentIndex(0 if clip is None else 1)
        if clip is None:
            self._leave()
            return
        same_motion = self._clip is not None and clip.motion is self._clip.motion
        if not same_motion:
            self._forget()
        self.export_bar.show_clip(clip)
        settings = self._fitted(clip, state.codec)
        unchanged = same_motion and settings == self._settings
        self._clip, self._settings = clip, settings
        if settings is not None and not unchanged:
            self._show_settings(clip, settings)

    def _fitted(self, clip: Clip, settings: QmdSettings) -> QmdSettings | None:
        n_columns = clip.motion.skeleton.n_columns
        try:
            return settings.fitted(n_columns).checked(n_columns, clip.motion.n_frames - 1)
        except QmdStudioError as problem:
            self._fail(problem)
            return None

    def _show_settings(self, clip: Clip, settings: QmdSettings) -> None:
        self.knobs.show_settings(clip.motion, settings)
        try:
            size = size_figures(clip.motion, settings)
        except QmdStudioError as problem:
            self._fail(problem)
            return
        self.figures.show_size(size)
        self.breakdown.show_size(size)
        self.export_bar.forget_report()
        self.figures.wait()
        self.worker.request(clip.motion, settings, draft=self.knobs.held)

    def _measured(self, report: EncodeReport) -> None:
        self.report = report
        self.problem.clear()
        self.figures.show_report(report)
        self.report_ready.emit(report)
        if not report.draft:
            self.export_bar.take_report(report)
        elif not self.knobs.held:
            self._finish()

    def _finish(self) -> None:
        """Have the settings measured that a held slider was left at, if only their draft is there."""
        if self._clip is not None and self._settings is not None and self._drafted:
            self.worker.request(self._clip.motion, self._settings)

    @property
    def _drafted(self) -> bool:
        return self.report is not None and self.report.draft and not self.worker.pending

    def _fail(self, problem: QmdStudioError) -> None:
        self.worker.cancel()
        self._forget()
        self.problem.say_error(self.tr("These settings could not be measured"), problem)
        self.export_bar.take_failure()

    def _forget(self) -> None:
        self.figures.show_nothing()
        self.problem.clear()
        if self.report is not None:
            self.report = None
            self.report_cleared.emit()

    def _leave(self) -> None:
        self.worker.cancel()
        self._clip = self._settings = None
        self._forget()
        self.export_bar.show_clip(None)

    def _change(self, settings: QmdSettings, knob: str) -> None:
        self._document.execute(SetCodecSettings(settings, drag=knob))

    def _go_to_frame(self, frame: int) -> None:
        self._playhead.playing = False
        self._playhead.seek(float(frame))

    def _connect(self) -> None:
        self._document.changed.connect(self._show)
        self.knobs.changed.connect(self._change)
        self.knobs.settled.connect(self._document.end_merge)
        self.knobs.settled.connect(self._finish)
        self.worker.measured.connect(self._measured)
        self.worker.failed.connect(self._fail)
        self.figures.frame_wanted.connect(self._go_to_frame)
        self.view.chosen.connect(self.view_mode_changed)
        self.knobs.levels_wanted.connect(self.open_levels)
        self.export_bar.reopen_wanted.connect(self.reopen_wanted)

    def _views(self) -> tuple[Choice, ...]:
        return (
            Choice("original", self.tr("Original"), self.tr("Show the clip as it is (Alt+1)")),
            Choice("overlay", self.tr("Overlay"), self.tr("Show the decoded motion as a ghost over the clip (Alt+2)")),
            Choice("decoded", self.tr("Decoded"), self.tr("Show what a player of the QMD file shows (Alt+3)")),
        )

    def _empty_page(self) -> QWidget:
        page = QWidget(self)
        page.setObjectName("EmptyLab")
        title, text = QLabel(self.tr("Nothing to compress yet"), page), QLabel(page)
        title.setStyleSheet("font-weight: 600;")
        text.setText(
            self.tr("Open a BVH, AMC, BAP or QMD file, or drop one on the window. Its size as QMD stands here at once.")
        )
        for label in (title, text):
            label.setWordWrap(True)
            label.setAlignment(Qt.AlignmentFlag.AlignHCenter)
        text.setProperty("muted", True)
        layout = QVBoxLayout(page)
        layout.setContentsMargins(24, 24, 24, 24)
        layout.addStretch(1)
        layout.addWidget(title)
        layout.addWidget(text)
        layout.addStretch(2)
        return page

    def _work_page(self) -> QWidget:
        page = QWidget(self)
        foot = QVBoxLayout()
        foot.setContentsMargins(12, 8, 12, 12)
        foot.addWidget(self.export_bar)
        layout = QVBoxLayout(page)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self._scrolling_part(page), 1)
        layout.addWidget(_line(page))
        layout.addLayout(foot)  # the way out is in sight, however low the window
        return page

    def _scrolling_part(self, page: QWidget) -> QScrollArea:
        content = QWidget(page)
        layout = QVBoxLayout(content)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.setSpacing(12)
        parts = (self.knobs, _line(content), self.figures, self.problem, self.breakdown, _line(content), self.view)
        for widget in parts:
            layout.addWidget(widget)
        layout.addStretch(1)
        area = QScrollArea(page)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setWidgetResizable(True)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(content)
        return area


def _line(parent: QWidget) -> QFrame:
    line = QFrame(parent)
    line.setFixedHeight(1)
    line.setAutoFillBackground(True)
    line.setBackgroundRole(QPalette.ColorRole.Mid)
    return line
