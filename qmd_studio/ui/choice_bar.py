"""A row of buttons of which one is chosen: for two to four ways that are better seen than unfolded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QSizePolicy, QToolButton, QWidget


@dataclass(frozen=True, slots=True)
class Choice:
    """One way: its key, what it is called and what it does."""

    key: str
    text: str
    tip: str


class ChoiceBar(QWidget):
    """Emits `chosen(key)` when the user chooses; `show_choice` changes it silently. Arrow keys go along the row."""

    chosen = Signal(str)

    def __init__(self, name: str, choices: Sequence[Choice], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(name)
        self._group = QButtonGroup(self)
        self._buttons: dict[str, QToolButton] = {}
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for choice in choices:
            layout.addWidget(self._button(name, choice), 1)
        self._buttons[choices[0].key].setChecked(True)

    @property
    def choice(self) -> str:
        """The key of the way that is chosen."""
        return next(key for key, button in self._buttons.items() if button.isChecked())

    def offers(self, key: str) -> bool:
        """Say whether `key` is one of the ways."""
        return key in self._buttons

    def button(self, key: str) -> QToolButton:
        """Return the button of a way."""
        return self._buttons[key]

    def show_choice(self, key: str) -> None:
        """Show `key` as chosen, without emitting anything."""
        self._buttons[key].setChecked(True)

    def _button(self, name: str, choice: Choice) -> QToolButton:
        button = QToolButton(self, text=choice.text, checkable=True)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.setProperty("choice", True)
        button.setToolTip(choice.tip)
        button.setAccessibleName(f"{name}: {choice.text}")
        button.clicked.connect(lambda: self.chosen.emit(choice.key))
        self._group.addButton(button)
        self._buttons[choice.key] = button
        return button
