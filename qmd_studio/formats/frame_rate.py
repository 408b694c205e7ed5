"""Frame times as decimal text: the rate that a rounded time stands for, and the text that gives a rate back."""

from __future__ import annotations

import math
import re

_MANTISSA = re.compile(r"[+-]?[0-9]*\.?([0-9]*)(?:[eE]([+-]?[0-9]+))?")
_FEWEST_DIGITS, _MOST_DIGITS = 9, 17


def rate_from_frame_time(text: str) -> float:
    """Return the frames a second of a frame time in seconds, as it stands in a file ("0.0083333").

    A time that is a whole rate's, rounded to the digits given, means that rate: 0.0083333 is 120 frames a second.
    Where two whole rates would round to it ("0.03"), it is taken literally. Raises `ValueError` if not positive.
    """
    seconds = float(text)
    if not 0 < seconds < math.inf or math.isinf(1 / seconds):
        raise ValueError(text)
    whole = round(1 / seconds)
    slack = _half_last_digit(text)
    near = [rate for rate in (whole - 1, whole, whole + 1) if rate > 0 and abs(1 / rate - seconds) <= slack]
    return float(whole) if near == [whole] else 1 / seconds


def frame_time_text(fps: float) -> str:
    """Return the shortest decimal text, of 9 digits or more, that `rate_from_frame_time` reads as `fps`.

    Where none does to the last bit, the text of the nearest rate that has one.
    """
    return _exact_text(fps) or _exact_text(rate_from_frame_time(repr(1 / fps))) or repr(1 / fps)


def _exact_text(fps: float) -> str | None:
    for seconds in (1 / fps, math.nextafter(1 / fps, 0), math.nextafter(1 / fps, math.inf)):
        for digits in range(_FEWEST_DIGITS, _MOST_DIGITS + 1):
            text = f"{seconds:.{digits}g}"
            if rate_from_frame_time(text) == fps:
                return text
    return None


def _half_last_digit(text: str) -> float:
    """Return half a unit of the last digit of a decimal number."""
    found = _MANTISSA.fullmatch(text)
    if found is None:
        return 0.0
    exponent = int(found.group(2) or 0) if len(found.group(2) or "") < 6 else 0
    decimals = len(found.group(1)) - exponent
    return 0.5 * 10.0**-decimals if -300 < decimals < 300 else 0.0
