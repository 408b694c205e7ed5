"""Parts of the codec lab that say or do nothing by themselves: the page without a motion, and lines between things."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QFrame, QLabel, QVBoxLayout, QWidget


def empty_page(parent: QWidget) -> QWidget:
    """Return what stands in the lab while nothing is open."""
    page = QWidget(parent)
    page.setObjectName("EmptyLab")
    title, text = QLabel(_translated("Nothing to compress yet"), page), QLabel(page)
    title.setStyleSheet("font-weight: 600;")
    text.setText(
        _translated("Open a BVH, AMC, BAP or QMD file, or drop one on the window. Its size as QMD stands here at once.")
    )
    for label in (title, text):
        label.setWordWrap(True)
        label.setAlignment(Qt.AlignmentFlag.AlignHCenter)
    text.setProperty("muted", True)
    layout = QVBoxLayout(page)
    layout.setContentsMargins(24, 24, 24, 24)
    layout.addStretch(1)
    layout.addWidget(title)
    layout.addWidget(text)
    layout.addStretch(2)
    return page


def line(parent: QWidget) -> QFrame:
    """Return a thin line across."""
    result = QFrame(parent)
    result.setFixedHeight(1)
    result.setAutoFillBackground(True)
    result.setBackgroundRole(QPalette.ColorRole.Mid)
    return result


def _translated(text: str) -> str:
    return QCoreApplication.translate("CodecLab", text)
