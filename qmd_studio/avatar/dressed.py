"""Which body a motion wears, and how the motion moves it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, slots=True, eq=False)
class Dressed:
    """A motion on a body. `note` says why it is not the body that was asked for, where it is not."""

    motion: Motion
    body: Body
    note: str = ""

    def poses(self, frames: slice | list[int]) -> FloatArray:
        """Return world_from_joint (n, n_joints, 4, 4) of the body in these frames, metres."""
        return world_from_joint(self.body.skeleton, self.motion.X[frames])

    def morphs(self, frame: int) -> FloatArray:
        """Return the weights of the body's displacers in one frame, (n_displacers,): the motion's, else the file's."""
        columns = {column.name: index for index, column in enumerate(self.motion.skeleton.columns)}
        row = self.motion.X[frame]
        return np.array([row[columns[d.name]] if d.name in columns else d.weight for d in self.body.displacers])


def dress(motion: Motion, body: Body | None) -> Dressed:
    """Return `motion` on `body`, if the body has the very joints and columns that the motion moves.

    Otherwise, and where `body` is None, the motion wears a body made from its own bones.
    """
    if body is None:
        return Dressed(motion, bone_body(motion.skeleton))
    if _moves(motion, body):
        return Dressed(motion, body)
    note = f"{body.name or 'the body'} has other joints than the motion, which is shown on a body made from its bones"
    return Dressed(motion, bone_body(motion.skeleton), note)


def _moves(motion: Motion, body: Body) -> bool:
    ours, theirs = motion.skeleton, body.skeleton
    if ours == theirs:
        return True
    tree = [(joint.name, joint.parent) for joint in ours.joints]
    columns = [(column.name, column.joint, column.axis, column.kind) for column in ours.columns]
    return tree == [(joint.name, joint.parent) for joint in theirs.joints] and columns == [
        (column.name, column.joint, column.axis, column.kind) for column in theirs.columns
    ]
