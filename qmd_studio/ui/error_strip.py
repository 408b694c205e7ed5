"""The error of every frame under the timeline: see where the decoded motion strays, and go there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QActionGroup,
    QColor,
    QContextMenuEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QMenu, QSizePolicy, QToolTip, QWidget

from qmd_studio.arrays import FloatArray
from qmd_studio.project.playhead import Playhead
from qmd_studio.tuning.error_axis import ErrorAxis
from qmd_studio.tuning.worst_frames import frame_errors, next_worst, outline, worst_frames
from qmd_studio.ui.quantity import millimetres, tabular
from qmd_studio.ui.ruler import MARGIN

if TYPE_CHECKING:
    from qmd_studio.motion.metrics import MotionError

WORST_APART_S = 0.25
"""Worst frames closer than this are one moment to a person."""

_HEIGHT = 56
_TICK = 4.0


class ErrorStrip(QWidget):
    """Draws the largest error of any point in each frame against an axis that starts at zero, or a logarithmic one.

    A click goes to that frame. `go_to_next` and `go_to_previous` go along the worst frames (N and Shift+N here too).
    `set_span` puts its frames over those of a ruler; until then they leave the ruler's margin free.
    """

    went = Signal(int)

    def __init__(self, playhead: Playhead, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("ErrorStrip")
        self._playhead = playhead
        self._error: FloatArray | None = None
        self._worst = worst_frames(np.zeros(1), min_gap=1)
        self._logarithmic = False
        self._span: tuple[float, float] | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Error per frame"))
        self.setMouseTracking(True)
        playhead.moved.connect(self._moved)

    @property
    def logarithmic(self) -> bool:
        """Whether the axis is logarithmic."""
        return self._logarithmic

    @logarithmic.setter
    def logarithmic(self, logarithmic: bool) -> None:
        self._logarithmic = logarithmic
        self.update()

    @property
    def worst(self) -> list[int]:
        """The worst frames that N goes along, in order of time."""
        return [int(frame) for frame in self._worst]

    def show_error(self, error: MotionError) -> None:
        """Show the error of each frame of a measurement."""
        self._error = frame_errors(error.distance_mm)
        gap = max(1, round(WORST_APART_S * self._playhead.fps))
        self._worst = worst_frames(self._error, min_gap=gap)
        top = int(self._error.argmax())
        words = self.tr("Worst {error} at frame {frame}").format(error=millimetres(self._error[top]), frame=top)
        self.setAccessibleDescription(words)
        self.update()

    def clear(self) -> None:
        """Show that nothing is measured."""
        self._error = None
        self._worst = self._worst[:0]
        self.setAccessibleDescription("")
        self.update()

    def set_span(self, first_x: float, last_x: float) -> None:
        """Put the first frame at x = `first_x` and the last at `last_x`, in pixels of this widget."""
        self._span = (first_x, last_x)
        self.update()

    def frame_at(self, x: float) -> int:
        """Return the frame at `x`, held within the clip."""
        left, right = self._ends()
        last = self._playhead.n_frames - 1
        return min(max(round((x - left) / max(right - left, 1.0) * last), 0), last)

    def x_of(self, frame: float) -> float:
        """Return where a frame stands."""
        left, right = self._ends()
        return left + (right - left) * frame / max(self._playhead.n_frames - 1, 1)

    def go_to_next(self) -> None:
        """Go to the next worst frame after the playhead; after the last, to the first."""
        self._go(next_worst(self._worst, self._playhead.index))

    def go_to_previous(self) -> None:
        """Go to the worst frame before the playhead; before the first, to the last."""
        self._go(next_worst(self._worst, self._playhead.index, backwards=True))

    def sizeHint(self) -> QSize:
        return QSize(400, _HEIGHT)

    def minimumSizeHint(self) -> QSize:
        return QSize(120, _HEIGHT)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._go(self.frame_at(event.position().x()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(self.frame_at(event.position().x()))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() != Qt.Key.Key_N or event.modifiers() & ~Qt.KeyboardModifier.ShiftModifier:
            super().keyPressEvent(event)
        elif event.modifiers():
            self.go_to_previous()
        else:
            self.go_to_next()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        group = QActionGroup(menu)
        for text, logarithmic in ((self.tr("Linear scale"), False), (self.tr("Logarithmic scale"), True)):
            action = QAction(text, menu, checkable=True, checked=self._logarithmic == logarithmic)
            action.triggered.connect(lambda _=False, value=logarithmic: setattr(self, "logarithmic", value))
            group.addAction(action)
            menu.addAction(action)
        menu.popup(event.globalPos())

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self._words_at(event.pos().x()), self)
            return True
        return super().event(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        palette = self.palette()
        painter.fillRect(self.rect(), palette.color(QPalette.ColorRole.Base))
        if self._error is None or len(self._error) != self._playhead.n_frames:
            self._paint_words(painter, self.tr("The error of every frame stands here once it has been measured."))
        else:
            axis = ErrorAxis.over(float(self._error.max()), logarithmic=self._logarithmic)
            self._paint_grid(painter, axis)
            self._paint_curve(painter, axis, self._error)
            self._paint_worst(painter)
            self._paint_labels(painter, axis)
        self._paint_playhead(painter)
        painter.end()

    def _paint_words(self, painter: QPainter, words: str) -> None:
        painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
        painter.drawText(self.rect().adjusted(8, 0, -8, 0), Qt.AlignmentFlag.AlignCenter, words)

    def _paint_grid(self, painter: QPainter, axis: ErrorAxis) -> None:
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Mid), 0))
        for tick in axis.ticks:
            y = self._y(axis, tick)
            painter.drawLine(QPointF(0.0, y), QPointF(self.width(), y))

    def _paint_curve(self, painter: QPainter, axis: ErrorAxis, error: FloatArray) -> None:
        left, right = self._ends()
        top, bottom = self._vertical()
        width = max(1, round(right - left))
        if len(error) <= width:
            heights = axis.heights(error)
            points = [QPointF(self.x_of(f), bottom - (bottom - top) * h) for f, h in enumerate(heights.tolist())]
        else:
            heights = axis.heights(outline(error, width))
            points = [QPointF(left + x + 0.5, bottom - (bottom - top) * h) for x, h in enumerate(heights.tolist())]
        points = [QPointF(left, points[0].y()), *points, QPointF(right, points[-1].y())]
        colour = self.palette().color(QPalette.ColorRole.Accent)
        ground = QColor(colour)
        ground.setAlphaF(0.28)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(ground)
        painter.drawPolygon(QPolygonF([QPointF(left, bottom), *points, QPointF(right, bottom)]))
        painter.setPen(QPen(colour, 0))
        painter.drawPolyline(QPolygonF(points))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _paint_worst(self, painter: QPainter) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(self.palette().color(QPalette.ColorRole.Text))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for frame in self.worst:
            x = self.x_of(frame)
            painter.drawPolygon(QPolygonF([QPointF(x - _TICK, 0.0), QPointF(x + _TICK, 0.0), QPointF(x, _TICK + 1.0)]))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _paint_labels(self, painter: QPainter, axis: ErrorAxis) -> None:
        font = tabular(self.font(), scale=0.8)
        painter.setFont(font)
        ground = self.palette().color(QPalette.ColorRole.Base)
        ground.setAlphaF(0.8)
        metrics = painter.fontMetrics()
        for tick in (axis.ticks[0], axis.ticks[-1]):
            words = self.tr("{value:g} mm").format(value=tick)
            y = min(max(self._y(axis, tick) - metrics.height() / 2, 0.0), float(self.height() - metrics.height()))
            area = QRectF(2.0, y, metrics.horizontalAdvance(words) + 4.0, metrics.height())
            painter.fillRect(area, ground)
            painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
            painter.drawText(area, Qt.AlignmentFlag.AlignCenter, words)

    def _paint_playhead(self, painter: QPainter) -> None:
        colour = self.palette().color(QPalette.ColorRole.Text)
        x = math.floor(self.x_of(self._playhead.index))
        painter.setPen(QPen(colour, 0))
        painter.drawLine(x, 0, x, self.height())
        if self.hasFocus():
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Accent), 0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))

    def _words_at(self, x: float) -> str:
        if self._error is None or len(self._error) != self._playhead.n_frames:
            return self.tr("The largest error of any joint, frame by frame. Click to go to a frame.")
        frame = self.frame_at(x)
        words = self.tr("Frame {frame}: {error}. N goes to the next worst frame, Shift+N back.")
        return words.format(frame=frame, error=millimetres(float(self._error[frame])))

    def _go(self, frame: int | None) -> None:
        if frame is not None:
            self._playhead.playing = False
            self._playhead.seek(float(frame))
            self.went.emit(frame)

    def _moved(self, _frame: int) -> None:
        self.update()

    def _ends(self) -> tuple[float, float]:
        if self._span is not None:
            return self._span
        return float(MARGIN), float(max(self.width() - MARGIN, MARGIN + 1))

    def _vertical(self) -> tuple[float, float]:
        return _TICK + 4.0, self.height() - 1.0

    def _y(self, axis: ErrorAxis, value_mm: float) -> float:
        top, bottom = self._vertical()
        return bottom - (bottom - top) * float(axis.heights(np.array([value_mm]))[0])
