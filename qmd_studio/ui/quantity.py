"""Quantities in words: the same digits everywhere, few enough to read at a glance."""

from __future__ import annotations

from PySide6.QtGui import QFont

KB = 1024
"""A kilobyte of the studio, as in the paper's tables."""


def kilobytes(n_bytes: int) -> str:
    """Return bytes in KB of 1024: "28.0 KB"; in MB from 1024 KB on."""
    kb = n_bytes / KB
    return f"{kb:.1f} KB" if kb < KB else f"{kb / KB:.2f} MB"


def exact_bytes(n_bytes: int) -> str:
    """Return bytes one by one, thousands apart: "28,645 bytes"."""
    return f"{n_bytes:,} bytes"


def millimetres(value_mm: float) -> str:
    """Return a length with three digits that count, "0.112 mm", "41.3 mm"; metres from a metre on."""
    if value_mm >= 1000.0:
        return f"{significant(value_mm / 1000.0)} m"
    return f"{significant(value_mm)} mm"


def significant(value: float) -> str:
    """Return a value with three digits that count, four decimals at most; below 0.0001 it is "0" or "< 0.0001"."""
    if value == 0.0:
        return "0"
    if abs(value) < 1e-4:
        return "< 0.0001"
    places = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2 if abs(value) >= 1 else 3
    return f"{value:.{places if abs(value) >= 0.1 else 4}f}"


def percent(share: float) -> str:
    """Return a share of 1 in per cent with two digits that count: "0.34 %", "21 %", "310 %"."""
    value = 100.0 * share
    if 0.0 < value < 0.01:
        return "< 0.01 %"
    return f"{value:.0f} %" if value >= 9.95 else f"{value:.1f} %" if value >= 0.995 else f"{value:.2g} %"


def frame_rate(fps: float) -> str:
    """Return a frame rate with as many digits as it takes: "120 fps", "29.97 fps"."""
    return f"{fps:.4g} fps"


def against(value: float | None, other: float | None) -> str:
    """Return how a cost compares with another one, in a few characters: "▼ 65 %", "▼ 29×", "▲ 12 %", "=".

    Nothing is said where either is unknown or zero: no ratio says how much less nothing is.
    """
    if not value or not other:
        return ""
    ratio = value / other
    if abs(ratio - 1.0) < 0.005:
        return "="
    if ratio < 1.0:
        return f"▼ {100.0 * (1.0 - ratio):.0f} %" if ratio > 0.1 else f"▼ {significant_ratio(1.0 / ratio)}×"
    return f"▲ {100.0 * (ratio - 1.0):.0f} %" if ratio < 2.0 else f"▲ {significant_ratio(ratio)}×"


def significant_ratio(ratio: float) -> str:
    """Return a ratio above 1 with two or three digits that count."""
    return f"{ratio:.1f}" if ratio < 10.0 else f"{ratio:,.0f}"


def tabular(font: QFont, *, scale: float = 1.0, bold: bool = False) -> QFont:
    """Return `font` with figures of one width, so that numbers do not dance, and `scale` times its size."""
    result = QFont(font)
    if font.pointSizeF() > 0:
        result.setPointSizeF(font.pointSizeF() * scale)
    else:
        result.setPixelSize(round(font.pixelSize() * scale))
    if hasattr(QFont, "Tag"):
        result.setFeature(QFont.Tag("tnum"), 1)
    if bold:
        result.setWeight(QFont.Weight.DemiBold)
    return result
