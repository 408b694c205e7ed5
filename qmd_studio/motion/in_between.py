"""Poses between two frames, for showing a motion at more frames a second than it has."""

from __future__ import annotations

import math

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.skeleton import ColumnKind, Skeleton

JUMP = math.radians(60.0)
"""An angle that changes by more within one frame is no movement: it flips over, as Euler angles do."""


def in_between(skeleton: Skeleton, before: FloatArray, after: FloatArray, share: float) -> FloatArray:
    """Return the row (n_columns,) at `share`, 0 to 1, of the way from `before` to `after`, radians and metres.

    Columns go straight, but those of a joint with an angle that jumps stay as they are `before`.
    """
    step = after - before
    jumps = np.abs(step) > JUMP
    if jumps.any():
        held = {
            c.joint for c, far in zip(skeleton.columns, jumps, strict=True) if far and c.kind is ColumnKind.ROTATION
        }
        step[[column.joint in held for column in skeleton.columns]] = 0.0
    return np.asarray(before + share * step)
