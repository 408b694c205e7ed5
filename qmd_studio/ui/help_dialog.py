"""The help: the pages of resources/help, their pictures and the links between them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from PySide6.QtCore import QCoreApplication, Qt, QUrl
from PySide6.QtGui import (
    QDesktopServices,
    QImage,
    QPalette,
    QTextCursor,
    QTextFormat,
    QTextFrame,
    QTextFrameFormat,
    QTextListFormat,
    QTextTable,
)
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QListWidget, QSplitter, QTextBrowser, QVBoxLayout, QWidget

from qmd_studio import assets

_PICTURE_PX = 600
"""Wider pictures are shown this wide."""


class HelpDialog(QDialog):
    """The pages of resources/help: their titles on the left, the chosen one on the right."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(_tr("Help"))
        self.resize(960, 680)
        self._pages = sorted(assets.resource("help").glob("*.md"), key=lambda path: (path.stem != "index", path.stem))
        self.contents, self.page = QListWidget(), HelpPage()
        self.contents.setAccessibleName(_tr("Contents"))
        self.contents.setToolTip(_tr("The pages of the help"))
        self.page.setAccessibleName(_tr("Page"))
        self.page.anchorClicked.connect(self._follow)
        split = QSplitter()
        split.addWidget(self.contents)
        split.addWidget(self.page)
        split.setStretchFactor(1, 1)
        split.setSizes([220, 740])
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(split)
        column.addWidget(buttons)
        for path in self._pages:
            self.contents.addItem(_title_of(path))
        self.contents.currentRowChanged.connect(lambda row: self.page.show_page(self._pages[row]))
        self.contents.setCurrentRow(0)
        self.contents.setFocus()

    def _follow(self, url: QUrl) -> None:
        for row, path in enumerate(self._pages):
            if path.name == url.fileName():
                self.contents.setCurrentRow(row)
                return
        if url.scheme() in ("http", "https"):
            QDesktopServices.openUrl(url)


class HelpPage(QTextBrowser):
    """One page of Markdown, dressed as the rest of the window is."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setOpenLinks(False)
        self.document().setDocumentMargin(20)
        self._folder = Path()

    def show_page(self, path: Path) -> None:
        """Show the file `path`; pictures are looked for beside it."""
        self._folder = path.parent
        self.setMarkdown(path.read_text(encoding="utf-8"))
        for table in _tables(self.document().rootFrame()):
            self._dress_table(table)
        self._dress_lists()
        self.moveCursor(QTextCursor.MoveOperation.Start)

    def loadResource(self, kind: int, url: QUrl) -> object:
        """Return a picture that stands beside the page, sharp and no wider than the page."""
        if kind != 2 or url.scheme() not in ("", "file"):  # 2: QTextDocument.ImageResource
            return super().loadResource(kind, url)
        image = QImage(str(self._folder / url.fileName()))
        ratio = self.devicePixelRatioF()
        width = round(min(image.width(), _PICTURE_PX * ratio))
        if not image.isNull() and width < image.width():
            image = image.scaledToWidth(width, Qt.TransformationMode.SmoothTransformation)
        image.setDevicePixelRatio(ratio)
        return image

    def _dress_table(self, table: QTextTable) -> None:
        style = table.format()
        style.setBorder(1)
        style.setBorderCollapse(True)
        style.setBorderStyle(QTextFrameFormat.BorderStyle.BorderStyle_Solid)
        style.setBorderBrush(self.palette().color(QPalette.ColorRole.Mid))
        style.setCellPadding(6)
        style.setTopMargin(8)
        style.setBottomMargin(12)
        table.setFormat(style)

    def _dress_lists(self) -> None:
        block = self.document().begin()
        while block.isValid():
            items = block.textList()
            if items is not None and items.format().style() == QTextListFormat.Style.ListCircle:
                style = items.format()
                style.setStyle(QTextListFormat.Style.ListDisc)
                items.setFormat(style)
            block = block.next()


def _tables(frame: QTextFrame) -> Iterator[QTextTable]:
    for child in frame.childFrames():
        if child.format().objectType() == QTextFormat.ObjectTypes.TableObject.value or isinstance(child, QTextTable):
            yield child
        yield from _tables(child)


def _title_of(path: Path) -> str:
    first = path.read_text(encoding="utf-8").lstrip().partition("\n")[0]
    return first.lstrip("# ").strip() or path.stem


def _tr(text: str) -> str:
    return QCoreApplication.translate("Help", text)
