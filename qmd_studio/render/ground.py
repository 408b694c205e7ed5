"""How high the ground lies under a motion: at zero, where files have it, unless the figure stands elsewhere."""

from __future__ import annotations

import numpy as np

from qmd_studio.avatar.fit import Fit
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.render.scene import Actor, posed_extremes

GROUND_TOLERANCE_M = 0.15
"""Feet this near to zero stand on it: they may dip below, or the figure may jump."""
_SAMPLES = 60


def ground_height(motion: Motion, fit: Fit) -> float:
    """Return the height in metres of the ground under `motion`, worn as `fit` has it.

    It is 0 where the lowest point of the motion is near it; otherwise, as in files whose root rests at the origin, it
    is that lowest point.
    """
    stride = max(1, motion.n_frames // _SAMPLES)
    worlds = fit.pose(world_from_joint(motion.skeleton, motion.X[::stride]))
    lowest_frame = int(np.argmin(worlds[:, :, 1, 3].min(axis=1)))
    lowest = float(posed_extremes(Actor(fit.body, worlds[lowest_frame]))[:, 1].min())
    return lowest if abs(lowest) > GROUND_TOLERANCE_M else 0.0
