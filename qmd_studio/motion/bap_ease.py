"""How the default body stands when nothing moves it: at ease, not as stiff as with all parameters at zero."""

from __future__ import annotations

import math

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.bap import bap_skeleton, bap_table, column_of
from qmd_studio.motion.kinematics import rest_values

_FINGERS = ("index", "middle", "ring", "pinky")
_LEFT_DEG = {
    "shoulder_abduct": 7.0,
    "shoulder_flexion": 3.0,
    "elbow_flexion": 14.0,
    "thumb1_flexion": -36.0,
    "thumb1_pivot": -14.0,
    "thumb2_flexion": -12.0,
    "thumb3_flexion": -10.0,
    **{
        f"{f}{k}_flexion": -(a + 3.0 * place)
        for place, f in enumerate(_FINGERS)
        for k, a in ((1, 14), (2, 22), (3, 12))
    },
}
"""The left side's angles; the right side's mirror them."""
_SIDEWAYS = ("shoulder_abduct", "thumb1_pivot")
"""Parameters whose axis is the same on both sides, so that a mirror image has them the other way."""


def at_ease() -> FloatArray:
    """Return the row (n_columns,) of `bap_skeleton` in radians and metres that lets the body stand at ease."""
    row = rest_values(bap_skeleton())
    number = {parameter.name: parameter.id for parameter in bap_table()}
    for name, degrees in _LEFT_DEG.items():
        row[column_of(number[f"l_{name}"])] = math.radians(degrees)
        row[column_of(number[f"r_{name}"])] = math.radians(-degrees if name in _SIDEWAYS else degrees)
    return row
