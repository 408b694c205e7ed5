"""The three notations of a place in a clip: a frame, seconds, and minutes with seconds."""

from __future__ import annotations

import re

from qmd_studio.errors import EditError

_FRAME = re.compile(r"\d{1,9}")
_SECONDS = re.compile(r"(\d{1,7}(?:\.\d{0,6})?|\.\d{1,6})\s*s")
_CLOCK = re.compile(r"(?:(\d{1,3}):)?(\d{1,4}):(\d{1,2}(?:\.\d{0,6})?)")


def parse_frame(text: str, fps: float) -> int:
    """Return the frame that `text` names on a clip of `fps`: "123", "4.1s" (also "4.1 s") or "0:04.1" ("1:02:03.5").

    A decimal comma counts as a point. Raises `EditError` for anything else.
    """
    cleaned = text.strip().lower().replace(",", ".")
    if _FRAME.fullmatch(cleaned):
        return int(cleaned)
    if match := _SECONDS.fullmatch(cleaned):
        return round(float(match[1]) * fps)
    if match := _CLOCK.fullmatch(cleaned):
        hours, minutes, seconds = int(match[1] or 0), int(match[2]), float(match[3])
        return round((hours * 3600 + minutes * 60 + seconds) * fps)
    raise EditError("this is not a place in the clip", wanted="123, 4.1s or 0:04.1", got=repr(text.strip()))


def clock_text(seconds: float) -> str:
    """Return `seconds` ≥ 0 as minutes and seconds with hundredths, "0:04.10"."""
    hundredths = round(seconds * 100)
    return f"{hundredths // 6000}:{hundredths % 6000 // 100:02d}.{hundredths % 100:02d}"
