"""A knob of the codec lab: a slider, an exact spin box and a line of what the value means."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QRectF, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QMouseEvent, QPainter, QPaintEvent, QPalette, QValidator, QWheelEvent
from PySide6.QtWidgets import QAbstractSpinBox, QDoubleSpinBox, QGridLayout, QLabel, QSlider, QSpinBox, QWidget

from qmd_studio.tuning.segment_stops import nearest_stop
from qmd_studio.ui.elided_label import ElidedLabel

STEPS_TOGETHER_MS = 400
"""Steps by wheel or keys that follow each other faster than this are one step of undo."""

WHEEL_NOTCH = 120
_FIELD_HEIGHT = 24


class KnobSlider(QSlider):
    """A slider that one notch of the wheel moves one stop, and that a double click resets."""

    reset_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._wheel = 0

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        if self.hasFocus():
            painter = QPainter(self)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(self.palette().color(QPalette.ColorRole.Accent))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
            painter.end()

    def wheelEvent(self, event: QWheelEvent) -> None:
        self._wheel += event.angleDelta().y() or event.angleDelta().x()
        notches = int(self._wheel / WHEEL_NOTCH)
        self._wheel -= notches * WHEEL_NOTCH
        self.setValue(self.value() + notches)
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self.reset_wanted.emit()
        event.accept()


class WordedSpinBox(QSpinBox):
    """A spin box that shows its largest value as a word where it is given one ("one segment")."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._last_word = ""
        self.setKeyboardTracking(False)
        self.setAccelerated(True)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)

    def set_last_word(self, word: str) -> None:
        """Show the maximum as `word`; it can be typed too, or its beginning."""
        self._last_word = word
        self.setValue(self.value())
        self.lineEdit().setText(self.textFromValue(self.value()))

    def textFromValue(self, value: int) -> str:
        return self._last_word if self._last_word and value == self.maximum() else super().textFromValue(value)

    def valueFromText(self, text: str) -> int:
        return self.maximum() if self._is_word(text) else super().valueFromText(text)

    def validate(self, text: str, position: int) -> object:
        if self._is_word(text):
            return QValidator.State.Acceptable, text, position
        return super().validate(text, position)

    def _is_word(self, text: str) -> bool:
        cleaned = text.strip().lower()
        return bool(cleaned) and bool(self._last_word) and self._last_word.lower().startswith(cleaned)


class DistanceSpinBox(QDoubleSpinBox):
    """A spin box for millimetres that steps by a tenth of what it shows."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent, decimals=4)
        self.setSuffix(self.tr(" mm"))
        self.setKeyboardTracking(False)
        self.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)

    def textFromValue(self, value: float) -> str:
        return f"{value:.4f}".rstrip("0").rstrip(".")


class Knob(QWidget):
    """A number at `stops` on the slider and exact in the spin box: a whole one unless `spin` is for others.

    `moved` is emitted with each value that the user sets, `settled` when a drag or a burst of steps is over,
    `reset_wanted` on a double click. Values set by `show_value` emit nothing.
    """

    moved = Signal(object)
    settled = Signal()
    reset_wanted = Signal()

    def __init__(
        self,
        name: str,
        *,
        symbol: str = "",
        title: str,
        tip: str,
        spin: QAbstractSpinBox | None = None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName(f"Knob_{name}")
        self._stops: tuple[float, ...] = (0,)
        self.slider, self.spin = KnobSlider(self), spin or WordedSpinBox(self)
        self.label, self.meaning = QLabel(f"<b>{symbol}</b> {title}".strip(), self), ElidedLabel(self)
        self._quiet = QTimer(self, singleShot=True, interval=STEPS_TOGETHER_MS)
        self._dress(title, tip)
        self._lay_out()
        self._connect()

    @property
    def value(self) -> float:
        """The value that is shown."""
        return self.spin.value()

    def set_stops(
        self, stops: tuple[float, ...], *, last_word: str = "", limits: tuple[float, float] | None = None
    ) -> None:
        """Offer `stops` (ascending) on the slider, and in the spin box all within `limits` or from first to last."""
        if stops == self._stops:
            return
        self._stops = stops
        with QSignalBlocker(self.slider), QSignalBlocker(self.spin):
            self.slider.setRange(0, len(stops) - 1)
            self.slider.setPageStep(max(1, len(stops) // 10))
            self.spin.setRange(*(limits or (stops[0], stops[-1])))
            if isinstance(self.spin, WordedSpinBox):
                self.spin.set_last_word(last_word)

    def show_value(self, value: float, meaning: str) -> None:
        """Show `value` and the line under it, without emitting anything."""
        with QSignalBlocker(self.slider), QSignalBlocker(self.spin):
            self.slider.setValue(nearest_stop(self._stops, value))
            self.spin.setValue(value)
        self.meaning.setText(meaning)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self.label and event.type() == QEvent.Type.MouseButtonDblClick:
            self.reset_wanted.emit()
            return True
        return super().eventFilter(watched, event)

    def _dress(self, title: str, tip: str) -> None:
        reset = self.tr("Double click: back to the default. Wheel and arrow keys: one step.")
        for widget in (self.label, self.slider, self.spin):
            widget.setToolTip(f"<p>{tip}</p><p>{reset}</p>")
            widget.setAccessibleName(title)
            widget.setAccessibleDescription(tip)
        self.label.setBuddy(self.spin)
        self.label.installEventFilter(self)
        self.meaning.setProperty("muted", True)
        self.spin.setMinimumHeight(_FIELD_HEIGHT)
        self.spin.setFixedWidth(self.spin.fontMetrics().horizontalAdvance(self.tr("one segment")) + 36)

    def _lay_out(self) -> None:
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setHorizontalSpacing(12)
        layout.setVerticalSpacing(2)
        layout.addWidget(self.label, 0, 0, 1, 2)
        layout.addWidget(self.slider, 1, 0)
        layout.addWidget(self.spin, 1, 1)
        layout.addWidget(self.meaning, 2, 0, 1, 2)
        layout.setColumnStretch(0, 1)

    def _connect(self) -> None:
        self.slider.valueChanged.connect(lambda place: self._set(self._stops[place]))
        self.slider.sliderReleased.connect(self._settle)
        self.slider.reset_wanted.connect(self.reset_wanted)
        self.spin.valueChanged.connect(self._set)
        self.spin.editingFinished.connect(self._settle)
        self._quiet.timeout.connect(self._settle)

    def _set(self, value: float) -> None:
        self.moved.emit(value)
        if not self.slider.isSliderDown():
            self._quiet.start()

    def _settle(self) -> None:
        self._quiet.stop()
        self.settled.emit()
