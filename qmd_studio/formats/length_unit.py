"""Which length unit a file without one was made in, guessed from how tall its figure stands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from qmd_studio.motion.kinematics import node_positions, rest_values
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import Skeleton

UNITS: tuple[tuple[str, float], ...] = (
    ("metre", 1.0),
    ("centimetre", 0.01),
    ("inch", 0.0254),
    ("ASF unit (1/0.45 inch)", ASF_UNIT_M),
    ("decimetre", 0.1),
    ("millimetre", 0.001),
    ("foot", 0.3048),
)
USUAL_STATURE_M = 1.7
"""The stature that a guess comes nearest to; people from a child of 1 m to 2.2 m keep clear of the next unit."""


def stature(skeleton: Skeleton) -> float:
    """Return how tall the rest pose is, in the skeleton's lengths: its larger extent along y and z (either is up)."""
    points = node_positions(skeleton, rest_values(skeleton)[None])[0]
    return float(np.ptp(points, axis=0)[1:].max())


def with_guessed_unit(skeleton: Skeleton, metres_per_unit: float | None) -> tuple[Skeleton, str]:
    """Return `skeleton`, given in file units with `metres_per_unit` 1, in metres, and a sentence on its unit.

    The unit is `metres_per_unit` if that is given, else the one of `UNITS` that brings the rest pose nearest to a
    person's stature; a figure without extent is taken as metres.
    """
    height = stature(skeleton)
    if metres_per_unit is not None:
        note = f"length unit set to {metres_per_unit:g} m: the rest pose is {height * metres_per_unit:.2f} m tall"
        return _in_metres(skeleton, metres_per_unit), note
    if not 0 < height < math.inf:
        return skeleton, "length unit taken as metre: the rest pose has no height to guess it from"
    name, unit = min(UNITS, key=lambda named: abs(math.log(height * named[1] / USUAL_STATURE_M)))
    note = f"length unit guessed from the stature: {name}, {unit:g} m (the rest pose is {height * unit:.2f} m tall)"
    return _in_metres(skeleton, unit), note


def _in_metres(skeleton: Skeleton, unit: float) -> Skeleton:
    return replace(skeleton.scaled(unit), metres_per_unit=unit)
