"""Choosing how bodies are shown and whether joints are named, by verb or button; both are remembered."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QToolButton

from qmd_studio.render.scene import Look
from qmd_studio.ui.icons import icon

if TYPE_CHECKING:
    from qmd_studio.ui.main_window import MainWindow


class LookSwitch(QObject):
    """Sets the viewport's look and its labels, first to what they were in the last session."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        remembered = window.settings.look
        window.viewport.set_look(Look(remembered) if remembered in list(Look) else Look.SOLID)
        window.viewport.hover.names = window.settings.joint_names

    def handlers(self) -> dict[str, Callable[[], object]]:
        """Return what the verbs of the look do."""
        return {
            **{f"look_{look}": lambda look=look: self.show_look(look) for look in Look},
            "joint_names": self._toggle_names,
        }

    def show_look(self, look: Look) -> None:
        """Show bodies in this way from now on."""
        self._window.viewport.set_look(look)
        self._window.settings.look = look.value
        self.follow()

    def follow(self) -> None:
        """Let the menu and the button say what is chosen, in the colours of the present theme."""
        window, look = self._window, self._window.viewport.look
        window.verbs[f"look_{look}"].setChecked(True)
        window.verbs["joint_names"].setChecked(window.viewport.hover.names)
        for button in window.tools.findChildren(QToolButton, "Look"):
            button.setIcon(icon(f"look-{look}"))

    def _toggle_names(self) -> None:
        names = self._window.verbs["joint_names"].isChecked()
        self._window.viewport.hover.names = names
        self._window.settings.joint_names = names
        self._window.viewport.update()
