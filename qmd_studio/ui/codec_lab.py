"""The codec lab: the knobs of the QMD encoder, what they cost, what they do to the motion, and the export."""

from __future__ import annotations

from threading import Event
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QStackedLayout, QVBoxLayout, QWidget

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.motion.metrics import MotionError, measure
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import CopySettings, SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import DocumentState, Side
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reachable import allowance_mm, reachable_mm
from qmd_studio.ui.background import Background, Tell, Work
from qmd_studio.ui.codec_lab_budget import BudgetPanel
from qmd_studio.ui.codec_lab_export import AskPath, ExportBar
from qmd_studio.ui.codec_lab_head import SideHead
from qmd_studio.ui.codec_lab_knobs import Knobs
from qmd_studio.ui.codec_lab_pages import empty_page, line
from qmd_studio.ui.codec_lab_plots import PlotPanel
from qmd_studio.ui.codec_lab_side import SideMeter
from qmd_studio.ui.codec_lab_views import ViewBar
from qmd_studio.ui.codec_lab_work import paper_optimum_work
from qmd_studio.ui.levels_dialog import LevelsDialog
from qmd_studio.ui.notice import Notice
from qmd_studio.ui.side_words import side_words
from qmd_studio.ui.target_dialog import target_dialog

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport
    from qmd_studio.tuning.outcome import Outcome


class CodecLab(QWidget):
    """The contents of the codec lab dock. It reads the document, changes it by commands, and measures on its own.

    `view_chosen` carries a `View`, `heat_toggled` whether the error is painted on the body. `side_measured` carries a
    `Side` and its `LabReport`, `side_cleared` the side that has none any more; `difference_measured` carries the
    `MotionError` of B against A, `difference_cleared` says that it is not known. `sides_named` carries what A and B
    are. `reopen_wanted` carries the path of an exported file that the user wants to open.
    """

    view_chosen = Signal(object)
    heat_toggled = Signal(bool)
    side_measured = Signal(object, object)
    side_cleared = Signal(object)
    difference_measured = Signal(object)
    difference_cleared = Signal()
    sides_named = Signal(str, str)
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
        self._copied = ""
        self.head, self.knobs = SideHead(self), Knobs(self)
        self.sides = {side: SideMeter(side, self) for side in Side}
        self.difference, self.optimum = Background("difference", self), Background("optimum", self)
        self.problem, self.export_bar = Notice(self), ExportBar(ask_path, self)
        self.note = Notice(self)
        self.view, self.plots, self.budget = ViewBar(self), PlotPanel(self), BudgetPanel(self)
        self._pages = QStackedLayout(self)
        self._pages.addWidget(empty_page(self))
        self._pages.addWidget(self._work_page())
        self._connect()
        self._show(document.state)

    @property
    def report(self) -> LabReport | None:
        """What is known of side B, the one that is exported."""
        return self.sides[Side.B].report

    @property
    def pending(self) -> bool:
        """Whether anything is still being measured."""
        return any(meter.worker.pending for meter in self.sides.values()) or self.difference.running

    def name_sides(self) -> None:
        """Tell what A and B are."""
        self.sides_named.emit(*(side_words(side, meter.settings) for side, meter in self.sides.items()))

    def edit_side(self, side: Side) -> None:
        """Show the knobs of `side`."""
        self._document.end_merge()
        self._show_head(self._document.state, side)

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
        self.difference.close()
        self.optimum.close()
        self.plots.close_down()
        for meter in self.sides.values():
            meter.worker.close()

    def _show(self, state: DocumentState) -> None:
        clip = state.active_clip
        if self._document.undo_text != self._copied and not self.optimum.running:
            self.note.clear()  # its Undo would take back something else
        self._pages.setCurrentIndex(0 if clip is None else 1)
        if clip is None:
            self._leave()
            return
        if self._clip is None or clip.motion is not self._clip.motion:
            self.difference.cancel()
            self.optimum.cancel()
            self.difference_cleared.emit()
            self.note.clear()
        self._clip = clip
        self.export_bar.show_clip(clip)
        changed = [self._show_side(clip, side, state.settings_of(side)) for side in Side]
        self._show_head(state, self.head.side)
        self._show_budget()
        if any(changed):
            self._compare()

    def _show_side(self, clip: Clip, side: Side, settings: EncodeSettings | None) -> bool:
        meter = self.sides[side]
        changed = meter.show_settings(clip, settings, draft=self.knobs.held)
        if changed:
            self.problem.clear()
            if side is Side.B:
                self.export_bar.forget_report()
        return changed

    def _show_head(self, state: DocumentState, side: Side) -> None:
        self.head.show_sides(side, state.codec_a, state.codec)
        settings = self.sides[side].settings
        if self._clip is not None:
            self.plots.show_motion(self._clip.motion, settings)
            self._mark_plots()
        self.knobs.setVisible(settings is not None)
        if settings is not None and self._clip is not None:
            self.knobs.show_settings(self._clip.motion, settings)
            if self.sides[side].worker.pending:
                self.knobs.show_looking()
            else:
                self._tell_knobs()
        self.name_sides()

    def _mark_plots(self) -> None:
        self.plots.show_marks({side: (meter.settings, meter.report) for side, meter in self.sides.items()})

    def _tell_knobs(self) -> None:
        """Say beside the knobs that ask for an error what came of it."""
        meter = self.sides[self.head.side]
        if meter.report is not None and meter.up_to_date:
            self.knobs.show_report(meter.report)

    def _measured(self, side: Side, report: LabReport) -> None:
        self.problem.clear()
        self.side_measured.emit(side, report)
        if side is Side.B and self.sides[side].exact:
            self.export_bar.take_report(report)
        if report.draft and not self.knobs.held:
            self.sides[side].finish()
        if side is self.head.side:
            self._tell_knobs()
        self._mark_plots()
        self._show_budget()
        self._compare()

    def _show_budget(self) -> None:
        self.budget.show_reports({s: (meter.report, not meter.up_to_date) for s, meter in self.sides.items()})

    def _fail_search(self, problem: QmdStudioError) -> None:
        self.note.clear()
        self.problem.say_error(self.tr("The search has failed"), problem)

    def _compare(self) -> None:
        """Say how the sides compare, and have it measured how far B is from A."""
        self._compare_figures()
        a, b = self.sides[Side.A], self.sides[Side.B]
        if a.is_original and b.report is not None:
            self.difference.cancel()
            self.difference_measured.emit(b.report.error)
        elif a.up_to_date and b.up_to_date:
            self.difference.run(difference_of(a.report, b.report))

    def _compare_figures(self) -> None:
        for side, meter in self.sides.items():
            meter.figures.compare(self.sides[side.other].figures)

    def _fail(self, side: Side, problem: QmdStudioError) -> None:
        self._compare_figures()
        best = reachable_mm(problem)
        if best is None:
            title = self.tr("The settings of side {side} could not be measured").format(side=side.upper())
            self.problem.say_error(title, problem)
        else:
            title = self.tr("Side {side} cannot keep to this: the best is {best:g} mm")
            allowed = allowance_mm(best)
            links = ((f"{side}{allowed!r}", self.tr("Allow {mm:g} mm").format(mm=allowed)),)
            why = f"{problem.message[:1].upper()}{problem.message[1:]}."
            self.problem.say("warning", title.format(side=side.upper(), best=best), why, links)
        if side is self.head.side:
            self.knobs.show_problem(problem)
        if side is Side.B:
            self.export_bar.take_failure()

    def _allow(self, key: str) -> None:
        """Ask the side named first in `key` for the error that follows, which can be reached."""
        side, best_mm = Side(key[0]), float(key[1:])
        settings = self.sides[side].settings
        if settings is not None:
            self._document.end_merge()
            self._document.execute(SetCodecSettings(settings.allowing(best_mm), side=side))

    def _take_stop(self, side: Side) -> None:
        self.knobs.show_stop()
        self._compare_figures()
        if side is Side.B:
            self.export_bar.take_failure()

    def _measure_stopped(self) -> None:
        """Measure side B after all: it is to be exported."""
        if self.sides[Side.B].waiting.stopped:
            self.sides[Side.B].measure()

    def _finish(self) -> None:
        for meter in self.sides.values():
            meter.finish()

    def _clear(self, side: Side) -> None:
        self.side_cleared.emit(side)
        self._show_budget()
        if side is Side.B:
            self.difference.cancel()
            self.difference_cleared.emit()

    def _leave(self) -> None:
        self._clip = None
        self.plots.show_motion(None, None)
        for meter in self.sides.values():
            meter.leave()
        self.difference.cancel()
        self.problem.clear()
        self.note.clear()
        self.export_bar.show_clip(None)

    def _change(self, settings: EncodeSettings, knob: str) -> None:
        self._document.execute(SetCodecSettings(settings, drag=knob, side=self.head.side))

    def _load(self, settings: EncodeSettings) -> None:
        """Give the side whose knobs are shown these settings."""
        self._document.end_merge()
        self._document.execute(SetCodecSettings(settings, side=self.head.side))

    def _find_optimum(self) -> None:
        """Look for what the paper's exhaustive search comes to, and load it."""
        if self._clip is not None:
            self.note.say("info", self.tr("Trying the paper's grid…"), links=(("stop", self.tr("Stop")),))
            self.optimum.run(paper_optimum_work(self._clip.motion, QmdSettings(encoder=Encoder.PAPER)))

    def _take_optimum(self, outcome: Outcome) -> None:
        self.note.clear()
        if outcome.best is not None:
            self._load(outcome.best.settings)

    def open_target(self) -> None:
        """Ask for a size or an error, and find the settings for it."""
        if self._clip is not None:
            settings = self.sides[self.head.side].settings or EncodeSettings()
            dialog = target_dialog(self._clip.motion, settings, self)
            dialog.settings_wanted.connect(self._load)
            dialog.open()

    def _choose_source(self, encoded: bool) -> None:
        self._document.end_merge()
        settings = EncodeSettings(QmdSettings(encoder=Encoder.PAPER)) if encoded else None
        self._document.execute(SetCodecSettings(settings, side=Side.A))

    def _copy(self, to: Side) -> None:
        command = CopySettings(to)
        self._document.execute(command)
        self._copied = command.label
        text = self.tr("Side {to} has the settings of side {other}").format(to=to.upper(), other=to.other.upper())
        self.note.say("info", text, links=(("undo", self.tr("Undo")),))

    def _follow_link(self, key: str) -> None:
        self.note.clear()
        self.optimum.cancel()
        if key == "undo":
            self._document.undo()

    def _go_to_frame(self, frame: int) -> None:
        self._playhead.playing = False
        self._playhead.seek(float(frame))

    def _connect(self) -> None:
        self._document.changed.connect(self._show)
        self.knobs.changed.connect(self._change)
        self.knobs.settled.connect(self._document.end_merge)
        self.knobs.settled.connect(self._finish)
        self.head.side_chosen.connect(self.edit_side)
        self.head.source_chosen.connect(self._choose_source)
        self.head.copy_wanted.connect(self._copy)
        self.note.link.connect(self._follow_link)
        self.problem.link.connect(self._allow)
        for side, meter in self.sides.items():
            meter.measured.connect(lambda report, side=side: self._measured(side, report))
            meter.cleared.connect(lambda side=side: self._clear(side))
            meter.failed.connect(lambda problem, side=side: self._fail(side, problem))
            meter.stopped.connect(lambda side=side: self._take_stop(side))
            meter.figures.frame_wanted.connect(self._go_to_frame)
        self.head.presets.chosen.connect(self._load)
        self.head.presets.optimum_wanted.connect(self._find_optimum)
        self.head.presets.failed.connect(lambda problem: self.problem.say_error(self.tr("Not saved"), problem))
        self.optimum.ended.connect(self._take_optimum)
        self.optimum.failed.connect(self._fail_search)
        self.plots.target_wanted.connect(self.open_target)
        self.plots.failed.connect(self._fail_search)
        self.plots.settings_wanted.connect(self._load)
        self.difference.ended.connect(self.difference_measured)
        self.view.chosen.connect(self.view_chosen)
        self.view.heat_toggled.connect(self.heat_toggled)
        self.knobs.levels_wanted.connect(self.open_levels)
        self.export_bar.reopen_wanted.connect(self.reopen_wanted)
        self.export_bar.report_wanted.connect(self._measure_stopped)

    def _work_page(self) -> QWidget:
        page = QWidget(self)
        foot = QVBoxLayout()
        foot.setContentsMargins(12, 8, 12, 12)
        foot.setSpacing(8)
        foot.addWidget(self.view)
        foot.addWidget(self.export_bar)
        layout = QVBoxLayout(page)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self._scrolling_part(page), 1)
        layout.addWidget(line(page))
        layout.addLayout(foot)  # the way out is in sight, however low the window
        return page

    def _scrolling_part(self, page: QWidget) -> QScrollArea:
        content = QWidget(page)
        layout = QVBoxLayout(content)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.setSpacing(12)
        figures = QHBoxLayout()
        figures.setSpacing(16)
        for side in Side:
            figures.addWidget(self.sides[side].figures, 1)
        waiting = [self.sides[side].waiting for side in Side]
        for widget in (self.head, self.note, self.knobs, *waiting, self.problem, line(content)):
            layout.addWidget(widget)
        layout.addLayout(figures)
        breakdowns = [self.sides[side].breakdown for side in Side]
        for widget in (*breakdowns, line(content), self.budget, line(content), self.plots):
            layout.addWidget(widget)
        layout.addStretch(1)
        area = QScrollArea(page)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setWidgetResizable(True)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(content)
        return area


def difference_of(a: LabReport, b: LabReport) -> Work:
    """Return the work that measures how far what `b` plays is from what `a` plays."""

    def measured(_stop: Event, _tell: Tell) -> MotionError:
        return measure(a.played, b.played)

    return measured
