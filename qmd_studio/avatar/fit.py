"""How a body follows the motions of a skeleton: joint by joint where it has the very joints, retargeted elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.avatar.upright import upright
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.joint_map import JointMap
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.reference_pose import Reference, choose_reference
from qmd_studio.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from qmd_studio.motion.retarget import Retargeting

FIGURE_PARTS = tuple(side + part for side in ("l_", "r_") for part in ("hip", "knee", "shoulder", "elbow"))
"""A skeleton with all of these can be worn by a body that was made for people."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A body on the motions of `source`. `turn` (4, 4) stands figures up whose file has another axis up.

    `way` is None where the body has the very joints of the source, and perhaps others that go with those above them.
    """

    source: Skeleton
    body: Body
    turn: FloatArray
    way: Retargeting | None = None

    def pose(self, world_from_joint: FloatArray) -> FloatArray:
        """Return the poses (n_frames, joints of the body, 4, 4) for those of the source, upright, metres."""
        if self.way is not None:
            return self.way.pose(world_from_joint)
        taken = np.maximum(self._taken, 0)
        world = np.asarray(self.turn @ world_from_joint[:, taken])
        for joint in np.flatnonzero(self._taken < 0):
            world[:, joint] = world[:, self.body.skeleton.joints[joint].parent] @ self._steps[joint]
        return world

    @property
    def world_from_figure(self) -> FloatArray:
        """Where the figure's own space stands, (4, 4)."""
        return self.turn if self.way is None else np.eye(4)

    @cached_property
    def _taken(self) -> IntArray:
        """The source's joint of the same name (joints of the body,), -1 for none."""
        number = {joint.name: k for k, joint in enumerate(self.source.joints)}
        return np.array([number.get(joint.name, -1) for joint in self.body.skeleton.joints], dtype=np.int64)

    @cached_property
    def _steps(self) -> FloatArray:
        """What takes each joint of the body to the one above it at rest, (joints of the body, 4, 4)."""
        steps = np.tile(np.eye(4), (len(self.body.skeleton.joints), 1, 1))
        for step, joint in zip(steps, self.body.skeleton.joints, strict=True):
            step[:3, :3], step[:3, 3] = joint.orientation, joint.offset
        return steps

    @cached_property
    def moved_by(self) -> IntArray:
        """The source's joint (joints of the body,) that each joint of the body shows, -1 where nothing moves it.

        A joint that the map leaves out goes with the joint above it.
        """
        number = {joint.name: k for k, joint in enumerate(self.source.joints)}
        pairs = number
        if self.way is not None:
            pairs = {target: number[source] for source, targets in self.way.joint_map.pairs for target in targets}
        result: list[int] = []
        for joint in self.body.skeleton.joints:
            above = result[joint.parent] if joint.parent >= 0 else -1
            result.append(pairs.get(joint.name, above))
        return np.array(result, dtype=np.int64)

    @cached_property
    def shown_by(self) -> IntArray:
        """The body's joint (joints of the source,) on which each joint of the source is seen, -1 for none."""
        result = np.full(len(self.source.joints), -1, dtype=np.int64)
        for joint in range(len(self.moved_by) - 1, -1, -1):  # the first of several is nearest to the root
            if self.moved_by[joint] >= 0:
                result[self.moved_by[joint]] = joint
        for index, source in enumerate(self.source.joints):
            if result[index] < 0 and source.parent >= 0:
                result[index] = result[source.parent]
        return result

    def on_body(self, values: FloatArray) -> FloatArray:
        """Return values of the source's joints (n,) as the body's joints show them, NaN where nothing moves one."""
        taken = values[np.maximum(self.moved_by, 0)]
        return np.where(self.moved_by >= 0, taken, np.nan)


def fit(motion: Motion, body: Body, *, joint_map: JointMap | None = None, reference: Reference | None = None) -> Fit:
    """Return how `body` follows `motion`; what is not given is chosen as suits the motion.

    Raises `FormatError` where the two have no joint in common.
    """
    turn = upright(motion)
    if joint_map is None and has_joints_of(body.skeleton, motion.skeleton):
        return Fit(motion.skeleton, body, turn)
    from qmd_studio.motion.retarget import retargeting  # compiled kernels come with it

    reference = choose_reference(motion) if reference is None else reference
    way = retargeting(motion.skeleton, body.skeleton, joint_map=joint_map, reference=reference, upright=turn)
    return Fit(motion.skeleton, body, turn, way)


def fit_bones(motion: Motion) -> Fit:
    """Return how the body that is made from the motion's own bones follows it."""
    return Fit(motion.skeleton, made_of_bones(motion.skeleton), upright(motion))


@lru_cache(maxsize=16)
def made_of_bones(skeleton: Skeleton) -> Body:
    """Return the body that is made from the bones of `skeleton`, once."""
    from qmd_studio.avatar.bone_body import bone_body  # not needed for the first picture

    return bone_body(skeleton)


def is_figure(skeleton: Skeleton) -> bool:
    """Tell whether `skeleton` has the limbs of a person."""
    return all(part in parts_of(skeleton).named for part in FIGURE_PARTS)


def has_joints_of(body: Skeleton, source: Skeleton) -> bool:
    """Tell whether `body` has all joints of `source` with the same rest, within 0.1 mm: then poses are the same."""
    if body is source:
        return True
    theirs = {joint.name: joint for joint in body.joints}
    if len(theirs) < len(body.joints) or len({joint.name for joint in source.joints}) < len(source.joints):
        return False  # names that stand twice name nothing
    for joint in source.joints:
        other = theirs.get(joint.name)
        if other is None or not np.allclose(joint.offset, other.offset, atol=1e-4):
            return False
        above = [s.joints[j.parent].name if j.parent >= 0 else "" for s, j in ((source, joint), (body, other))]
        if above[0] != above[1] or not np.allclose(joint.orientation, other.orientation, atol=1e-6):
            return False
    return True
