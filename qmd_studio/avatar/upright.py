"""Which way up a motion is: some files hold figures that stand along Z, or hang upside down from -Y."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_plan import REFERENCE_STATURE_M, BodyPlan, plan_body
from qmd_studio.avatar.bone_body_stance import rotation_between
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion

_Y = np.array([0.0, 1.0, 0.0])
_LEANS_AT_MOST = 0.7


_SAMPLES = 24


def upright(motion: Motion) -> FloatArray:
    """Return the rotation (4, 4) that shows a motion standing along +Y, for the picture only.

    It is the identity unless the figure rests along another axis of its file and, in the first frame, stands along that
    very axis: a handstand in a file that has Y up stays one. Where it rests along Y, it must stand along another axis
    all through, with its feet at that axis' zero: a figure that lies on the floor does not.
    """
    plan = plan_body(motion.skeleton)
    axis = _stands_through(plan, motion) if plan.up @ _Y > 0.9 else _rests_along(plan, motion)
    result = np.eye(4)
    if axis is not None:
        result[:3, :3] = rotation_between(axis, _Y)
    return result


def _rests_along(plan: BodyPlan, motion: Motion) -> FloatArray | None:
    if np.abs(plan.up).max() < 0.999:
        return None
    stands = _stance(plan, world_from_joint(motion.skeleton, motion.X[:1])[0])
    return plan.up if stands is not None and stands @ plan.up > _LEANS_AT_MOST else None


def _stands_through(plan: BodyPlan, motion: Motion) -> FloatArray | None:
    """Return the axis other than Y along which a figure stands in every sampled frame, its feet near that axis' 0."""
    stride = max(1, motion.n_frames // _SAMPLES)
    worlds = world_from_joint(motion.skeleton, motion.X[::stride])
    stances = [stance for stance in (_stance(plan, world) for world in worlds) if stance is not None]
    if not stances or not plan.legs:
        return None
    for axis in np.concatenate([np.eye(3)[[2, 0]], -np.eye(3)[[2, 0]]]):
        heights = worlds[:, :, :3, 3] @ axis
        lowest, pelvis = float(heights.min()), float(np.median(heights[:, plan.pelvis]))
        feet_on_floor = abs(lowest) < 0.15 * REFERENCE_STATURE_M * plan.unit
        if min(s @ axis for s in stances) > _LEANS_AT_MOST and feet_on_floor and pelvis - lowest > abs(lowest):
            return np.asarray(axis, dtype=np.float64)
    return None


def _stance(plan: BodyPlan, world: FloatArray) -> FloatArray | None:
    """The unit vector from the feet, or the pelvis, to the head of a posed figure."""
    if plan.head is None:
        return None
    low = [leg.end for leg in plan.legs] or [plan.pelvis]
    vector = world[plan.head, :3, 3] - world[low, :3, 3].mean(axis=0)
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else None
