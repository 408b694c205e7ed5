"""Asking for what is wanted instead of turning knobs: a size, a bitrate or an error, and the best settings for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDoubleSpinBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.size_figures import known_figures, raw_figures
from qmd_studio.tuning.targets import Target, TargetKind
from qmd_studio.ui.background import Background
from qmd_studio.ui.codec_lab_work import target_work
from qmd_studio.ui.notice import Notice
from qmd_studio.ui.quantity import KB, kilobytes, millimetres, significant
from qmd_studio.ui.side_words import encoder_words, settings_words

if TYPE_CHECKING:
    from qmd_studio.tuning.outcome import Outcome, Progress
    from qmd_studio.tuning.trial import Trial


_USUAL_SAVING = 20
"""How many times smaller than the raw motion a file of the compact profile is, where nothing else is known."""


class TargetDialog(QDialog):
    """Looks for the settings of one profile and encoder that meet a target best; `settings_wanted` carries them."""

    settings_wanted = Signal(object)

    def __init__(self, motion: Motion, settings: EncodeSettings, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Target"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._motion, self._base = motion, settings
        self._target: Target | None = None
        self._best: Trial | None = None
        self.search = Background("target", self)
        self.kind, self.value, self.unit = QComboBox(self), QDoubleSpinBox(self), QLabel(self)
        self.find, self.use = QPushButton(self), QPushButton(self.tr("Use these settings"), self)
        self.close_button = QPushButton(self.tr("Close"), self, autoDefault=False)
        self.reduced = QCheckBox(self.tr("Also try fewer frames and joints"), self)
        self.progress, self.answer = QProgressBar(self), Notice(self)
        self._dress()
        self._lay_out()
        self._connect()
        self._choose_kind()
        self._show_running()

    def done(self, result: int) -> None:
        self.search.close()
        super().done(result)

    def start(self) -> None:
        """Look for the settings, or stop looking."""
        if self.search.running:
            self.search.cancel()
        else:
            self._best = None
            self.answer.clear()
            self._target = Target(self.target_kind, self.value.value() * self._scale())
            self.progress.setRange(0, 0)
            reduced = self.reduced.isChecked()
            self.search.run(target_work(self._motion, self._base, self._target, reduced=reduced))
        self._show_running()

    @property
    def target_kind(self) -> TargetKind:
        """What is bounded."""
        return TargetKind(self.kind.currentData())

    def _scale(self) -> float:
        return float(KB) if self.target_kind is TargetKind.BYTES else 1.0

    def _take_progress(self, progress: Progress) -> None:
        self.progress.setRange(0, max(progress.total, 1))
        self.progress.setValue(progress.done)

    def _take(self, outcome: Outcome) -> None:
        self._best = outcome.best
        self._show_running()
        if outcome.best is None or self._target is None:
            title, why = (
                self.tr("No setting comes near"),
                self.tr("The motion is too short, or the target out of reach."),
            )
            self.answer.say("warning", title, why)
            return
        words = self._words(outcome.best)
        if self._target.met_by(outcome.best, self._motion):
            self.answer.say("info", settings_words(outcome.best.settings), words)
        else:
            title = self.tr("This cannot be met. The best is {settings}")
            self.answer.say("warning", title.format(settings=settings_words(outcome.best.settings)), words)

    def _words(self, best: Trial) -> str:
        text = self.tr("{size}, {rate:.0f} kbit/s, DEF {error}, mean {mean}, worst {worst}")
        return text.format(
            size=kilobytes(best.bytes),
            rate=best.bytes * 8 / 1000 / self._motion.duration_s,
            error=significant(best.def_),
            mean=millimetres(best.mean_mm),
            worst=millimetres(best.max_mm),
        )

    def _fail(self, problem: object) -> None:
        self._show_running()
        self.answer.say_error(self.tr("The search has failed"), problem)

    def _load(self) -> None:
        if self._best is not None:
            self.settings_wanted.emit(self._best.settings)
            self.accept()

    def _choose_kind(self) -> None:
        """Start from what the present settings come to, where that is known: a size or a rate; else a usual error."""
        size, raw = known_figures(self._motion, self._base), raw_figures(self._motion)
        n_bytes = raw.bytes / _USUAL_SAVING if size is None else size.payload.bytes
        starts = {
            TargetKind.BYTES: (n_bytes / KB, 1, 1.0, self.tr("KB")),
            TargetKind.KBPS: (n_bytes * 8 / 1000 / self._motion.duration_s, 1, 1.0, self.tr("kbit/s")),
            TargetKind.DEF: (0.01, 4, 0.001, self.tr("ASF units")),
            TargetKind.MEAN_MM: (0.1, 3, 0.01, self.tr("mm")),
            TargetKind.MAX_MM: (1.0, 3, 0.1, self.tr("mm")),
        }
        value, places, step, unit = starts[self.target_kind]
        self.value.setDecimals(places)
        self.value.setRange(10.0**-places, 1e9)
        self.value.setSingleStep(step)
        self.value.setValue(value)
        self.unit.setText(unit)
        self.value.setAccessibleName(f"{self.kind.currentText()}, {unit}")
        self.search.cancel()
        self.answer.clear()
        self._best = None
        self._show_running()

    def _show_running(self) -> None:
        running = self.search.running
        self.find.setText(self.tr("Stop") if running else self.tr("Find"))
        self.progress.setVisible(running)
        self.use.setEnabled(self._best is not None and not running)

    def _dress(self) -> None:
        for kind, text in (
            (TargetKind.BYTES, self.tr("Payload at most")),
            (TargetKind.KBPS, self.tr("Bitrate at most")),
            (TargetKind.DEF, self.tr("DEF at most")),
            (TargetKind.MEAN_MM, self.tr("Mean error at most")),
            (TargetKind.MAX_MM, self.tr("Worst error at most")),
        ):
            self.kind.addItem(text, kind.value)
        self.kind.setAccessibleName(self.tr("What is bounded"))
        self.kind.setToolTip(self.tr("Within a size the least error is sought, within an error the smallest file"))
        self.value.setToolTip(self.tr("The bound"))
        self.value.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.find.setDefault(True)
        self.find.setToolTip(self.tr("Look through the settings of this encoder"))
        self.find.setAccessibleName(self.tr("Find settings"))
        self.reduced.setToolTip(self.tr("Search again with frames and joints left out; it takes several times as long"))
        self.reduced.setAccessibleName(self.reduced.text())
        self.use.setToolTip(self.tr("Load what was found; undo takes it back"))
        self.use.setAccessibleName(self.use.text())
        self.close_button.setToolTip(self.tr("Leave the settings as they are"))
        self.close_button.setAccessibleName(self.close_button.text())
        self.progress.setMaximumHeight(12)
        self.progress.setTextVisible(False)
        self.progress.setAccessibleName(self.tr("Settings tried"))

    def _lay_out(self) -> None:
        encoder = QLabel(self.tr("With: {name}").format(name=encoder_words(self._base)), self)
        encoder.setProperty("muted", True)
        grid, row, layout = QGridLayout(), QHBoxLayout(), QVBoxLayout(self)
        grid.addWidget(self.kind, 0, 0)
        grid.addWidget(self.value, 0, 1)
        grid.addWidget(self.unit, 0, 2)
        grid.addWidget(encoder, 1, 0, 1, 3)
        grid.addWidget(self.reduced, 2, 0, 1, 3)
        grid.setColumnStretch(1, 1)
        row.addWidget(self.find)
        row.addStretch(1)
        row.addWidget(self.use)
        row.addWidget(self.close_button)
        layout.setSpacing(12)
        layout.addLayout(grid)
        layout.addWidget(self.progress)
        layout.addWidget(self.answer)
        layout.addStretch(1)
        layout.addLayout(row)
        self.setMinimumWidth(440)

    def _connect(self) -> None:
        self.kind.currentIndexChanged.connect(self._choose_kind)
        self.find.clicked.connect(self.start)
        self.use.clicked.connect(self._load)
        self.close_button.clicked.connect(self.reject)
        self.search.told.connect(self._take_progress)
        self.search.ended.connect(self._take)
        self.search.failed.connect(self._fail)


def target_dialog(motion: Motion, settings: EncodeSettings, parent: QWidget) -> TargetDialog:
    """Return the dialog for the profile and encoder of `settings`, whose other knobs it looks for."""
    coding = settings.coding if settings.paper is None else replace(settings.paper, segment=0)
    return TargetDialog(motion, replace(settings, coding=coding).fitted(motion), parent)
