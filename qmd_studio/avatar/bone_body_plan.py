"""What each joint of a skeleton is, for its body: head, spine, arms, legs; by name where known, by shape otherwise."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_stance import straighten_feet, straighten_trunk
from qmd_studio.motion.joint_names import Limb, plain_names
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.limbs import find_limbs, node_tree
from qmd_studio.motion.skeleton import Skeleton

REFERENCE_STATURE_M = 1.75
_THUMB = re.compile(r"thumb|carpometacarpal_?1|pollex|^finger1|thb")


@dataclass(frozen=True, slots=True, eq=False)
class BodyPlan:
    """A skeleton as its body is bound, and what its joints are.

    `nodes` (n_nodes, 3) metres and `bind` (n_joints, 4, 4): the rest pose, straightened where no one could stand so.
    `parents` of all nodes; `children` of each joint (nodes). `up`, `left` and `forward` are unit vectors of the figure,
    `unit` is its stature over 1.75 m. `spine` runs from the pelvis to below the head.
    """

    skeleton: Skeleton
    nodes: FloatArray
    bind: FloatArray
    parents: tuple[int, ...]
    children: tuple[tuple[int, ...], ...]
    up: FloatArray
    left: FloatArray
    forward: FloatArray
    unit: float
    pelvis: int
    spine: tuple[int, ...]
    head: int | None
    arms: tuple[Limb, ...]
    legs: tuple[Limb, ...]

    def below(self, joint: int) -> tuple[int, ...]:
        """Return every node that hangs from `joint`, without it."""
        found: list[int] = []
        todo = list(self.children[joint])
        while todo:
            node = todo.pop(0)
            found.append(node)
            todo += self.children[node] if node < len(self.children) else ()
        return tuple(found)

    def chain(self, top: int, node: int) -> tuple[int, ...]:
        """Return the nodes from `top` down to `node`, both counted."""
        path = [node]
        while path[-1] != top:
            path.append(self.parents[path[-1]])
        return tuple(path[::-1])

    def is_thumb(self, node: int) -> bool:
        """Whether a node's name, or its parent's where it is an end site, is a thumb's."""
        joint = node if node < len(self.children) else self.parents[node]
        return bool(_THUMB.search(plain_names(self.skeleton)[joint][0]))


def plan_body(skeleton: Skeleton) -> BodyPlan:
    """Return what the joints of `skeleton` are. Whatever is not found is left out; nothing is refused."""
    rest = rest_values(skeleton)[None]
    nodes = node_positions(skeleton, rest)[0]
    parents, children = node_tree(skeleton)
    found = find_limbs(skeleton, nodes)
    head, arms, legs, pelvis, spine = found.head, found.arms, found.legs, found.pelvis, found.spine
    bind = world_from_joint(skeleton, rest)[0]
    straighten_trunk(nodes, bind, children, (pelvis, spine, head), legs)
    up, left = _axes(nodes, head, arms, legs)
    straighten_feet(nodes, bind, children, legs, (up, np.cross(left, up)))
    unit = _stature(nodes, head, arms, legs) / REFERENCE_STATURE_M
    return BodyPlan(
        skeleton=skeleton,
        nodes=nodes,
        parents=parents,
        children=children,
        bind=bind,
        up=up,
        left=left,
        forward=np.cross(left, up),
        unit=unit,
        pelvis=pelvis,
        spine=spine,
        head=head,
        arms=arms,
        legs=legs,
    )


def _axes(
    nodes: FloatArray, head: int | None, arms: tuple[Limb, ...], legs: tuple[Limb, ...]
) -> tuple[FloatArray, FloatArray]:
    up = np.array([0.0, 1.0, 0.0])
    if head is not None:
        low = nodes[[leg.upper[0] for leg in legs]].mean(axis=0) if legs else nodes[0]
        up = _snapped(nodes[head] - low, up)
    apart = np.zeros(3)
    for pair in (arms, legs):
        for limb in pair:
            apart += limb.side * nodes[limb.upper[0]]
    apart -= up * float(apart @ up)
    left = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, -1.0, 0.0])
    left = _snapped(apart, left)
    left = left - up * float(left @ up)
    return up, left / np.linalg.norm(left)


def _snapped(vector: FloatArray, default: FloatArray) -> FloatArray:
    """The unit vector, or the world's axis where it is within 25 degrees of one; `default` for no vector."""
    length = float(np.linalg.norm(vector))
    if length < 1e-9:
        return default
    vector = vector / length
    k = int(np.argmax(np.abs(vector)))
    axis = np.zeros(3)
    axis[k] = np.sign(vector[k])
    return axis if vector @ axis > 0.906 else vector


def _stature(nodes: FloatArray, head: int | None, arms: tuple[Limb, ...], legs: tuple[Limb, ...]) -> float:
    """The stature that the limbs' and the trunk's lengths belong to, by the H-Anim figure's shares; metres."""
    guesses = []
    for limbs, share in ((arms, 0.327), (legs, 0.485)):
        for limb in limbs:
            path = [*limb.upper, *limb.lower, limb.end]
            guesses.append(float(np.linalg.norm(np.diff(nodes[path], axis=0), axis=1).sum()) / share)
    if head is not None:
        low = nodes[[leg.upper[0] for leg in legs]].mean(axis=0) if legs else nodes[0]
        guesses.append(float(np.linalg.norm(nodes[head] - low)) / 0.405)
    guesses = [g for g in guesses if g > 1e-6]
    whole = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    if whole < 1e-6:  # nothing has a length: any size is as good
        return REFERENCE_STATURE_M
    return float(np.clip(np.median(guesses), 0.3 * whole, 6.0 * whole)) if guesses else whole
