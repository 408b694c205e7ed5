"""The dialogs: file choosers by the registry's formats, the list of shortcuts, and About."""

from __future__ import annotations

import platform
from pathlib import Path

from PySide6 import __version__ as pyside_version
from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHeaderView,
    QLabel,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from qmd_studio import __version__
from qmd_studio.ui.actions import VERBS, keys_text, plain_text, translated
from qmd_studio.ui.icons import application_icon


def _tr(text: str) -> str:
    return QCoreApplication.translate("Dialogs", text)


def ask_open(parent: QWidget, folder: Path) -> list[Path]:
    """Let the user choose files to open; returns none where that is called off."""
    from qmd_studio.registry import FORMATS

    every = " ".join(f"*{suffix}" for format_ in FORMATS for suffix in format_.suffixes)
    filters = [_tr("Motions and bodies ({suffixes})").format(suffixes=every)]
    filters += [f"{format_.title} ({' '.join(f'*{s}' for s in format_.suffixes)})" for format_ in FORMATS]
    filters.append(_tr("All files (*)"))
    names, _ = QFileDialog.getOpenFileNames(parent, _tr("Open"), str(folder), ";;".join(filters))
    return [Path(name) for name in names]


def ask_export(parent: QWidget, suggested: Path) -> Path | None:
    """Let the user say where to write a motion; the suffix says in which format."""
    from qmd_studio.registry import FORMATS

    filters = [
        f"{format_.title} ({' '.join(f'*{s}' for s in format_.suffixes)})"
        for format_ in FORMATS
        if format_.write or format_.write_figure
    ]
    name, chosen = QFileDialog.getSaveFileName(parent, _tr("Export as"), str(suggested), ";;".join(filters))
    if not name:
        return None
    path = Path(name)
    if path.suffix:
        return path
    suffix = chosen.rpartition("(*")[2].split(" ")[0].rstrip(")")
    return path.with_name(path.name + suffix)


class ShortcutsDialog(QDialog):
    """Every verb with its keys, from the table that also makes the menus."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(_tr("Keyboard shortcuts"))
        self.resize(760, 640)
        verbs = [verb for verb in VERBS if verb.keys]
        table = QTableWidget(len(verbs), 3)
        table.setAccessibleName(_tr("Keyboard shortcuts"))
        table.setToolTip(_tr("All keys of the window"))
        table.setHorizontalHeaderLabels([_tr("Keys"), _tr("Command"), _tr("What it does")])
        table.verticalHeader().hide()
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setShowGrid(False)
        for row, verb in enumerate(verbs):
            for place, text in enumerate((keys_text(verb), plain_text(verb).rstrip("…"), translated(verb.tip))):
                table.setItem(row, place, QTableWidgetItem(text))
        table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        table.horizontalHeader().setStretchLastSection(True)
        table.horizontalHeader().setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        column = QVBoxLayout(self)
        column.addWidget(table)
        column.addWidget(_close_button(self))


class AboutDialog(QDialog):
    """What this is, its version and licence, and what it runs on."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(_tr("About QMD Studio"))
        column = QVBoxLayout(self)
        column.setContentsMargins(24, 24, 24, 16)
        column.setSpacing(12)
        picture = QLabel()
        picture.setPixmap(application_icon().pixmap(64, 64))
        text = QLabel(
            f"<h2>QMD Studio {__version__}</h2>"
            f"<p>{_tr('Avatar animation that is small to send and cheap to play.')}</p>"
            f"<p>{_tr('MIT licence.')}</p>"
        )
        runs_on = QLabel(f"Python {platform.python_version()}  ·  PySide6 {pyside_version}  ·  {platform.platform()}")
        runs_on.setProperty("muted", True)
        runs_on.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        for widget in (picture, text, runs_on, _close_button(self)):
            column.addWidget(widget)


def _close_button(dialog: QDialog) -> QDialogButtonBox:
    box = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
    box.rejected.connect(dialog.reject)
    return box
