"""Light and dark: the studio's own palettes on Fusion, following the system unless the user says otherwise."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

from qmd_studio import assets


class Theme(StrEnum):
    """What the user may choose."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


@dataclass(frozen=True, slots=True)
class Colours:
    """The named colours of one theme, as #rrggbb. Text on its ground has a contrast of at least 4.5 to 1."""

    window: str
    base: str
    raised: str
    text: str
    muted: str
    line: str
    accent: str
    on_accent: str
    focus: str
    error: str
    error_ground: str
    warning: str
    warning_ground: str
    info: str
    info_ground: str


LIGHT = Colours(
    window="#f2f3f5",
    base="#ffffff",
    raised="#fafbfc",
    text="#1a1d21",
    muted="#59616c",
    line="#cdd2d9",
    accent="#1b66b8",
    on_accent="#ffffff",
    focus="#2f7fd6",
    error="#a5201c",
    error_ground="#fdeceb",
    warning="#7a4d00",
    warning_ground="#fff4dc",
    info="#14548f",
    info_ground="#e8f2fc",
)
DARK = Colours(
    window="#202328",
    base="#17191d",
    raised="#2a2e35",
    text="#e8eaed",
    muted="#a2aab5",
    line="#3b414a",
    accent="#3f8fe0",
    on_accent="#0b0d10",
    focus="#6db1f5",
    error="#ff9d96",
    error_ground="#3d2223",
    warning="#ffce7a",
    warning_ground="#3a2f1a",
    info="#9fcbf7",
    info_ground="#1d2f42",
)


class ThemeSwitch(QObject):
    """Gives the application its palette and style sheet; `changed` says that the colours are others now."""

    changed = Signal()

    def __init__(self, app: QApplication, theme: Theme = Theme.SYSTEM) -> None:
        super().__init__(app)
        self._app, self._theme = app, theme
        app.setStyle("Fusion")
        app.styleHints().colorSchemeChanged.connect(self._follow_system)
        self._apply()

    @property
    def theme(self) -> Theme:
        """What the user chose."""
        return self._theme

    @property
    def dark(self) -> bool:
        """Whether the dark colours are shown."""
        if self._theme is Theme.SYSTEM:
            return self._app.styleHints().colorScheme() == Qt.ColorScheme.Dark
        return self._theme is Theme.DARK

    @property
    def colours(self) -> Colours:
        """The colours that are shown."""
        return DARK if self.dark else LIGHT

    def choose(self, theme: Theme) -> None:
        """Show `theme` from now on."""
        self._theme = theme
        self._apply()

    def _follow_system(self) -> None:
        if self._theme is Theme.SYSTEM:
            self._apply()

    def _apply(self) -> None:
        self._app.setPalette(palette_of(self.colours))
        self._app.setStyleSheet(style_sheet(self.colours))
        self.changed.emit()


def palette_of(colours: Colours) -> QPalette:
    """Return the palette that Fusion and the studio's own widgets paint with; `Mid` is the colour of thin lines."""
    role = QPalette.ColorRole
    palette = QPalette(QColor(colours.raised), QColor(colours.window))
    for roles, colour in (
        ((role.Window, role.Dark), colours.window),
        ((role.Base,), colours.base),
        ((role.Button, role.AlternateBase, role.ToolTipBase, role.Light), colours.raised),
        ((role.WindowText, role.Text, role.ButtonText, role.ToolTipText, role.BrightText), colours.text),
        ((role.Mid, role.Midlight), colours.line),
        ((role.Highlight, role.Accent, role.Link), colours.accent),
        ((role.HighlightedText,), colours.on_accent),
        ((role.PlaceholderText,), colours.muted),
    ):
        for each in roles:
            palette.setColor(each, QColor(colour))
    faint = QColor(colours.muted)
    faint.setAlphaF(0.55)
    for each in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, each, faint)
    return palette


def style_sheet(colours: Colours) -> str:
    """Return the style sheet with every `@name` replaced by that colour."""
    text = assets.resource("styles", "studio.qss").read_text(encoding="utf-8")
    for name, colour in sorted(asdict(colours).items(), key=lambda item: -len(item[0])):
        text = text.replace(f"@{name}", colour)
    return text
