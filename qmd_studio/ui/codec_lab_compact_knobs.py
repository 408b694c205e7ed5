"""The knobs of the compact profile: which error it is made for, how large that may be, and how the motion is cut."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT
from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.codec_lab_distance import DistanceKnob

_MEAN, _WORST = "mean", "worst"
_CUT, _WHOLE = "segments", "whole"
_WORST_OF_MEAN = 4.0
"""How many times the mean the worst error is about: where the knob starts when the other error is chosen."""

_DEFAULT_MM = COMPACT_DEFAULT.mean_error_mm or 0.5


class CompactKnobs(QWidget):
    """Emits `changed(CompactSettings, str)` with the new settings and their knob, `settled` after a drag."""

    changed = Signal(object, str)
    settled = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._settings = COMPACT_DEFAULT
        self.measure = ChoiceBar(self.tr("Error"), self._measures(), self)
        self.error = DistanceKnob(
            "error", title=self.tr("Error allowed"), tip=self._error_tip(), default_mm=_DEFAULT_MM, parent=self
        )
        self.cut = ChoiceBar(self.tr("Segments"), self._cuts(), self)
        self._lay_out()
        self._connect()

    @property
    def held(self) -> bool:
        """Whether a slider is being dragged."""
        return self.error.slider.isSliderDown()

    def show_settings(self, settings: CompactSettings) -> None:
        """Show `settings`, which fit the motion."""
        self._settings = settings
        worst = settings.max_error_mm is not None
        value = settings.max_error_mm if worst else settings.mean_error_mm
        self.measure.show_choice(_WORST if worst else _MEAN)
        self.error.label.setText(self.tr("Worst error allowed") if worst else self.tr("Mean error allowed"))
        self.error.show_distance(value or _DEFAULT_MM)
        self.cut.show_choice(_CUT if settings.segment else _WHOLE)
        frames = settings.segment or COMPACT_DEFAULT.segment
        self.cut.button(_CUT).setText(self.tr("{n} frames each").format(n=frames))

    def _set_error(self, value: float) -> None:
        key = "mean_error_mm" if self._settings.max_error_mm is None else "max_error_mm"
        self.changed.emit(replace(self._settings, **{key: value}), "error")

    def _choose_measure(self, key: str) -> None:
        value, worst = self.error.value, self._settings.max_error_mm is not None
        if worst == (key == _WORST):
            return
        if worst:
            settings = replace(
                self._settings, mean_error_mm=round(value / _WORST_OF_MEAN, 3) or value, max_error_mm=None
            )
        else:
            settings = replace(self._settings, mean_error_mm=None, max_error_mm=round(value * _WORST_OF_MEAN, 3))
        self._put(settings, "measure")

    def _choose_cut(self, key: str) -> None:
        self._put(replace(self._settings, segment=COMPACT_DEFAULT.segment if key == _CUT else 0), "cut")

    def _put(self, settings: CompactSettings, knob: str) -> None:
        self.settled.emit()
        self.changed.emit(settings, knob)
        self.settled.emit()

    def _reset(self) -> None:
        worst = self._settings.max_error_mm is not None
        self.settled.emit()
        self._set_error(_DEFAULT_MM * _WORST_OF_MEAN if worst else _DEFAULT_MM)
        self.settled.emit()

    def _connect(self) -> None:
        self.measure.chosen.connect(self._choose_measure)
        self.error.moved.connect(self._set_error)
        self.error.reset_wanted.connect(self._reset)
        self.error.settled.connect(self.settled)
        self.cut.chosen.connect(self._choose_cut)

    def _lay_out(self) -> None:
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(12)
        segments = QVBoxLayout()
        segments.setSpacing(4)
        segments.addWidget(QLabel(self.tr("Segments that play alone"), self))
        segments.addWidget(self.cut)
        layout.addWidget(self.measure)
        layout.addWidget(self.error)
        layout.addLayout(segments)

    def _measures(self) -> tuple[Choice, ...]:
        return (
            Choice(
                _MEAN, self.tr("Mean error"), self.tr("The distance of a joint, averaged over all joints and frames")
            ),
            Choice(_WORST, self.tr("Worst error"), self.tr("The distance that no joint exceeds in any frame")),
        )

    def _cuts(self) -> tuple[Choice, ...]:
        return (
            Choice(_CUT, "", self.tr("Each segment decodes without the others: for streams, and to seek quickly")),
            Choice(_WHOLE, self.tr("Whole clip"), self.tr("One segment for all: a few per cent smaller")),
        )

    def _error_tip(self) -> str:
        return self.tr("The file is made as small as it gets while its error stays within this.")
