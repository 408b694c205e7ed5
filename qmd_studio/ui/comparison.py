"""What lies over the picture where two sides are compared: the wipe's line, the sides' names, the heat map's legend."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QLabel

from qmd_studio.project.state import Side
from qmd_studio.render.panes import Layout
from qmd_studio.ui.heat_legend import HeatLegend
from qmd_studio.ui.stage import Stage
from qmd_studio.ui.view import View
from qmd_studio.ui.viewport import Viewport
from qmd_studio.ui.wipe_handle import WipeHandle

_MARGIN = 12
_FROM_LINE = 20


class Comparison(QObject):
    """Follows the stage: `refresh` after the view, the heat map or the names of the sides have changed."""

    def __init__(self, viewport: Viewport, stage: Stage, parent: QObject) -> None:
        super().__init__(parent)
        self._viewport, self._stage = viewport, stage
        self.handle, self.legend = WipeHandle(viewport), HeatLegend(viewport)
        self.tags = {side: _tag(viewport, side) for side in Side}
        self._names = {Side.A: self.tr("A"), Side.B: self.tr("B")}
        self.handle.moved.connect(self._wipe)
        self.legend.range_chosen.connect(self._choose_range)
        viewport.installEventFilter(self)
        self.refresh()

    def name_sides(self, a: str, b: str) -> None:
        """Call the sides by these names, which say what they are."""
        self._names = {Side.A: a, Side.B: b}
        self.refresh()

    def set_dark(self, dark: bool) -> None:
        """Stand on a dark or a light stage."""
        self.legend.set_dark(dark)
        for tag in self.tags.values():
            tag.setProperty("dark", dark)
            tag.style().unpolish(tag)
            tag.style().polish(tag)

    def refresh(self) -> None:
        """Show what belongs to the present view."""
        view, known = self._stage.shown_view, self._stage.has_decoded
        self.handle.setVisible(view is View.WIPE)
        difference = view is View.DIFFERENCE
        self.legend.setVisible(difference or (self._stage.heated and known))
        self.legend.show_range(
            self._stage.range_mm, self.tr("B against A") if difference else self.tr("Error of the joints")
        )
        for side, tag in self.tags.items():
            tag.setText(self._names[side])
            tag.setVisible(known and side in view.sides)
        self._place()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self._viewport and event.type() == QEvent.Type.Resize:
            self._place()
        return False

    def _place(self) -> None:
        width, height = self._viewport.width(), self._viewport.height()
        self.handle.show_split(self._viewport.split)
        self.legend.move(_MARGIN, height - self.legend.height() - _MARGIN)
        a, b = self.tags[Side.A], self.tags[Side.B]
        for tag in (a, b):
            tag.adjustSize()
        view = self._stage.shown_view
        if view in (View.WIPE, View.BESIDE):
            line = round(width * (self._viewport.split if view is View.WIPE else 0.5))
            a.move(max(line - _FROM_LINE - a.width(), _MARGIN - a.width()), _MARGIN)
            b.move(min(line + _FROM_LINE, width - _MARGIN), _MARGIN)
        else:
            a.move(_MARGIN, _MARGIN)
            b.move(_MARGIN + (a.width() + 8 if a.isVisibleTo(self._viewport) else 0), _MARGIN)

    def _wipe(self, split: float) -> None:
        self._viewport.set_layout(Layout.WIPE, split)
        self._place()

    def _choose_range(self, range_mm: float) -> None:
        self._stage.range_mm = range_mm


def _tag(viewport: Viewport, side: Side) -> QLabel:
    tag = QLabel(viewport)
    tag.setObjectName(f"SideTag{side.upper()}")
    tag.setProperty("tag", True)
    tag.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
    tag.hide()
    return tag
