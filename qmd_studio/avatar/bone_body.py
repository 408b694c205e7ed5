"""A body made from nothing but a skeleton's bones: what any motion wears until it is given a better one."""

from __future__ import annotations

import numpy as np

from qmd_studio.avatar.bone_body_shapes import ShapeList, capsule
from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.skeleton import Skeleton

SKIN = np.array([0.60, 0.57, 0.53])


def bone_body(skeleton: Skeleton) -> Body:
    """Return a solid body for `skeleton`, bound at its rest pose."""
    rest = rest_values(skeleton)[None]
    nodes = node_positions(skeleton, rest)[0]
    shapes = ShapeList()
    size = float(np.ptp(nodes, axis=0).max()) or 1.0
    parents = [j.parent for j in skeleton.joints] + [s.joint for s in skeleton.end_sites]
    for node, parent in enumerate(parents):
        length = float(np.linalg.norm(nodes[node] - nodes[parent])) if parent >= 0 else 0.0
        if length > 1e-4 * size:
            radius = float(np.clip(0.18 * length, 0.004 * size, 0.04 * size))
            shapes.add(capsule(nodes[parent], nodes[node], (radius, 0.8 * radius), (6, 12)), SKIN, parent)
    return Body(skeleton.name, skeleton, shapes.surface(), world_from_joint(skeleton, rest)[0])
