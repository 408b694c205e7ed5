"""Words over the picture of the viewport: an invitation, a message, why there is no picture, a joint's name."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter
from PySide6.QtWidgets import QWidget

_PAD_X, _PAD_Y, _AWAY = 8.0, 4.0, 14.0


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


def paint_label(widget: QWidget, lines: tuple[str, ...], at: QPointF, *, dark: bool) -> None:
    """Paint a name, and fainter below it what else there is to say, in a box beside `at` that stays within `widget`."""
    painter = QPainter(widget)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    bold = QFont(widget.font())
    bold.setWeight(QFont.Weight.DemiBold)
    fonts = [bold, *[widget.font()] * (len(lines) - 1)]
    metrics = [QFontMetricsF(font) for font in fonts]
    width = max(m.horizontalAdvance(line) for m, line in zip(metrics, lines, strict=True)) + 2 * _PAD_X
    height = sum(m.height() for m in metrics) + 2 * _PAD_Y
    left = at.x() + _AWAY if at.x() + _AWAY + width < widget.width() - 4 else at.x() - _AWAY - width
    top = min(max(at.y() + _AWAY, 4.0), widget.height() - height - 4)
    box = QRectF(max(left, 4.0), top, width, height)
    painter.setPen(QColor(255, 255, 255, 40) if dark else QColor(20, 30, 45, 45))
    painter.setBrush(QColor(24, 27, 32, 225) if dark else QColor(255, 255, 255, 235))
    painter.drawRoundedRect(box, 5, 5)
    baseline = box.top() + _PAD_Y
    for place, (font, metric, line) in enumerate(zip(fonts, metrics, lines, strict=True)):
        strength = 255 if place == 0 else 170
        painter.setFont(font)
        painter.setPen(QColor(236, 239, 244, strength) if dark else QColor(28, 34, 44, strength))
        painter.drawText(QPointF(box.left() + _PAD_X, baseline + metric.ascent()), line)
        baseline += metric.height()
    painter.end()
