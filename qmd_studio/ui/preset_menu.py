"""The presets of the codec lab: a menu to load and save them, and a dialog to keep house."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QCoreApplication, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHBoxLayout,
    QInputDialog,
    QListWidget,
    QListWidgetItem,
    QMenu,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from qmd_studio.errors import QmdStudioError
from qmd_studio.project.preset_json import MAX_NAME, Preset, to_json
from qmd_studio.project.presets import BUILT_IN, PresetShelf
from qmd_studio.storage import write_atomic
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.ui.notice import Notice

AskName = Callable[[QWidget, str], str | None]
OPTIMUM = "Paper's grid optimum"


class PresetButton(QToolButton):
    """Shows which preset the settings are, and a menu of all.

    `chosen` carries the settings of one, `optimum_wanted` asks for the paper's exhaustive search, `failed` carries what
    went wrong.
    """

    chosen = Signal(object)
    optimum_wanted = Signal()
    failed = Signal(object)

    def __init__(
        self, parent: QWidget | None = None, *, shelf: PresetShelf | None = None, ask_name: AskName | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("Presets")
        self.shelf = shelf or PresetShelf()
        self._ask_name = ask_name or ask_for_name
        self._settings: EncodeSettings | None = None
        self._own: list[Preset] | None = None
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setProperty("choice", True)
        self.setToolTip(self.tr("Load settings that have a name, or give these one"))
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        menu.aboutToShow.connect(self.fill)
        self.setMenu(menu)
        self.show_settings(None)

    def show_settings(self, settings: EncodeSettings | None) -> None:
        """Say which preset `settings` are; None where there are no settings."""
        self._settings = settings
        if self._own is None:
            self._own = self.shelf.own()
        name = next((_shown(preset) for preset in (*BUILT_IN, *self._own) if preset.settings == settings), None)
        text = name.split(":")[0] if name else self.tr("Presets")
        self.setText(f"{text}  ▾")
        self.setAccessibleName(self.tr("Preset: {name}").format(name=name or self.tr("none")))

    def fill(self) -> None:
        """Put what there is now into the menu."""
        menu = self.menu()
        menu.clear()
        self._own = self.shelf.own()
        for preset in BUILT_IN:
            self._add(menu, preset)
        optimum = menu.addAction(_translated(OPTIMUM), self.optimum_wanted)
        optimum.setToolTip(self.tr("Try the paper's whole grid with its encoder and take the least bytes times DEF"))
        menu.addSeparator()
        for preset in self._own:
            self._add(menu, preset)
        if self._own:
            menu.addSeparator()
        menu.addAction(self.tr("&Save as preset…"), self.save).setEnabled(self._settings is not None)
        menu.addAction(self.tr("&Manage presets…"), self.manage)

    def save(self) -> None:
        """Ask for a name and keep the settings under it."""
        if self._settings is None:
            return
        name = self._ask_name(self, self.tr("My preset"))
        if name is None:
            return
        try:
            self.shelf.save(Preset(name, self._settings))
        except QmdStudioError as problem:
            self.failed.emit(problem)
        self._own = None
        self.show_settings(self._settings)

    def manage(self) -> None:
        """Open the dialog of the user's presets."""
        dialog = PresetDialog(self.shelf, self, ask_name=self._ask_name)
        dialog.finished.connect(self._look_again)
        dialog.open()

    def _look_again(self) -> None:
        self._own = None
        self.show_settings(self._settings)

    def _add(self, menu: QMenu, preset: Preset) -> QAction:
        action = menu.addAction(_shown(preset).replace("&", "&&"))
        action.setCheckable(True)
        action.setChecked(preset.settings == self._settings)
        action.triggered.connect(lambda _=False: self.chosen.emit(preset.settings))
        return action


class PresetDialog(QDialog):
    """The user's own presets: rename, remove, import, export, and reset to those that come with the studio."""

    def __init__(self, shelf: PresetShelf, parent: QWidget, *, ask_name: AskName) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Presets"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._shelf, self._ask_name = shelf, ask_name
        self.list, self.notice = QListWidget(self), Notice(self)
        self.list.setAccessibleName(self.tr("Your presets"))
        self.list.setToolTip(str(shelf.folder))
        self.buttons = {
            "rename": self._button(self.tr("Rename…"), self.tr("Give the preset another name"), self.rename),
            "remove": self._button(self.tr("Remove"), self.tr("Throw the preset away"), self.remove),
            "import": self._button(self.tr("Import…"), self.tr("Take in a preset's file"), self.take_in),
            "export": self._button(self.tr("Export…"), self.tr("Write the preset to a file"), self.give_out),
            "reset": self._button(
                self.tr("Reset"), self.tr("Throw all your presets away; the studio's own stay"), self.reset
            ),
        }
        self._lay_out()
        self.list.currentRowChanged.connect(self._enable)
        self._fill()

    def rename(self) -> None:
        """Ask for another name of the chosen preset."""
        preset = self._chosen()
        name = self._ask_name(self, preset.name) if preset else None
        if preset and name is not None:
            self._try(lambda: self._shelf.rename(preset, name))

    def remove(self) -> None:
        """Throw the chosen preset away."""
        if preset := self._chosen():
            self._try(lambda: self._shelf.remove(preset))

    def reset(self) -> None:
        """Throw all of them away."""
        self._try(self._shelf.reset)

    def take_in(self) -> None:
        """Ask for a file and keep the preset in it."""
        name, _ = QFileDialog.getOpenFileName(self, self.tr("Import preset"), str(Path.home()), _filter())
        if name:
            self._try(lambda: self._shelf.take_in(Path(name)))

    def give_out(self) -> None:
        """Ask for a file and write the chosen preset to it."""
        preset = self._chosen()
        if preset is None:
            return
        suggested = str(Path.home() / f"{preset.name}.json")
        name, _ = QFileDialog.getSaveFileName(self, self.tr("Export preset"), suggested, _filter())
        if name:
            self._try(lambda: write_atomic(Path(name), to_json(preset)))

    def _try(self, action: Callable[[], object]) -> None:
        self.notice.clear()
        try:
            action()
        except QmdStudioError as problem:
            self.notice.say_error(self.tr("That could not be done"), problem)
        self._fill()

    def _fill(self) -> None:
        row = self.list.currentRow()
        self.list.clear()
        for preset in self._shelf.own():
            item = QListWidgetItem(preset.name, self.list)
            item.setData(Qt.ItemDataRole.UserRole, preset)
        self.list.setCurrentRow(min(max(row, 0), self.list.count() - 1))
        self._enable()

    def _enable(self) -> None:
        for key in ("rename", "remove", "export"):
            self.buttons[key].setEnabled(self._chosen() is not None)
        self.buttons["reset"].setEnabled(self.list.count() > 0)

    def _chosen(self) -> Preset | None:
        item = self.list.currentItem()
        return None if item is None else item.data(Qt.ItemDataRole.UserRole)

    def _button(self, text: str, tip: str, action: Callable[[], None]) -> QPushButton:
        button = QPushButton(text, self, autoDefault=False)
        button.setToolTip(tip)
        button.setAccessibleName(text)
        button.clicked.connect(action)
        return button

    def _lay_out(self) -> None:
        column, row, layout = QVBoxLayout(), QHBoxLayout(), QVBoxLayout(self)
        for button in self.buttons.values():
            column.addWidget(button)
        column.addStretch(1)
        row.addWidget(self.list, 1)
        row.addLayout(column)
        close = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        close.rejected.connect(self.reject)
        layout.addLayout(row)
        layout.addWidget(self.notice)
        layout.addWidget(close)
        self.resize(420, 300)


def ask_for_name(parent: QWidget, suggested: str) -> str | None:
    """Ask for a preset's name; None where the user changed their mind."""
    title, label = _translated("Preset"), _translated("Name of the preset:")
    name, wanted = QInputDialog.getText(parent, title, label, text=suggested)
    return name[:MAX_NAME] if wanted else None


def _shown(preset: Preset) -> str:
    return _translated(preset.name) if preset in BUILT_IN else preset.name


def _filter() -> str:
    return _translated("Presets (*.json)")


def _translated(text: str) -> str:
    return QCoreApplication.translate("Presets", text)
