"""The buttons that say how the two sides are seen."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QToolButton, QWidget

from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.view import View


class ViewBar(QWidget):
    """Emits `chosen(View)` and `heat_toggled(bool)` when the user chooses; the `show_` methods emit nothing."""

    chosen = Signal(object)
    heat_toggled = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.choices = ChoiceBar(self.tr("View"), self._views(), self)
        self.heat = QToolButton(self, text=self.tr("Heat"), checkable=True)
        self.heat.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.heat.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.heat.setProperty("choice", True)
        self.heat.setToolTip(self.tr("Paint the error of each joint on the body (E); its scale stands in the picture"))
        self.heat.setAccessibleName(self.tr("Heat map of the error"))
        self.choices.chosen.connect(lambda key: self.chosen.emit(View(key)))
        self.heat.clicked.connect(self.heat_toggled)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.choices, 1)
        layout.addWidget(self.heat)

    @property
    def view(self) -> View:
        """The view that is chosen."""
        return View(self.choices.choice)

    def show_view(self, view: View) -> None:
        """Show `view` as chosen."""
        self.choices.show_choice(view.value)

    def show_heat(self, heated: bool) -> None:
        """Show whether the heat map is on."""
        self.heat.setChecked(heated)

    def _views(self) -> tuple[Choice, ...]:
        return (
            Choice(View.A, self.tr("A"), self.tr("Show side A alone (Alt+1)")),
            Choice(View.WIPE, self.tr("Wipe"), self.tr("A left of a line, B right of it: drag the line")),
            Choice(View.BESIDE, self.tr("Beside"), self.tr("A and B beside each other, seen by one camera")),
            Choice(View.GHOST, self.tr("Ghost"), self.tr("Side B as a ghost over A")),
            Choice(View.DIFFERENCE, self.tr("Diff."), self.tr("Only what of B is not where it is in A, by its colour")),
            Choice(View.B, self.tr("B"), self.tr("Show side B alone, what a player of the QMD file shows (Alt+3)")),
        )
