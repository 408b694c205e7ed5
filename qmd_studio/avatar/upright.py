"""Which way up a motion is: some files hold figures that stand along Z, or hang upside down from -Y."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_plan import BodyPlan, plan_body
from qmd_studio.avatar.bone_body_stance import rotation_between
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion

_Y = np.array([0.0, 1.0, 0.0])
_LEANS_AT_MOST = 0.7


def upright(motion: Motion) -> FloatArray:
    """Return the rotation (4, 4) that shows a motion standing along +Y, for the picture only.

    It is the identity unless the figure both rests along another axis of its file and, in the first frame, stands
    along that very axis: a handstand in a file that has Y up stays one.
    """
    plan = plan_body(motion.skeleton)
    result = np.eye(4)
    if plan.up @ _Y > 0.9 or np.abs(plan.up).max() < 0.999:
        return result
    stands = _stance(plan, world_from_joint(motion.skeleton, motion.X[:1])[0])
    if stands is not None and stands @ plan.up > _LEANS_AT_MOST:
        result[:3, :3] = rotation_between(plan.up, _Y)
    return result


def _stance(plan: BodyPlan, world: FloatArray) -> FloatArray | None:
    """The unit vector from the feet, or the pelvis, to the head of a posed figure."""
    if plan.head is None:
        return None
    low = [leg.end for leg in plan.legs] or [plan.pelvis]
    vector = world[plan.head, :3, 3] - world[low, :3, 3].mean(axis=0)
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else None
