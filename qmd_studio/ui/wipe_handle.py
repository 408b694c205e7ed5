"""The line between A and B in a wipe: drawn by hand or by the arrow keys."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

WIDTH = 28
_KNOB = 11.0
_STEP = 0.02
_EDGE = 0.03


class WipeHandle(QWidget):
    """Stands over the picture at `split`, a share of its width; emits `moved(split)` when the user moves it."""

    moved = Signal(float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("WipeHandle")
        self._split = 0.5
        self._grip: float | None = None
        self.setCursor(Qt.CursorShape.SplitHCursor)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Line between A and B"))
        self.setToolTip(self.tr("Drag the line between A and B. Arrow keys move it too, a double click centres it."))
        self.hide()

    @property
    def split(self) -> float:
        """Where the line stands, a share of the picture's width."""
        return self._split

    def show_split(self, split: float) -> None:
        """Stand at `split` of the picture, without emitting anything."""
        self._split = min(max(split, _EDGE), 1.0 - _EDGE)
        picture = self.parentWidget()
        self.setGeometry(round(self._split * picture.width()) - WIDTH // 2, 0, WIDTH, picture.height())
        self.setAccessibleDescription(self.tr("{percent:.0f} %").format(percent=100 * self._split))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._grip = event.position().x() - WIDTH / 2
            self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._grip is not None:
            at = self.mapToParent(event.position()).x() - self._grip
            self._move(at / max(self.parentWidget().width(), 1))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self._grip = None
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self._move(0.5)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -_STEP, Qt.Key.Key_Right: _STEP}
        if event.key() in steps and event.modifiers() == Qt.KeyboardModifier.NoModifier:
            self._move(self._split + steps[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        middle, accent = WIDTH / 2, self.palette().accent().color()
        held = self._grip is not None or self.hasFocus()
        dark, bright = QColor(0, 0, 0, 120), accent if held else QColor(255, 255, 255)
        for pen in (QPen(dark, 4.0), QPen(bright, 2.0)):
            painter.setPen(pen)
            painter.drawLine(QPointF(middle, 0.0), QPointF(middle, self.height()))
        centre = QPointF(middle, self.height() / 2)
        painter.setPen(QPen(dark, 1.0))
        painter.setBrush(bright)
        painter.drawEllipse(centre, _KNOB, _KNOB)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(255, 255, 255) if held else QColor(40, 46, 56))
        for way in (-1.0, 1.0):
            tip = centre + QPointF(way * 8.0, 0.0)
            painter.drawPolygon(QPolygonF([tip, tip + QPointF(-way * 5.0, -4.5), tip + QPointF(-way * 5.0, 4.5)]))

    def _move(self, split: float) -> None:
        self.show_split(split)
        self.moved.emit(self._split)
