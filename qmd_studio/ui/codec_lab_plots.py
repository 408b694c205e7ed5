"""The plots of the codec lab: the paper's Figures 5 and 6 for the open motion, and the Pareto front."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from qmd_studio.codecs.qmd.settings import MIN_BITS, Encoder, QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.project.state import Side
from qmd_studio.tuning.encode_settings import EncodeSettings, Profile
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.size_figures import known_figures
from qmd_studio.tuning.sweep import def_lines, drawn_def, size_lines
from qmd_studio.ui.background import Background
from qmd_studio.ui.codec_lab_work import front_work, import_plots, sweep_work
from qmd_studio.ui.quantity import KB, kilobytes, significant
from qmd_studio.ui.side_words import settings_words

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport
    from qmd_studio.tuning.pareto import Front
    from qmd_studio.tuning.trial import Trial
    from qmd_studio.ui.plot import Plot

REST_MS = 250
"""A sweep begins when the hand has rested this long: while it moves, its own figures come first."""


class PlotPanel(QWidget):
    """Follows one side, whose encoder, n_d, constants and reduction the lines are drawn for; both sides are marked.

    Of what is made for an error, which has neither FDF nor n_d, the lines are those of the closed loop.

    `settings_wanted` carries the settings of a dot that was clicked, or of the best trade-off; `target_wanted` asks for
    the target dialog. Nothing is computed while the panel is not seen.
    """

    settings_wanted = Signal(object)
    target_wanted = Signal()
    failed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.size: Plot | None = None
        self.def_: Plot | None = None
        self.pareto: Plot | None = None
        self.front: Front | None = None
        self._motion: Motion | None = None
        self._settings: QmdSettings | None = None
        self._reduction = Reduction()
        self._swept: tuple[Motion, QmdSettings, Reduction] | None = None
        self._complete = False
        self._drawing: Callable[[], None] | None = None
        self._shown: tuple[object, ...] = ()
        self._marked: dict[Side, tuple[EncodeSettings | None, LabReport | None]] = {}
        self._trials: list[Trial] = []
        self._wants_knee = False
        self.importing, self.sweeping = Background("plots", self), Background("sweep", self)
        self.searching = Background("pareto", self)
        self._rest = QTimer(self, singleShot=True, interval=REST_MS)
        self.best, self.find = QPushButton(self.tr("Best trade-off"), self), QPushButton(self)
        self.target = QPushButton(self.tr("Target…"), self)
        self.reduced = QCheckBox(self.tr("Also try fewer frames and joints"), self)
        self.progress, self.words = QProgressBar(self), QLabel(self)
        self._room = QVBoxLayout()
        self._dress()
        self._connect()
        self._lay_out()

    @property
    def busy(self) -> bool:
        """Whether anything is being computed, or will be when the hand has rested."""
        works = (self.importing, self.sweeping, self.searching)
        making = self.size is not None and (self.pareto is None or self._drawing is not None)
        return making or self._rest.isActive() or any(work.running for work in works)

    def show_motion(self, motion: Motion | None, settings: EncodeSettings | None) -> None:
        """Draw the lines of `settings` on `motion`; those of an original are the default's."""
        if motion is not self._motion:
            self._forget()
        self._motion = motion
        if motion is None:
            self._settings = None
            return
        settings = settings or EncodeSettings()
        drawn = settings.paper if settings.size_is_known else None
        self._settings, self._reduction = drawn or QmdSettings(), settings.reduction
        self._plan()

    def show_marks(self, marks: Mapping[Side, tuple[EncodeSettings | None, LabReport | None]]) -> None:
        """Mark what each side is set to, and where that was measured to be."""
        shown = (self._motion, *marks.values())
        if shown != self._shown:
            self._shown, self._marked = shown, dict(marks)
            self._draw_marks()

    def close_down(self) -> None:
        """Stop all that is under way."""
        self._rest.stop()
        for work in (self.importing, self.sweeping, self.searching):
            work.close()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self.size is None and not self.importing.running:
            self.importing.run(import_plots)
        self._plan()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._rest.stop()
        self.sweeping.cancel()
        self._swept = None

    def find_front(self) -> None:
        """Look for the Pareto front, or stop looking."""
        self._wants_knee = False
        if self.searching.running:
            self._stop_search()
        elif self._motion is not None and self._settings is not None:
            self._search(self._motion, self._settings)

    def take_best(self) -> None:
        """Load the best trade-off, once the front is whole."""
        if self.front is not None and not self.searching.running:
            self._take_knee()
        elif self._motion is not None and self._settings is not None:
            self._wants_knee = True
            if not self.searching.running:
                self._search(self._motion, self._settings)

    # What is computed

    def _plan(self) -> None:
        """Have the lines drawn anew where they are of something else, and let a moving hand have the machine."""
        settings = self._settings
        if self._motion is None or settings is None or not self.isVisible():
            return
        key = (self._motion, replace(settings, fdf=0, bits=MIN_BITS), self._reduction)
        if key != self._swept:
            self._swept, self._complete = key, False
            self._trials = []
            self._draw_size()
            self._draw_def()
        if not self._complete:
            self.sweeping.cancel()
            self._rest.start()

    def _sweep(self) -> None:
        if self._motion is not None and self._settings is not None:
            self.sweeping.run(sweep_work(self._motion, self._settings, self._reduction, self._trials))

    def _end_sweep(self, trials: list[Trial]) -> None:
        self._complete = True
        self._take_trials(trials)

    def _take_trials(self, trials: list[Trial]) -> None:
        self._trials = trials
        self._draw_def()

    def _search(self, motion: Motion, settings: QmdSettings) -> None:
        self.progress.setRange(0, 0)
        self.searching.run(front_work(motion, settings, reduced=self.reduced.isChecked()))
        self._show_searching()

    def _stop_search(self) -> None:
        self.searching.cancel()
        self._show_searching()

    def _take_front(self, front: Front | None) -> None:
        self.front = front
        if front is not None:
            self.progress.setRange(0, max(front.total, 1))
            self.progress.setValue(front.done)
        self._draw_front()

    def _end_search(self, front: Front | None) -> None:
        self._take_front(front)
        self._show_searching()
        if self._wants_knee:
            self._take_knee()

    def _take_knee(self) -> None:
        self._wants_knee = False
        knee = self.front.knee if self.front is not None else None
        if knee is not None:
            self.settings_wanted.emit(knee.settings)

    def _fail(self, problem: object) -> None:
        self._wants_knee = False
        self._show_searching()
        self.failed.emit(problem)

    def _forget(self) -> None:
        self._rest.stop()
        self.sweeping.cancel()
        self.searching.cancel()
        self._swept, self.front, self._trials, self._wants_knee = None, None, [], False
        self._marked, self._shown = {}, ()
        for plot in (self.size, self.def_, self.pareto):
            if plot is not None:
                plot.clear()
        self._show_searching()

    # What is drawn

    def _make_plots(self) -> None:
        """Make one plot, or draw the one just made; the next when the window has had time for something else."""
        from qmd_studio.ui.plot import Plot

        kb, draw = self.tr("KB"), self._drawing
        self._drawing = None
        if draw is not None:
            draw()
        elif self.size is None:
            self.size = Plot(x="FDF", y=kb, log=(False, False), parent=self)
            self._add(self.size, self.tr("Size in KB over FDF, a line for each b (the paper's Figure 5)"))
            self._drawing = self._draw_size
        elif self.def_ is None:
            self.def_ = Plot(x="FDF", y="DEF", log=(False, True), parent=self)
            self._add(self.def_, self.tr("DEF over FDF, a line for each b (Figure 6)"))
            self._drawing = self._draw_def
        elif self.pareto is None:
            self.pareto = Plot(x=kb, y="DEF", log=(True, True), parent=self)
            self._add(self.pareto, self.tr("DEF over size: what nothing beats in both. Click a dot to load it."))
            names = [self.tr("paper"), self.tr("closed"), self.tr("plain"), "", self.tr("compact")]
            self.pareto.name_kinds(names)
            self.pareto.picked.connect(self._pick)
            self._drawing = self._draw_all_dots
        else:
            return
        QTimer.singleShot(0, self, self._make_plots)

    def _add(self, plot: Plot, text: str) -> None:
        title = QLabel(text, self, wordWrap=True)
        title.setProperty("muted", True)
        plot.setAccessibleName(text)
        plot.setToolTip(text)
        self._room.addWidget(title)
        self._room.addWidget(plot)

    def _draw_all_dots(self) -> None:
        self._draw_front()
        self._draw_marks()

    def _draw_size(self) -> None:
        if self.size is not None and self._motion is not None and self._settings is not None:
            for bits, values in size_lines(self._motion, self._settings.segment, self._reduction).items():
                self.size.show_line(f"b {bits}", list(enumerate(values)))

    def _draw_def(self) -> None:
        if self.def_ is not None:
            for bits, points in def_lines(self._trials).items():
                self.def_.show_line(f"b {bits}", points)

    def _draw_front(self) -> None:
        if self.pareto is None:
            return
        points = self.front.points if self.front is not None else ()
        self.pareto.show_dots(
            [(trial.bytes / KB, drawn_def(trial.def_)) for trial in points],
            [_kind(trial.settings) for trial in points],
            [f"{settings_words(t.settings)}\n{kilobytes(t.bytes)}, DEF {significant(t.def_)}" for t in points],
        )
        knee = self.front.knee if self.front is not None else None
        self.words.setVisible(knee is not None)
        if knee is not None:
            words = self.tr("Best trade-off so far: {settings}; {size}, DEF {error}")
            self.words.setText(
                words.format(
                    settings=settings_words(knee.settings), size=kilobytes(knee.bytes), error=significant(knee.def_)
                )
            )

    def _draw_marks(self) -> None:
        if self.size is None or self.def_ is None or self.pareto is None or self._motion is None:
            return
        for side in Side:
            settings, report = self._marked.get(side, (None, None))
            name, known = side.upper(), report is not None and report.settings == settings
            figures = known_figures(self._motion, settings) if settings is not None else None
            if figures is None and report is not None and known:
                figures = report.size
            size = None if figures is None else figures.payload.bytes / KB
            def_ = drawn_def(report.error.def_) if report is not None and known else None
            has_fdf = settings is not None and settings.size_is_known
            fdf = float(settings.paper.fdf) if has_fdf and settings.paper is not None else None
            self.size.show_mark(name, None if fdf is None or size is None else (fdf, size))
            self.def_.show_mark(name, None if fdf is None or def_ is None else (fdf, def_))
            self.pareto.show_mark(name, None if size is None or def_ is None else (size, def_))

    def _show_searching(self) -> None:
        running = self.searching.running
        self.progress.setVisible(running)
        self.find.setText(self.tr("Stop") if running else self.tr("Find trade-offs"))
        self.best.setEnabled(not (running and self._wants_knee))

    def _pick(self, number: int) -> None:
        if self.front is not None and number < len(self.front.points):
            self.settings_wanted.emit(self.front.points[number].settings)

    def _connect(self) -> None:
        self._rest.timeout.connect(self._sweep)
        self.importing.ended.connect(lambda _: self._make_plots())
        self.sweeping.told.connect(self._take_trials)
        self.sweeping.ended.connect(self._end_sweep)
        self.searching.told.connect(self._take_front)
        self.searching.ended.connect(self._end_search)
        self.searching.failed.connect(self._fail)
        self.find.clicked.connect(self.find_front)
        self.best.clicked.connect(self.take_best)
        self.target.clicked.connect(self.target_wanted)

    def _dress(self) -> None:
        for button, tip in (
            (self.best, self.tr("Load the knee of the front: where less error begins to cost much more")),
            (
                self.find,
                self.tr("Try many settings of both profiles and draw those that nothing beats in size and error"),
            ),
            (self.target, self.tr("Ask for a size, a bitrate or an error, and get the best settings for it")),
        ):
            button.setToolTip(tip)
            button.setAccessibleName(button.text() or self.tr("Find trade-offs"))
        self.reduced.setToolTip(
            self.tr("Try every setting also with frames and joints left out; it takes several times as long")
        )
        self.reduced.setAccessibleName(self.reduced.text())
        self.words.setWordWrap(True)
        self.words.setProperty("muted", True)
        self.words.hide()
        self.progress.setMaximumHeight(12)
        self.progress.setTextVisible(False)
        self.progress.setAccessibleName(self.tr("Settings tried"))
        self._show_searching()

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(4)
        for button in (self.best, self.find, self.target):
            row.addWidget(button, 1)
        self._room.setSpacing(4)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addLayout(row)
        layout.addWidget(self.reduced)
        layout.addWidget(self.progress)
        layout.addWidget(self.words)
        layout.addLayout(self._room)


_KINDS = (*(str(encoder) for encoder in Encoder), str(Profile.COMPACT))
"""What gives the dots of the front their colours and shapes."""


def _kind(settings: EncodeSettings) -> int:
    return _KINDS.index(str(settings.paper.encoder if settings.paper is not None else settings.profile))
