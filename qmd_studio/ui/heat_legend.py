"""The legend of the heat map: its colours, from nothing to a distance in mm that stays as it was chosen."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QActionGroup,
    QColor,
    QKeyEvent,
    QLinearGradient,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
)
from PySide6.QtWidgets import QMenu, QWidget

from qmd_studio.render.heat import heat_colours
from qmd_studio.tuning.joint_heat import HEAT_RANGES_MM
from qmd_studio.ui.quantity import tabular

_SIZE = QSize(212, 58)
_STOPS = 16


class HeatLegend(QWidget):
    """Shows the scale; a click or the arrow keys choose another, which `range_chosen` carries in mm."""

    range_chosen = Signal(float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("HeatLegend")
        self._range_mm, self._dark, self._title = HEAT_RANGES_MM[1], False, ""
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setToolTip(
            self.tr("The scale stays as it is chosen, so that pictures can be compared. Click to change it.")
        )
        self.setFont(tabular(self.font(), scale=0.9))
        self.resize(_SIZE)
        self.show_range(self._range_mm, self.tr("Error of the joints"))
        self.hide()

    @property
    def range_mm(self) -> float:
        """The distance at the hot end, in mm."""
        return self._range_mm

    def show_range(self, range_mm: float, title: str) -> None:
        """Show the scale that ends at `range_mm`; `title` says what it measures."""
        self._range_mm, self._title = range_mm, title
        self.setAccessibleName(self.tr("{title}: 0 to {range:g} mm").format(title=title, range=range_mm))
        self.update()

    def set_dark(self, dark: bool) -> None:
        """Stand on a dark or a light stage."""
        self._dark = dark
        self.update()

    def sizeHint(self) -> QSize:
        return _SIZE

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton and self.rect().contains(event.position().toPoint()):
            self.menu().popup(event.globalPosition().toPoint())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Down: -1, Qt.Key.Key_Right: 1, Qt.Key.Key_Up: 1}
        if event.key() in steps and event.modifiers() == Qt.KeyboardModifier.NoModifier:
            place = HEAT_RANGES_MM.index(self._range_mm) + steps[Qt.Key(event.key())]
            self._choose(HEAT_RANGES_MM[min(max(place, 0), len(HEAT_RANGES_MM) - 1)])
        else:
            super().keyPressEvent(event)

    def menu(self) -> QMenu:
        """Return a menu of the scales."""
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        group = QActionGroup(menu)
        for value in HEAT_RANGES_MM:
            text = self.tr("0 to {range:g} mm").format(range=value)
            action = QAction(text, menu, checkable=True, checked=value == self._range_mm)
            action.triggered.connect(lambda _=False, value=value: self._choose(value))
            group.addAction(action)
            menu.addAction(action)
        return menu

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ground, ink = (
            (QColor(20, 22, 26, 190), QColor(232, 234, 237))
            if self._dark
            else (QColor(255, 255, 255, 215), QColor(32, 36, 44))
        )
        border = self.palette().accent().color() if self.hasFocus() else QColor(ink.red(), ink.green(), ink.blue(), 60)
        painter.setPen(QPen(border, 1.0))
        painter.setBrush(ground)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 4.0, 4.0)
        bar = self.bar()
        gradient = QLinearGradient(bar.topLeft(), bar.topRight())
        places = np.linspace(0.0, 1.0, _STOPS)
        for place, colour in zip(places, heat_colours(places), strict=True):
            gradient.setColorAt(place, QColor.fromRgbF(*colour))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(gradient)
        painter.drawRect(bar)
        painter.setPen(ink)
        line = painter.fontMetrics().height()
        painter.drawText(QRectF(bar.left(), 5.0, bar.width(), line), Qt.AlignmentFlag.AlignLeft, self._title)
        below = QRectF(bar.left(), bar.bottom() + 3.0, bar.width(), line)
        for flag, share in ((Qt.AlignmentFlag.AlignLeft, 0.0), (Qt.AlignmentFlag.AlignHCenter, 0.5)):
            painter.drawText(below, flag, self.tr("{value:g}").format(value=share * self._range_mm))
        painter.drawText(below, Qt.AlignmentFlag.AlignRight, self.tr("≥ {value:g} mm").format(value=self._range_mm))

    def bar(self) -> QRectF:
        """Return where the colours stand."""
        return QRectF(10.0, 23.0, self.width() - 20.0, 11.0)

    def _choose(self, range_mm: float) -> None:
        if range_mm != self._range_mm:
            self.show_range(range_mm, self._title)
            self.range_chosen.emit(range_mm)
