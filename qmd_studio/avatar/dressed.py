"""A motion on a body: what is drawn of it, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.fit import Fit, fit, fit_bones
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, slots=True, eq=False)
class Dressed:
    """A motion on a body. `note` says why it is not the body that was asked for, where it is not."""

    motion: Motion
    fit: Fit
    note: str = ""

    @property
    def body(self) -> Body:
        """The body that is worn."""
        return self.fit.body

    def poses(self, frames: slice | Sequence[int]) -> FloatArray:
        """Return world_from_joint (n, n_joints, 4, 4) of the body in these frames, upright, metres."""
        return self.fit.pose(world_from_joint(self.motion.skeleton, self.motion.X[frames]))

    def morphs(self, frame: int) -> FloatArray:
        """Return the weights of the body's displacers in one frame, (n_displacers,)."""
        return morphs(self.body, self.motion, self.motion.X[frame])


def dress(motion: Motion, body: Body | None) -> Dressed:
    """Return `motion` on `body`, or on one made from its own bones where `body` is None or cannot follow it."""
    if body is None:
        return Dressed(motion, fit_bones(motion))
    try:
        return Dressed(motion, fit(motion, body))
    except FormatError as problem:
        note = f"{body.name or 'the body'} cannot follow the motion: {problem.message}; a body of its bones does"
        return Dressed(motion, fit_bones(motion), note)


def morphs(body: Body, motion: Motion, row: FloatArray) -> FloatArray:
    """Return the weights of the body's displacers (n_displacers,) in a pose `row` (n_columns,) of `motion`.

    A displacer's weight is the value of the motion's column of its name, and else what its file has.
    """
    if not body.displacers:
        return np.zeros(0)
    columns = {column.name: index for index, column in enumerate(motion.skeleton.columns)}
    return np.array([row[columns[d.name]] if d.name in columns else d.weight for d in body.displacers])
