"""How far each joint's bone is off, frame by frame: what the heat map paints on the body."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.motion.skeleton import Skeleton

HEAT_RANGES_MM = (0.1, 1.0, 10.0, 100.0)
"""The distances that may stand at the hot end of the scale: fixed, so that two pictures can be compared."""


def joint_errors(skeleton: Skeleton, distance_mm: Float32Array, frame: int) -> FloatArray:
    """Return the error of each joint's bone in one frame, (n_joints,) mm, of `distance_mm` (n_frames, n_points).

    A bone counts as far off as the worst of its measured points: its joint, the joints that hang from it and its end
    sites. One that has none takes after its parent; NaN where no ancestor has one either.
    """
    result = np.full(len(skeleton.joints), -np.inf)
    joints, points = _bones(skeleton)
    np.maximum.at(result, joints, distance_mm[frame][points].astype(np.float64))
    for index, joint in enumerate(skeleton.joints):
        if np.isneginf(result[index]):
            result[index] = result[joint.parent] if joint.parent >= 0 else np.nan
    return result


def heat_of(error_mm: FloatArray, range_mm: float) -> FloatArray:
    """Return the place of each error on a scale that ends at `range_mm`: from 0 to 1, NaN where there is no error."""
    return np.clip(error_mm / range_mm, 0.0, 1.0)


@lru_cache(maxsize=16)
def _bones(skeleton: Skeleton) -> tuple[IntArray, IntArray]:
    """Return joints and measured points in pairs: a point is of its own bone and, at a joint, of its parent's."""
    pairs = []
    for point, node in enumerate(skeleton.points):
        if node >= len(skeleton.joints):
            pairs.append((skeleton.end_sites[node - len(skeleton.joints)].joint, point))
            continue
        pairs.append((node, point))
        if skeleton.joints[node].parent >= 0:
            pairs.append((skeleton.joints[node].parent, point))
    table = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return table[:, 0], table[:, 1]
