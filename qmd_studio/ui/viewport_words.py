"""Words over the picture of the viewport: an invitation, a message, or why there is no picture."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter
from PySide6.QtWidgets import QWidget


def paint_words(widget: QWidget, text: str, *, dark: bool, covering: bool) -> None:
    """Paint `text` in a box in the middle of `widget`, on a dark or a light stage; `covering` what is behind it."""
    painter = QPainter(widget)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if covering:
        painter.fillRect(widget.rect(), QColor(34, 37, 43) if dark else QColor(222, 226, 232))
    font = QFont(widget.font())
    font.setPointSizeF(font.pointSizeF() * 1.25)
    painter.setFont(font)
    area = QRectF(widget.rect()).adjusted(24, 24, -24, -24)
    flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    box = QFontMetricsF(font).boundingRect(area, int(flags), text).adjusted(-20, -12, 20, 12)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(20, 22, 26, 150) if dark else QColor(255, 255, 255, 190))
    painter.drawRoundedRect(box, 8, 8)
    painter.setPen(QColor(226, 230, 236) if dark else QColor(40, 46, 56))
    painter.drawText(area, int(flags), text)
    painter.end()
