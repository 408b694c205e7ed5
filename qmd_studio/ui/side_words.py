"""What a side is, in a few words."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.project.state import Side

_ENCODERS = {
    Encoder.CLOSED: "closed loop",
    Encoder.PLAIN: "plain loop",
    Encoder.PAPER: "the paper's",
    Encoder.BOUNDED: "bounded",
}


def settings_words(settings: QmdSettings | None) -> str:
    """Return settings as they are said: "FDF 6, b 8, n_d 120, closed loop"; "Original" for none."""
    if settings is None:
        return _translated("Original")
    segment = f", n_d {settings.segment}" if settings.segment else ""
    return f"FDF {settings.fdf}, b {settings.bits}{segment}, {encoder_words(settings)}"


def encoder_words(settings: QmdSettings) -> str:
    """Return what the encoder of `settings` is called."""
    return _translated(_ENCODERS.get(settings.encoder, str(settings.encoder)))


def side_words(side: Side, settings: QmdSettings | None) -> str:
    """Return the side and what it is: "A  Original"."""
    return f"{side.upper()}  {settings_words(settings)}"


def _translated(text: str) -> str:
    return QCoreApplication.translate("SideWords", text)
