"""The title of a dock: its name, and buttons large enough to hit that float it and close it."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QDockWidget, QHBoxLayout, QLabel, QToolButton, QWidget

from qmd_studio.ui.icons import icon

_ICON_PX = 16


class DockTitle(QWidget):
    """Stands in the place of the style's own title, whose buttons are tiny. Drags and double clicks go to the dock."""

    def __init__(self, dock: QDockWidget) -> None:
        super().__init__(dock)
        self.setObjectName("DockTitle")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        label = QLabel(dock.windowTitle())
        self._buttons = {
            "float": self._button(self.tr("Take this panel out of the window, or put it back")),
            "close": self._button(self.tr("Close this panel; the View menu shows it again")),
        }
        self._buttons["float"].clicked.connect(lambda: dock.setFloating(not dock.isFloating()))
        self._buttons["close"].clicked.connect(dock.close)
        names = {"float": self.tr("Float the panel {panel}"), "close": self.tr("Close the panel {panel}")}
        for verb, button in self._buttons.items():
            button.setAccessibleName(names[verb].format(panel=dock.windowTitle()))
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 2, 4, 2)
        row.setSpacing(0)
        row.addWidget(label, 1)
        for button in self._buttons.values():
            row.addWidget(button)
        self.refresh_icons()

    def refresh_icons(self) -> None:
        """Draw the icons in the colours of the present theme."""
        for name, button in self._buttons.items():
            button.setIcon(icon(name))

    def _button(self, tip: str) -> QToolButton:
        button = QToolButton()
        button.setIconSize(QSize(_ICON_PX, _ICON_PX))
        button.setToolTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button
