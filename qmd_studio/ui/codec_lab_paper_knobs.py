"""The knobs of the paper's format: the encoder, FDF, b and n_d or a bound, and the constants of the paper's encoder."""

from __future__ import annotations

import math
from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSpinBox, QVBoxLayout, QWidget

from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS, Encoder, QmdSettings
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.tuning.column_names import exact_columns
from qmd_studio.tuning.lab_report import Found
from qmd_studio.tuning.segment_stops import segment_stops
from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.codec_lab_distance import DistanceKnob
from qmd_studio.ui.codec_lab_knob import Knob, WordedSpinBox
from qmd_studio.ui.quantity import kilobytes

_LARGEST_K = 9
"""The spin box of k ends in infinity one step after this; at 9 level 2 already weighs 1/512 of level 1."""
_MAX_RQT = 10_000_000
_FRAME_WIDTH = 34
"""What a spin box needs beside its text, in pixels."""


class PaperKnobs(QWidget):
    """Emits `changed(QmdSettings, str)` with the new settings and the knob that made them, `settled` after a drag.

    `levels_wanted` asks for the table of the columns' levels.
    """

    changed = Signal(object, str)
    settled = Signal()
    levels_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        default = QmdSettings()
        self._settings, self._n_rows = default, 1
        self.fdf = Knob("fdf", symbol="FDF", title=self.tr("exact columns"), tip=self._fdf_tip(), parent=self)
        self.bits = Knob("bits", symbol="b", title=self.tr("bits of an index"), tip=self._bits_tip(), parent=self)
        self.segment = Knob(
            "segment", symbol="n<sub>d</sub>", title=self.tr("rows in a segment"), tip=self._segment_tip(), parent=self
        )
        self.bound = DistanceKnob(
            "bound",
            title=self.tr("No joint further off than"),
            tip=self._bound_tip(),
            default_mm=default.max_error_mm,
            parent=self,
        )
        self.encoder = ChoiceBar(self.tr("Encoder"), self._encoders(), self)
        self.constants = QWidget(self)
        self.k, self.rqt = WordedSpinBox(self.constants), QSpinBox(self.constants)
        self.levels = QPushButton(self.tr("Levels…"), self.constants)
        self._dress()
        self._lay_out()
        self._connect()

    @property
    def held(self) -> bool:
        """Whether a slider is being dragged."""
        return any(knob.slider.isSliderDown() for knob in (self.fdf, self.bits, self.segment, self.bound))

    def show_settings(self, skeleton: Skeleton, n_rows: int, settings: QmdSettings) -> None:
        """Show `settings`, which fit `n_rows` differences on `skeleton`."""
        n_columns = skeleton.n_columns
        self._settings, self._n_rows = settings, max(n_rows, 1)
        self.fdf.set_stops(tuple(range(n_columns + 1)))
        self.bits.set_stops(tuple(range(MIN_BITS, MAX_BITS + 1)))
        self.segment.set_stops(segment_stops(self._n_rows), last_word=self.tr("one segment"))
        self.fdf.show_value(settings.fdf, self._fdf_meaning(skeleton, settings.fdf))
        self.bits.show_value(settings.bits, self._bits_meaning(settings.bits))
        self.segment.show_value(settings.segment or self._n_rows, self._segment_meaning(settings.segment, n_rows))
        self.encoder.show_choice(str(settings.encoder))
        bounded = settings.encoder is Encoder.BOUNDED
        for knob in (self.fdf, self.bits, self.segment):
            knob.setVisible(not bounded)
        self.bound.setVisible(bounded)
        self.bound.show_distance(settings.max_error_mm)
        self.constants.setVisible(settings.encoder is Encoder.PAPER)
        with QSignalBlocker(self.k), QSignalBlocker(self.rqt):
            self.k.setValue(_LARGEST_K + 1 if settings.k > _LARGEST_K else round(settings.k))
            self.rqt.setValue(settings.rqt)

    def show_found(self, found: Found) -> None:
        """Say what the bounded encoder chose."""
        segments = self.tr("one segment") if found.n_segments == 1 else self.tr("%n segments", "", found.n_segments)
        words = self.tr("found: FDF {fdf}, b {bits}, {segments}")
        self.bound.say(words.format(fdf=found.fdf, bits=found.bits, segments=segments))

    def _change(self, knob: str, **values: object) -> None:
        self.changed.emit(replace(self._settings, **values), knob)

    def _set_segment(self, rows: int) -> None:
        self._change("segment", segment=0 if rows >= self._n_rows else rows)

    def _set_k(self, k: int) -> None:
        self._change("k", k=math.inf if k > _LARGEST_K else float(k))

    def _connect(self) -> None:
        default = QmdSettings()
        self.fdf.moved.connect(lambda value: self._change("fdf", fdf=value))
        self.bits.moved.connect(lambda value: self._change("bits", bits=value))
        self.segment.moved.connect(self._set_segment)
        self.fdf.reset_wanted.connect(lambda: self._reset("fdf", fdf=min(default.fdf, self.fdf.spin.maximum())))
        self.bits.reset_wanted.connect(lambda: self._reset("bits", bits=default.bits))
        self.segment.reset_wanted.connect(lambda: self._reset("segment", segment=default.segment))
        self.bound.moved.connect(lambda value: self._change("bound", max_error_mm=value))
        self.bound.reset_wanted.connect(lambda: self._reset("bound", max_error_mm=default.max_error_mm))
        for knob in (self.fdf, self.bits, self.segment, self.bound):
            knob.settled.connect(self.settled)
        self.encoder.chosen.connect(lambda key: self._reset("encoder", encoder=Encoder(key)))
        self.levels.clicked.connect(self.levels_wanted)
        self.k.valueChanged.connect(self._set_k)
        self.rqt.valueChanged.connect(lambda value: self._change("rqt", rqt=value))
        self.k.editingFinished.connect(self.settled)
        self.rqt.editingFinished.connect(self.settled)

    def _reset(self, knob: str, **values: object) -> None:
        self.settled.emit()
        self._change(knob, **values)
        self.settled.emit()

    def _dress(self) -> None:
        self.levels.setToolTip(self.tr("Read and edit the level of each column: the lower, the more it counts"))
        self.levels.setAccessibleName(self.tr("Column levels"))
        widest = ((self.k, "∞∞"), (self.rqt, "1,000,000"))
        for field, text in widest:
            field.setFixedWidth(field.fontMetrics().horizontalAdvance(text) + _FRAME_WIDTH)
        self.k.setRange(0, _LARGEST_K + 1)
        self.k.set_last_word("∞")
        self.k.setAccessibleName("k")
        self.k.setToolTip(
            self.tr("Values in a bucket weigh 1/level^k. ∞: the lowest level in the bucket alone counts.")
        )
        self.rqt.setRange(1, _MAX_RQT)
        self.rqt.setGroupSeparatorShown(True)
        self.rqt.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.rqt.setKeyboardTracking(False)
        self.rqt.setStepType(QSpinBox.StepType.AdaptiveDecimalStepType)
        self.rqt.setAccessibleName("RQT")
        self.rqt.setToolTip(self.tr("Differences are sorted into buckets as whole numbers, round(difference × RQT)."))

    def _lay_out(self) -> None:
        row = QHBoxLayout(self.constants)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        for name, field in ((self.tr("<b>k</b>"), self.k), (self.tr("<b>RQT</b>"), self.rqt)):
            label = QLabel(name, self.constants)
            label.setBuddy(field)
            label.setToolTip(field.toolTip())
            row.addWidget(label)
            row.addWidget(field)
            row.addSpacing(6)
        row.addStretch(1)
        row.addWidget(self.levels)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(12)
        for widget in (self.encoder, self.fdf, self.bits, self.segment, self.bound, self.constants):
            layout.addWidget(widget)

    def _encoders(self) -> tuple[Choice, ...]:
        return (
            Choice(str(Encoder.CLOSED), self.tr("Closed"), self._closed_tip()),
            Choice(str(Encoder.PLAIN), self.tr("Plain"), self._plain_tip()),
            Choice(str(Encoder.PAPER), self.tr("Paper's"), self._paper_tip()),
            Choice(str(Encoder.BOUNDED), self.tr("Bounded"), self._bounded_tip()),
        )

    def _closed_tip(self) -> str:
        return self.tr(
            "Follows what the decoder will have, and chooses the indices of a frame together by where they put the "
            "joints. Same bytes, same decoder."
        )

    def _plain_tip(self) -> str:
        return self.tr(
            "Follows what the decoder will have, each column by itself: quicker, about five times the error."
        )

    def _paper_tip(self) -> str:
        return self.tr("As published in 2005: errors add up along a segment. For comparison.")

    def _bounded_tip(self) -> str:
        return self.tr(
            "Keeps every joint within a distance in every frame and looks for the fewest bytes that do. It takes a "
            "while where the bound is hard to keep."
        )

    def _bound_tip(self) -> str:
        return self.tr("How far any joint may be off in any frame. FDF, b and segments are found for it.")

    def _fdf_tip(self) -> str:
        return self.tr("Fixed degrees of freedom: the first FDF columns are kept as float32, the rest become indices.")

    def _bits_tip(self) -> str:
        return self.tr("An index of b bits picks one of 2^b table values. 8 takes one byte a value, 9 to 16 take two.")

    def _segment_tip(self) -> str:
        return self.tr(
            "The motion is cut every n_d rows; each segment has a table of its own. The last stop is one segment."
        )

    def _fdf_meaning(self, skeleton: Skeleton, fdf: int) -> str:
        if fdf == 0:
            return self.tr("exact: none")
        if fdf == skeleton.n_columns:
            return self.tr("exact: all {n} columns").format(n=fdf)
        return self.tr("exact: {names}").format(names=exact_columns(skeleton, fdf))

    def _bits_meaning(self, bits: int) -> str:
        width = self.tr("1 byte an index") if bits <= 8 else self.tr("2 bytes an index")
        return self.tr("table: {n:,} values, {size}; {width}").format(
            n=2**bits, size=kilobytes(4 * 2**bits), width=width
        )

    def _segment_meaning(self, segment: int, n_rows: int) -> str:
        if segment == 0:
            return self.tr("one table for all {n:,} rows").format(n=n_rows)
        return self.tr("{count} segments, each with its table").format(count=-(-n_rows // segment))
