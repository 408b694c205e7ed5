"""The ruler: frames as ticks, the range that plays, and the playhead that can be dragged."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from qmd_studio.project.playhead import Playhead

MARGIN = 24
"""Pixels left free at either end, so that the first and the last number fit; a strip above uses the same."""
_HEIGHT = 44
_MIN_LABEL_GAP = 64
_LABEL_CLEARANCE = 26  # the playhead has a number of its own
_STEPS = (1, 2, 5, 10, 20, 25, 50, 100, 200, 250, 500, 1000, 2000, 2500, 5000, 10_000, 20_000, 50_000, 100_000)


def label_step(n_frames: int, width: float) -> int:
    """Return the frames from one label to the next, so that labels on `width` pixels do not touch."""
    for step in _STEPS:
        if step * width >= _MIN_LABEL_GAP * max(n_frames - 1, 1):
            return step
    return max(_STEPS[-1], n_frames)


class Ruler(QWidget):
    """Shows the clip's frames from its left end to its right. Press and drag moves the playhead; wheel steps it."""

    scrubbed = Signal()
    span_changed = Signal(float, float)
    """The pixel columns of the first and the last frame, whenever they move."""

    def __init__(self, playhead: Playhead, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._playhead = playhead
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(self.tr("Time ruler"))
        self.setToolTip(
            self.tr("Drag to go through the clip; Alt+wheel steps by frames; Shift+drag sets the range that plays")
        )
        self._range_start: int | None = None

    def sizeHint(self) -> QSize:
        return QSize(400, _HEIGHT)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.span_changed.emit(*self.ends)

    @property
    def ends(self) -> tuple[float, float]:
        """The pixel columns of the first and the last frame."""
        return float(MARGIN), MARGIN + self._span()

    def x_of(self, frame: float) -> float:
        """Return the pixel column of `frame`."""
        return MARGIN + frame * self._span() / max(self._playhead.n_frames - 1, 1)

    def frame_at(self, x: float) -> int:
        """Return the frame nearest to pixel column `x`."""
        frame = round((x - MARGIN) * max(self._playhead.n_frames - 1, 1) / self._span())
        return min(max(frame, 0), self._playhead.n_frames - 1)

    def _span(self) -> float:
        return float(max(self.width() - 2 * MARGIN, 1))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        self._range_start = self.frame_at(event.position().x()) if shift else None
        self._scrub(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._scrub(event)

    def _scrub(self, event: QMouseEvent) -> None:
        frame = self.frame_at(event.position().x())
        if self._range_start is not None:
            self._playhead.preview_range = (self._range_start, frame)
        self._playhead.playing = False
        self._playhead.seek(float(frame))
        self.scrubbed.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        delta = event.angleDelta().y() or event.angleDelta().x()  # Alt turns the wheel sideways on some platforms
        if delta:
            self._playhead.step(1 if delta < 0 else -1)
        event.accept()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(event.rect(), self.palette().color(QPalette.ColorRole.Base))
        self._paint_range(painter)
        self._paint_ticks(painter)
        self._paint_playhead(painter)
        if self.hasFocus():
            painter.setPen(self.palette().color(QPalette.ColorRole.Highlight))
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _paint_range(self, painter: QPainter) -> None:
        if self._playhead.preview_range is None:
            return
        band = QColor(self.palette().color(QPalette.ColorRole.Highlight))
        band.setAlpha(48)
        first, last = (self.x_of(f) for f in self._playhead.preview_range)
        painter.fillRect(QRectF(first, 0, last - first, self.height()), band)
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Highlight), 2))
        for x in (first, last):
            painter.drawLine(QPointF(x, 0), QPointF(x, self.height()))

    def _paint_ticks(self, painter: QPainter) -> None:
        n_frames = self._playhead.n_frames
        step = label_step(n_frames, self._span())
        small = max(step // 5, 1) if step % 5 == 0 else max(step // 2, 1)
        if small * self._span() / max(n_frames - 1, 1) < 4:
            small = step
        line, muted = (
            self.palette().color(QPalette.ColorRole.Mid),
            self.palette().color(QPalette.ColorRole.PlaceholderText),
        )
        bottom, playhead_x = self.height() - 1, self.x_of(self._playhead.index)
        for frame in range(0, n_frames, small):
            x = self.x_of(frame)
            labelled = frame % step == 0
            painter.setPen(muted if labelled else line)
            painter.drawLine(QPointF(x, bottom - (10 if labelled else 5)), QPointF(x, bottom))
            if labelled and abs(x - playhead_x) > _LABEL_CLEARANCE:
                painter.drawText(QRectF(x - 40, bottom - 26, 80, 14), Qt.AlignmentFlag.AlignCenter, str(frame))
        painter.setPen(line)
        painter.drawLine(0, bottom, self.width(), bottom)

    def _paint_playhead(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        x = self.x_of(self._playhead.index)
        text = str(self._playhead.index)
        width = painter.fontMetrics().horizontalAdvance(text) + 12
        left = min(max(x - width / 2, 0.0), self.width() - width)
        flag = QRectF(left, 0, width, 16)
        painter.setPen(QPen(accent, 1.5))
        painter.drawLine(QPointF(x, 14), QPointF(x, self.height()))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(accent)
        painter.drawRoundedRect(flag, 3, 3)
        painter.drawPolygon(QPolygonF([QPointF(x - 4, 15.5), QPointF(x + 4, 15.5), QPointF(x, 20)]))
        painter.setPen(self.palette().color(QPalette.ColorRole.HighlightedText))
        painter.drawText(flag, Qt.AlignmentFlag.AlignCenter, text)
