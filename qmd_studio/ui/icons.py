"""The studio's own icons: SVG strokes in the colour of the text, drawn anew for each theme, crisp at any scale."""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtCore import QByteArray, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QIcon, QPainter, QPalette, QPixmap
from PySide6.QtSvg import QSvgRenderer

from qmd_studio import assets

_SIZES = (16, 20, 32, 48, 64)


def icon(name: str) -> QIcon:
    """Return the icon `name` of resources/icons in the application's present text colours."""
    palette = QGuiApplication.palette()
    normal = palette.color(QPalette.ColorGroup.Active, QPalette.ColorRole.ButtonText)
    disabled = palette.color(QPalette.ColorGroup.Disabled, QPalette.ColorRole.ButtonText)
    return tinted_icon(name, normal.name(), disabled.name(QColor.NameFormat.HexArgb))


@lru_cache(maxsize=256)
def tinted_icon(name: str, colour: str, disabled: str | None = None) -> QIcon:
    """Return the icon `name` drawn in `colour` (#rrggbb), and in `disabled` where it cannot be used."""
    svg = assets.resource("icons", f"{name}.svg").read_text(encoding="utf-8")
    result = QIcon()
    for mode, ink in ((QIcon.Mode.Normal, colour), (QIcon.Mode.Disabled, disabled or colour)):
        tint = QColor(ink)
        renderer = QSvgRenderer(QByteArray(svg.replace("currentColor", tint.name()).encode()))
        for size in _SIZES:
            result.addPixmap(_drawn(renderer, size, tint.alphaF()), mode)
    return result


def application_icon() -> QIcon:
    """Return the icon of the studio itself."""
    return QIcon(str(assets.resource("icons", "qmd-studio.svg")))


def _drawn(renderer: QSvgRenderer, size: int, opacity: float) -> QPixmap:
    pixmap = QPixmap(QSize(size, size))
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setOpacity(opacity)
    renderer.render(painter)
    painter.end()
    return pixmap
