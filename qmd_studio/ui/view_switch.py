"""Choosing how the two sides are seen, by verb, button or key; everything that says so follows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from qmd_studio.ui.view import COMPARING, View

if TYPE_CHECKING:
    from qmd_studio.ui.comparison import Comparison
    from qmd_studio.ui.main_window import MainWindow

_VERBS = {View.A: "show_original", View.B: "show_decoded"}


class ViewSwitch(QObject):
    """Sets the stage's view and heat map. `comparison` is what lies over the picture, once the window is furnished."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._comparing = View.WIPE
        self.comparison: Comparison | None = None

    def handlers(self) -> dict[str, Callable[[], object]]:
        """Return what the verbs of the views do."""
        return {
            "show_original": lambda: self.show_view(View.A),
            "show_both": lambda: self.show_view(self._comparing),
            "show_decoded": lambda: self.show_view(View.B),
            **{f"compare_{view}": lambda v=view: self.show_view(v) for view in COMPARING},
            "heat_map": lambda: self.show_heat(not self._window.stage.heated),
        }

    def show_view(self, view: View) -> None:
        """Show side A, side B, or both in one of the ways to compare them."""
        self._window.stage.view = view
        if view in COMPARING:
            self._comparing = view
        self.follow()

    def show_heat(self, heated: bool) -> None:
        """Paint the error of the joints on the body, or not."""
        self._window.stage.heated = heated
        self.follow()

    def follow(self) -> None:
        """Let everything about the stage say what is on it."""
        window, stage = self._window, self._window.stage
        window.verbs[_VERBS.get(stage.view, "show_both")].setChecked(True)
        window.verbs[f"compare_{self._comparing}"].setChecked(True)
        window.verbs["heat_map"].setChecked(stage.heated)
        if window.lab is not None:
            window.lab.view.show_view(stage.view)
            window.lab.view.show_heat(stage.heated)
        if self.comparison is not None:
            self.comparison.refresh()
        window.enable_verbs()

    def set_dark(self, dark: bool) -> None:
        """Stand on a dark or a light stage."""
        if self.comparison is not None:
            self.comparison.set_dark(dark)
