"""A small stroke alphabet of the studio's own, so that pictures made without a window can be captioned."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from qmd_studio.arrays import FloatArray

_WIDTH, _HEIGHT, _ADVANCE = 4, 8, 6
_STROKE = 0.42
"""Half the width of a stroke, in the units that the letters are drawn in."""
_STROKES = {
    # Lines through points xy; x from 0 to 4, y from 0, over 2, the foot of most letters, to 8. A dot keeps a corner.
    "A": "0228.42 1434", "B": "0802 08484505 05454202", "C": "474808024243", "D": "0802 08484202",
    "E": "4808.02.42 0535", "F": "4808.02 0535", "G": "474808024245.25", "H": "0802 4842 0545", "I": "1838 2822 1232",
    "J": "48420204", "K": "0802 4805.42", "L": "0802.42", "M": "0208.25.48.42", "N": "0208.42.48", "O": "280802424828",
    "P": "0802 08484404", "Q": "280802424828 2442", "R": "0802 08484505 2542", "S": "4748080545420203",
    "T": "0848 2822", "U": "08024248", "V": "0822.48", "W": "0812.26.32.48", "X": "0842 4802", "Y": "0825.48 2522",
    "Z": "0848.02.42",
    "a": "444606024244 4642", "b": "0802 040646420204", "c": "454606024243", "d": "4842 444606024244",
    "e": "0444.4606024243", "f": "482822 0636", "g": "444606024244 46400001", "h": "0802 04064642", "i": "2622 2828",
    "j": "262000 2828", "k": "0802 4604.42", "l": "2822", "m": "0602 04062622 24264642", "n": "0602 04064642",
    "o": "260602424626", "p": "0600 040646420204", "q": "4640 444606024244", "r": "0602 040646",
    "s": "4546060444420203",
    "t": "282242 0646", "u": "06024244 4642", "v": "0622.46", "w": "0612.25.32.46", "x": "0642 4602",
    "y": "0623 4610", "z": "0646.02.42",
    "0": "280802424828 2525", "1": "0728.22 0242", "2": "0708484502.42", "3": "0708484515 1545420203",
    "4": "3238.04.44",
    "5": "4808.05.45420203", "6": "47480802424505", "7": "0848.12", "8": "280805454828 250502424525",
    "9": "03024248080545",
    ".": "2222", ",": "2211", "-": "1535", "_": "0141", ":": "2525 2222", "/": "0248", "(": "38161432", ")": "18363412",
    "+": "0545 2723", "#": "1812 3832 0646 0444", "=": "0646 0444", "'": "2827", "·": "2525", "…": "0202 2222 4242",
    "[": "3818.12.32", "]": "1838.32.12", " ": "",
}  # fmt: skip
_UNKNOWN = "08.48.42.02.08"


def text_mask(text: str, height: int) -> FloatArray:
    """Return how much of each pixel `text` covers, (height, width) 0 to 1; `height` holds its longest letters."""
    if not text:
        return np.zeros((height, 0))
    return np.concatenate([_letter(letter, height) for letter in text], axis=1)


@lru_cache(maxsize=512)
def _letter(letter: str, height: int) -> FloatArray:
    unit = height / (_HEIGHT + 2)
    width = max(1, round(_ADVANCE * unit))
    x = (np.arange(width) + 0.5) / unit - (_ADVANCE - _WIDTH) / 2
    y = (height - np.arange(height) - 0.5) / unit - 1.0
    places = np.stack(np.meshgrid(x, y), axis=-1)
    away = np.full(places.shape[:2], np.inf)
    for stroke in _STROKES.get(letter, _UNKNOWN).split():
        points = _curve(stroke)
        for a, b in pairwise(points):
            along, off = b - a, places - a
            t = np.clip((off @ along) / max(float(along @ along), 1e-9), 0.0, 1.0)
            away = np.minimum(away, np.linalg.norm(off - t[..., None] * along, axis=-1))
    return np.asarray(np.clip(0.5 + (_STROKE - away) * unit, 0.0, 1.0))


def _curve(stroke: str) -> FloatArray:
    """The points (n, 2) of a stroke, its corners rounded but for those with a dot."""
    words = stroke.replace(".", " .").split()
    points: list[FloatArray] = []
    for word in words:
        digits = word.removeprefix(".")
        if word.startswith("."):
            points.append(points[-1])
        points += [np.array([int(digits[k]), int(digits[k + 1])], dtype=np.float64) for k in range(0, len(digits), 2)]
    line = np.array(points)
    for _ in range(2):
        a, b = line[:-1], line[1:]
        cut = np.stack([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b], axis=1).reshape(-1, 2)
        line = np.concatenate([line[:1], cut, line[-1:]])
    return line
