"""The export button of the codec lab: one click writes the very bytes that were measured."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QGuiApplication
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QMenu, QPushButton, QToolButton, QVBoxLayout, QWidget

from qmd_studio.errors import QmdStudioError, StorageError
from qmd_studio.project.clip import Clip
from qmd_studio.tuning.export import Exported, export_numbered, export_over, suggested_name
from qmd_studio.ui.notice import Notice
from qmd_studio.ui.quantity import kilobytes

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport

AskPath = Callable[[QWidget, Path], Path | None]


class ExportBar(QWidget):
    """Export QMD and Export QMD as…, and below them what came of it.

    The owner hands every report to `take_report`; a click before the report is there is kept and done when it comes.
    `exported` is emitted with the path that was written, `reopen_wanted` with the path that the user wants to open,
    `report_wanted` asks for the report where the user would not wait for it before.
    """

    exported = Signal(object)
    reopen_wanted = Signal(object)
    report_wanted = Signal()

    def __init__(self, ask_path: AskPath | None = None, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._ask_path = ask_path or ask_for_path
        self._clip: Clip | None = None
        self._report: LabReport | None = None
        self._waiting: str | None = None
        self._last: Path | None = None
        self.button = QPushButton(self.tr("Export QMD"), self)
        self.more = QToolButton(self, text="▾", popupMode=QToolButton.ToolButtonPopupMode.InstantPopup)
        self.notice = Notice(self)
        self._dress()
        self._lay_out()

    @property
    def folder(self) -> Path:
        """The folder that one click exports to: the clip's own, or the home folder for a clip made here."""
        path = self._clip.path if self._clip is not None else None
        return path.parent if path is not None else Path.home()

    def show_clip(self, clip: Clip | None) -> None:
        """Export this clip from now on."""
        if self._clip is None or clip is None or clip.key != self._clip.key:
            self.notice.clear()
            self._waiting = None
        if self._clip is None or clip is None or clip.motion is not self._clip.motion:
            self._report = None
        self._clip = clip
        self.setEnabled(clip is not None)

    def forget_report(self) -> None:
        """The settings changed: the next report is what is exported, and what was said of the last is old."""
        self._report = None
        if self._waiting is None:
            self.notice.clear()

    def take_report(self, report: LabReport) -> None:
        """Keep the report whose bytes are exported, and do what was asked for while it was measured."""
        self._report = report
        if self._waiting is not None:
            way, self._waiting = self._waiting, None
            self._export(way)

    def take_failure(self) -> None:
        """There will be no report: what was asked for cannot be done."""
        if self._waiting is not None:
            self._waiting = None
            self.notice.say("error", self.tr("Nothing was exported"), self.tr("These settings could not be encoded."))

    def export(self) -> None:
        """Write the file beside its source, at once or as soon as it has been measured."""
        self._want("beside")

    def export_as(self) -> None:
        """Ask for a name and write the file there."""
        self._want("ask")

    def _want(self, way: str) -> None:
        if self._clip is None:
            return
        if self._report is None:
            self._waiting = way
            self.notice.say("info", self.tr("Exporting when measured…"))
            self.report_wanted.emit()
        else:
            self._export(way)

    def _clicked(self) -> None:
        shift = QGuiApplication.keyboardModifiers() & Qt.KeyboardModifier.ShiftModifier
        self._want("ask" if shift else "beside")

    def _export(self, way: str) -> None:
        report, clip = self._report, self._clip
        if report is None or clip is None:
            return
        stem = clip.path.stem if clip.path is not None else clip.name
        path = self.folder / suggested_name(stem, report.settings, clip.motion.n_frames)
        try:
            if way == "ask" or not os.access(path.parent, os.W_OK):
                named = self._ask_path(self, path)
                done = None if named is None else export_over(report.data, named)
            else:
                done = export_numbered(report.data, path)
        except StorageError as problem:
            self._fail(problem)
        else:
            self._say(done)

    def _fail(self, problem: QmdStudioError) -> None:
        links = (("as", self.tr("Export QMD as…")),)
        self.notice.say("error", self.tr("Nothing was exported"), str(problem), links)

    def _say(self, done: Exported | None) -> None:
        if done is None:
            self.notice.clear()
            return
        self._last = done.path
        size = kilobytes(done.n_bytes)
        said = self.tr("Exported {size}") if done.written else self.tr("Already there, {size}, the same bytes")
        links = (("reopen", self.tr("Open it")), ("folder", self.tr("Show in folder")))
        self.notice.say("info", said.format(size=size), done.path.name, links)
        self.notice.text.setToolTip(str(done.path))
        self.exported.emit(done.path)

    def _follow(self, key: str) -> None:
        if key == "as":
            self.export_as()
        elif key == "reopen" and self._last is not None:
            self.reopen_wanted.emit(self._last)
        elif key == "folder" and self._last is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._last.parent)))

    def _dress(self) -> None:
        self.button.setObjectName("Primary")
        self.button.setProperty("primary", True)
        self.button.setAccessibleName(self.tr("Export QMD"))
        self.button.setToolTip(
            self.tr("Write the bytes that were measured beside the clip's own file. With Shift: ask for a name.")
        )
        self.more.setAccessibleName(self.tr("More ways to export"))
        self.more.setToolTip(self.tr("More ways to export"))
        menu = QMenu(self.more)
        menu.addAction(self.tr("Export QMD as…"), self.export_as)
        self.more.setMenu(menu)
        self.button.clicked.connect(self._clicked)
        self.notice.link.connect(self._follow)

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.button, 1)
        row.addWidget(self.more)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addLayout(row)
        layout.addWidget(self.notice)


def ask_for_path(parent: QWidget, suggested: Path) -> Path | None:
    """Ask for the file to write, which may exist: the dialog then has asked. None where the user changed their mind."""
    title = QGuiApplication.translate("ExportBar", "Export QMD")
    name, _ = QFileDialog.getSaveFileName(parent, title, str(suggested), "QMD (*.qmd)")
    if not name:
        return None
    path = Path(name)
    return path if path.suffix else path.with_suffix(".qmd")
