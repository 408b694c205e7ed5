"""One step of damped least squares that stays within bounds, solved on the smaller side of its matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.motion.ik_kernels import solve_positive

_ROUNDS, _BENT_ROUNDS = 60, 12
"""How often columns are clamped anew in a step; with the paths' curvature a round costs ten times as much."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """What the least sum looks like near a pose, for m rows and n columns.

    `residual` (m,) and `jacobian` (m, n) of the targets, `pull` (n,) the gradient of the springs that draw the columns
    back, `stiffness` (n,) theirs, `bend` (n, n) what the curved paths of the nodes add to JᵀJ, or None where the
    targets are nearly reached and it is next to nothing. `room` is how far each column may go down (<= 0) and up.
    """

    residual: FloatArray
    jacobian: FloatArray
    pull: FloatArray
    stiffness: FloatArray
    bend: FloatArray | None
    room: tuple[FloatArray, FloatArray]

    def promise(self, step: FloatArray) -> float:
        """Return by how much `step` (n,) makes half the sum less, if the model holds."""
        ahead = self.residual + self.jacobian @ step
        spent = step @ (self.pull + self.stiffness * step / 2)
        if self.bend is not None:
            spent += step @ self.bend @ step / 2
        return float((self.residual @ self.residual - ahead @ ahead) / 2 - spent)


def bounded_step(model: Model, damping: float) -> FloatArray | None:
    """Return the step (n,) that makes the model's sum plus damping · step² least within its room.

    A column that would leave its room is set at the end of it and the rest is solved again (clamp and free set), a few
    times; what would still leave it is then cut off. None where the model has no least, which more damping mends.
    """
    lowest, highest = model.room
    gradient = model.jacobian.T @ model.residual + model.pull
    step = np.zeros(len(gradient))
    free: BoolArray = ~(((lowest >= 0) & (gradient > 0)) | ((highest <= 0) & (gradient < 0)))
    for _ in range(_ROUNDS if model.bend is None else _BENT_ROUNDS):
        inner = _free_step(model, free, step, damping=damping)
        if inner is None:
            return None
        step[free] = inner
        beyond: BoolArray = free & ((step < lowest) | (step > highest))
        if not beyond.any():
            return step
        step[beyond] = np.clip(step[beyond], lowest[beyond], highest[beyond])
        free = free & ~beyond
    return np.clip(step, lowest, highest)


def _free_step(model: Model, free: BoolArray, step: FloatArray, *, damping: float) -> FloatArray | None:
    """Solve (JᵀJ + B + E) s = -(Jᵀr + q) for the free columns, E diagonal, the others' steps being given.

    Without B and with fewer rows than columns by s = -E⁻¹ (Jᵀ y + q), (1 + J E⁻¹ Jᵀ) y = r - J E⁻¹ q, the same thing.
    """
    set_steps = step[~free]
    residual = model.residual + model.jacobian[:, ~free] @ set_steps
    jacobian, pull = model.jacobian[:, free], model.pull[free]
    curvature = model.stiffness[free] + damping
    if model.bend is None and len(jacobian) < len(curvature):
        weighed = jacobian / curvature
        y = np.linalg.solve(np.eye(len(jacobian)) + weighed @ jacobian.T, residual - weighed @ pull)
        return np.asarray(-(weighed.T @ y + pull / curvature))
    matrix = jacobian.T @ jacobian + np.diag(curvature)
    if model.bend is not None:
        matrix += model.bend[np.ix_(free, free)]
        pull = pull + model.bend[np.ix_(free, ~free)] @ set_steps
    right = -(jacobian.T @ residual + pull)
    return right if solve_positive(matrix, right) else None
