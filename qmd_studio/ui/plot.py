"""Plots of the codec lab. This module imports pyqtgraph, which takes a while: import it where a plot is made."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import pyqtgraph
from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

Points = Sequence[tuple[float, float]]

LINE_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#c0639a", "#b87700")
"""After Okabe and Ito, told apart by all; the last two darker, so that each has 3:1 on light and on dark ground."""
_SYMBOLS = ("o", "t", "s", "d", "star")
_SIGNS = ("●", "▼", "■", "◆", "★")
"""The same in letters."""
_LINE_SIGN = "━"
_HEIGHT = 168
_AXIS_WIDTH = 48
_PADDING = 0.12
_LEAST_DECADES = 0.7
"""A logarithmic axis shows no less: two numbers at least then stand at it."""


class _Axis(pyqtgraph.AxisItem):
    """An axis that writes numbers out: 0.001 and 30, not 1 of a thousandth or 3·10¹."""

    def __init__(self, side: str) -> None:
        super().__init__(side)
        self.enableAutoSIPrefix(False)

    def logTickStrings(self, values: Sequence[float], scale: float, spacing: float) -> list[str]:
        return [f"{10.0**value:.3g}" if _is_wanted(value) else "" for value in values]


def _is_wanted(value: float) -> bool:
    """Return whether a tick of a logarithmic axis has room for its number: 1, 2, 3 and 5 of each decade."""
    return round(10.0 ** (value - math.floor(value + 1e-9))) in (1, 2, 3, 5)


class Plot(QWidget):
    """A plot with named lines, dots to click, and a mark for each side; `picked` carries the number of a dot."""

    picked = Signal(int)

    def __init__(self, *, x: str, y: str, log: tuple[bool, bool], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._log = log
        self._titles = (x, y)
        axes = {"bottom": _Axis("bottom"), "left": _Axis("left")}
        self._view = pyqtgraph.PlotWidget(self, background=None, axisItems=axes)
        self.item = self._view.getPlotItem()
        self.item.setMenuEnabled(False)
        self.item.setMouseEnabled(False, False)
        self.item.hideButtons()
        self.item.setLogMode(*log)
        self.item.getAxis("left").setWidth(_AXIS_WIDTH)
        self.item.getViewBox().setDefaultPadding(_PADDING)
        least = [_LEAST_DECADES if each else None for each in log]
        self.item.getViewBox().setLimits(minXRange=least[0], minYRange=least[1])
        self.legend = QLabel(self)  # above the plot, where no line runs through it
        self.legend.setContentsMargins(_AXIS_WIDTH, 0, 0, 0)
        self._named: list[str] = []
        self._view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._lines: dict[str, pyqtgraph.PlotDataItem] = {}
        self.dots = pyqtgraph.ScatterPlotItem(size=8, hoverable=True, tip=None)
        self.marks: dict[str, tuple[pyqtgraph.ScatterPlotItem, pyqtgraph.TextItem]] = {}
        self.dots.sigClicked.connect(self._pick)
        self.item.addItem(self.dots)
        self.dots.setZValue(5)
        self._view.setFixedHeight(_HEIGHT)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(self.legend)
        layout.addWidget(self._view)
        self._dress()

    def show_line(self, name: str, points: Points) -> None:
        """Draw the line `name` through `points`; the first four names get colours of their own."""
        if name not in self._lines:
            colour = LINE_COLOURS[len(self._lines) % len(LINE_COLOURS)]
            self._lines[name] = self.item.plot([], [], name=name, pen=pyqtgraph.mkPen(colour, width=1))
            self._name(_LINE_SIGN, colour, name)
        self._lines[name].setData([x for x, _ in points], [y for _, y in points])

    def points_of(self, name: str) -> list[tuple[float, float]]:
        """Return the points of a line, as they were given."""
        x, y = self._lines[name].getOriginalDataset()
        return [] if x is None else list(zip(x.tolist(), y.tolist(), strict=True))

    def show_dots(self, points: Points, kinds: Sequence[int], tips: Sequence[str]) -> None:
        """Draw a dot for each of `points`, of a colour and shape for each of `kinds`, that can be clicked."""
        spots = [
            {
                "pos": self._place(point),
                "brush": LINE_COLOURS[kind],
                "pen": None,
                "symbol": _SYMBOLS[kind],
                "data": number,
            }
            for number, (point, kind) in enumerate(zip(points, kinds, strict=True))
        ]
        self._tips = list(tips)
        self.dots.setData(spots)
        self.dots.opts["tip"] = lambda x, y, data: self._tips[data]

    def name_kinds(self, names: Sequence[str]) -> None:
        """Say in the legend what the kinds of dots are called, those with a name."""
        for kind, name in enumerate(names):
            if name:
                self._name(_SIGNS[kind], LINE_COLOURS[kind], name)

    def show_mark(self, name: str, point: tuple[float, float] | None) -> None:
        """Put the mark called `name` at `point`, or nowhere."""
        if name not in self.marks:
            spot = pyqtgraph.ScatterPlotItem(size=12, symbol="o")
            left = len(self.marks) % 2 == 0  # two marks in one place can both be read
            text = pyqtgraph.TextItem(name, anchor=(1.6, 0.5) if left else (-0.6, 0.5))
            for item in (spot, text):
                item.setZValue(10)
                self.item.addItem(item, ignoreBounds=item is text)
            self.marks[name] = (spot, text)
            self._dress()
        spot, text = self.marks[name]
        spot.setData(pos=[] if point is None else [self._place(point)])
        text.setVisible(point is not None)
        if point is not None:
            text.setPos(*self._place(point))

    def clear(self) -> None:
        """Draw nothing."""
        for line in self._lines.values():
            line.setData([], [])
        self.dots.setData([])
        for name in self.marks:
            self.show_mark(name, None)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.StyleChange) and hasattr(self, "legend"):
            self._dress()

    def _name(self, sign: str, colour: str, name: str) -> None:
        self._named.append(f'<span style="color:{colour}">{sign}</span>&nbsp;{escape(name)}')
        self.legend.setText("&nbsp;&nbsp; ".join(self._named))

    def _place(self, point: tuple[float, float]) -> tuple[float, float]:
        """Return where an item stands that does not know of logarithmic axes."""
        return tuple(math.log10(v) if log else v for v, log in zip(point, self._log, strict=True))

    def _dress(self) -> None:
        palette = self.palette()
        ink, muted = palette.color(QPalette.ColorRole.Text), palette.color(QPalette.ColorRole.PlaceholderText)
        for side, title in zip(("bottom", "left"), self._titles, strict=True):
            axis = self.item.getAxis(side)
            axis.setPen(palette.color(QPalette.ColorRole.Mid))
            axis.setTextPen(muted)
            axis.setLabel(title if side == "bottom" else "", color=muted.name(), **{"font-size": "8pt"})
            axis.setStyle(tickFont=self.font())
        faint = QColor(muted)
        faint.setAlphaF(0.2)
        self.item.showGrid(x=True, y=True, alpha=0.15)
        for spot, text in self.marks.values():
            spot.setPen(pyqtgraph.mkPen(ink, width=2))
            spot.setBrush(palette.color(QPalette.ColorRole.Base))
            text.setColor(ink)

    def _pick(self, _item: object, spots: Sequence[pyqtgraph.SpotItem]) -> None:
        if len(spots):
            self.picked.emit(int(spots[0].data()))
