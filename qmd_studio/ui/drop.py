"""Files dragged over the window and dropped on it."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QMimeData, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QWidget


def dropped_files(data: QMimeData) -> list[Path]:
    """Return the local files of a drag, in its order; folders and things that are not files are left out."""
    return [path for path in _local(data) if path.is_file()]


def dropped_folders(data: QMimeData) -> list[Path]:
    """Return the local folders of a drag, which are not opened."""
    return [path for path in _local(data) if path.is_dir()]


class DropHighlight(QWidget):
    """Lies over the picture while files are dragged over the window, and says what dropping them does."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.words = ""
        self.hide()

    def invite(self, paths: list[Path]) -> None:
        """Show that `paths` would be opened."""
        name = paths[0].name if len(paths) == 1 else self.tr("{n} files").format(n=len(paths))
        self.words = self.tr("Drop to open {name}").format(name=name)
        self.show()
        self.raise_()
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        accent = self.palette().color(QPalette.ColorRole.Accent)
        wash = QColor(accent)
        wash.setAlphaF(0.16)
        painter.setBrush(wash)
        painter.setPen(QPen(accent, 2.0))
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(9, 9, -9, -9), 8, 8)
        font = QFont(self.font())
        font.setPointSizeF(font.pointSizeF() * 1.25)
        font.setWeight(QFont.Weight.DemiBold)
        painter.setFont(font)
        words = painter.fontMetrics().elidedText(self.words, Qt.TextElideMode.ElideMiddle, max(self.width() - 80, 40))
        box = QRectF(painter.fontMetrics().boundingRect(words)).adjusted(-20, -12, 20, 12)
        box.moveCenter(QRectF(self.rect()).center())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(accent)
        painter.drawRoundedRect(box, 8, 8)
        painter.setPen(self.palette().color(QPalette.ColorRole.HighlightedText))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, words)
        painter.end()


def _local(data: QMimeData) -> list[Path]:
    return [Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile()]
