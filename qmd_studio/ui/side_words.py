"""What a side is, in a few words."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.project.state import Side
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction

_ENCODERS = {
    Encoder.CLOSED: "closed loop",
    Encoder.PLAIN: "plain loop",
    Encoder.PAPER: "the paper's",
    Encoder.BOUNDED: "bounded",
}


def settings_words(settings: EncodeSettings | None) -> str:
    """Return settings as they are said: "FDF 6, b 8, n_d 120, closed loop, every 2 frames"; "Original" for none."""
    if settings is None:
        return _translated("Original")
    words = [short_words(settings)]
    if settings.paper is not None:
        words.append(encoder_words(settings))
    if settings.compact is not None and settings.compact.segment:
        words.append(_translated("segments of {n}").format(n=settings.compact.segment))
    return ", ".join((*words, *_left_out(settings.reduction)))


def short_words(settings: EncodeSettings | None) -> str:
    """Return what tells settings apart at a glance: "FDF 6, b 8", "Compact, mean 0.5 mm", "Within 1 mm"."""
    if settings is None:
        return _translated("Original")
    coding = settings.coding
    if isinstance(coding, CompactSettings):
        if coding.mean_error_mm is not None:
            return _translated("Compact, mean {mm:g} mm").format(mm=coding.mean_error_mm)
        return _translated("Compact, within {mm:g} mm").format(mm=coding.max_error_mm)
    return _paper_words(coding)


def button_words(settings: EncodeSettings | None) -> str:
    """Return the short words, with what is left out by the knobs' symbols: "FDF 6, b 8, K 2, L 5"."""
    if settings is None:
        return short_words(None)
    reduction, words = settings.reduction, [short_words(settings)]
    if reduction.fps_divisor > 1:
        words.append(f"K {reduction.fps_divisor}")
    if reduction.max_level < MAX_LEVEL:
        words.append(f"L {reduction.max_level}")
    if reduction.max_loa is not None:
        words.append(f"LOA {reduction.max_loa}")
    return ", ".join(words)


def encoder_words(settings: EncodeSettings) -> str:
    """Return what the encoder of `settings` is called."""
    if settings.paper is None:
        return _translated("compact profile")
    return _translated(_ENCODERS.get(settings.paper.encoder, str(settings.paper.encoder)))


def side_words(side: Side, settings: EncodeSettings | None) -> str:
    """Return the side and what it is, short enough to stand in the picture: "A  FDF 6, b 8, K 2, closed loop"."""
    words = [button_words(settings)]
    if settings is not None and settings.size_is_known:
        words.append(encoder_words(settings))
    return f"{side.upper()}  {', '.join(words)}"


def _paper_words(settings: QmdSettings) -> str:
    if settings.encoder is Encoder.BOUNDED:
        return _translated("Within {mm:g} mm").format(mm=settings.max_error_mm)
    segment = f", n_d {settings.segment}" if settings.segment else ""
    return f"FDF {settings.fdf}, b {settings.bits}{segment}"


def _left_out(reduction: Reduction) -> list[str]:
    words = []
    if reduction.fps_divisor > 1:
        words.append(_translated("every {k} frames").format(k=reduction.fps_divisor))
    if reduction.max_level < MAX_LEVEL:
        words.append(_translated("level {level}").format(level=reduction.max_level))
    if reduction.max_loa is not None:
        words.append(_translated("LOA {level}").format(level=reduction.max_loa))
    return words


def _translated(text: str) -> str:
    return QCoreApplication.translate("SideWords", text)
