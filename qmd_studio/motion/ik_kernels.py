"""The compiled loop of inverse kinematics: how each column moves and turns the nodes that are pulled."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled

_Rows: TypeAlias = NDArray[Any]


@compiled()
def node_jacobian_kernel(  # noqa: PLR0913 - a kernel takes arrays, not records
    pose: _Rows,
    world: _Rows,
    node_joint: _Rows,
    place: _Rows,
    parent: _Rows,
    orientation: _Rows,
    turn_start: _Rows,
    turn_column: _Rows,
    turn_axis: _Rows,
    turn_sign: _Rows,
    move_start: _Rows,
    move_column: _Rows,
    move_axis: _Rows,
    move_sign: _Rows,
    moved: _Rows,
    turned: _Rows,
) -> None:
    """Fill `moved` and `turned` (E, 3, M), which come as zeros, for the `pose` (M,) of matrices `world` (J, 4, 4).

    Node e hangs from joint `node_joint[e]` at `place[e]` in the world. `moved[e, :, m]` is its velocity in metres and
    `turned[e, :, m]` its angular velocity where column m grows by one a second.
    """
    frame = np.empty((3, 3))
    for e in range(len(node_joint)):
        j = node_joint[e]
        while j >= 0:
            above = parent[j]
            for a in range(3):
                for b in range(3):
                    if above < 0:
                        frame[a, b] = orientation[j, a, b]
                    else:
                        frame[a, b] = 0.0
                        for c in range(3):
                            frame[a, b] += world[above, a, c] * orientation[j, c, b]
            x, y, z = place[e, 0] - world[j, 0, 3], place[e, 1] - world[j, 1, 3], place[e, 2] - world[j, 2, 3]
            for k in range(turn_start[j], turn_start[j + 1]):
                axis, column = turn_axis[k], turn_column[k]
                p, q, r = frame[0, axis] * turn_sign[k], frame[1, axis] * turn_sign[k], frame[2, axis] * turn_sign[k]
                turned[e, 0, column], turned[e, 1, column], turned[e, 2, column] = p, q, r
                moved[e, 0, column], moved[e, 1, column], moved[e, 2, column] = (
                    q * z - r * y,
                    r * x - p * z,
                    p * y - q * x,
                )
                angle = turn_sign[k] * pose[column]
                s, c = np.sin(angle), np.cos(angle)
                u, v = (axis + 1) % 3, (axis + 2) % 3
                for a in range(3):
                    first, second = frame[a, u], frame[a, v]
                    frame[a, u] = first * c + second * s
                    frame[a, v] = second * c - first * s
            for k in range(move_start[j], move_start[j + 1]):
                for a in range(3):
                    along = 1.0 if a == move_axis[k] else 0.0
                    if above >= 0:
                        along = world[above, a, move_axis[k]]
                    moved[e, a, move_column[k]] = move_sign[k] * along
            j = above


@compiled(fastmath={"contract", "reassoc"})
def solve_positive(matrix: _Rows, right: _Rows) -> bool:
    """Solve `matrix` x = `right` (n,) in place by Cholesky's factors; False where the matrix is not positive definite.

    A library's solver would wake threads for each of these small systems, which costs more than it saves.
    """
    n = len(right)
    for i in range(n):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i > j:
                matrix[i, j] = total / matrix[j, j]
            elif total <= 1e-14 * abs(matrix[i, i]):
                return False
            else:
                matrix[i, i] = np.sqrt(total)
    for i in range(n):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            right[i] -= matrix[k, i] * right[k]
        right[i] /= matrix[i, i]
    return True
