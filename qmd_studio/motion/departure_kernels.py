"""The compiled loops of `motion/departure.py`: where joints go, computed only for the joints that stray."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled
from qmd_studio.motion.kinematic_kernels import (
    BLOCK,
    EXACT,
    carry,
    carry_each,
    copy_rows,
    orient,
    sine_cosine,
    turn,
)

_Rows: TypeAlias = NDArray[Any]


@compiled(fastmath=EXACT)
def _joint(  # noqa: PLR0913 - compiled code takes no record
    Xt: _Rows, j: int, start: int, count: int, outer: _Rows, near: _Rows, place: _Rows, rotation: _Rows, plan: Any
) -> None:
    """Fill `place` (3, block) and `rotation` (9, block) of visited joint j from its parent's, `near` and `outer`."""
    _, turns, aligned, joined, orientation, offset = plan[:6]
    turn_start, turn_column, turn_axis, turn_sign, move_start, move_column, move_axis, move_sign = plan[6:14]
    if move_start[j] < move_start[j + 1]:
        moved = np.empty((3, BLOCK), np.float32)
        for a in range(3):
            for t in range(count):
                moved[a, t] = offset[j, a]
        for k in range(move_start[j], move_start[j + 1]):
            row, values = moved[move_axis[k]], Xt[move_column[k]]
            for t in range(count):
                row[t] += move_sign[k] * values[start + t]
        carry_each(place, outer, moved, near, count)
    elif joined[j]:
        copy_rows(near, place, 0, count)
    else:
        carry(place, 0, outer, offset[j], near, count)
    if turns[j]:
        sine, cosine = np.empty(BLOCK, np.float32), np.empty(BLOCK, np.float32)
        orient(outer, orientation[j], aligned[j], rotation, count)
        for k in range(turn_start[j], turn_start[j + 1]):
            sine_cosine(Xt[turn_column[k]], start, turn_sign[k], sine, cosine, count)
            turn(rotation, turn_axis[k], sine, cosine, count)


@compiled(fastmath=EXACT)
def pose_blocks(Xt: _Rows, rotation: _Rows, place: _Rows, plan: Any) -> None:
    """Fill `rotation` (n_blocks, K, 9, block) and `place` (n_blocks, K, 3, block) of all visited joints.

    `Xt` (n_columns, n_frames) float32 radians and metres; `plan` are the arrays of `fast_kinematics.Plan`.
    """
    parent, n_frames = plan[0], Xt.shape[1]
    world, origin = np.zeros((9, BLOCK), np.float32), np.zeros((3, BLOCK), np.float32)
    world[0], world[4], world[8] = 1, 1, 1
    for block in range(len(rotation)):
        start = block * BLOCK
        count = min(BLOCK, n_frames - start)
        for j in range(len(parent)):
            p = parent[j]
            outer = rotation[block, p] if p >= 0 else world
            near = place[block, p] if p >= 0 else origin
            _joint(Xt, j, start, count, outer, near, place[block, j], rotation[block, j], plan)


@compiled(fastmath=True)
def _stray(away: _Rows, original: _Rows, start: int, count: int, squares: _Rows) -> tuple[float, float]:
    """Add the squared distances of one point to `squares` (block,); return their roots' sum and the largest of them.

    `away` (3, block) is compared with `original` (3, n_frames) from `start` on.
    """
    x, y, z = away[0], away[1], away[2]
    u, v, w = original[0], original[1], original[2]
    total, largest = np.float32(0), np.float32(0)
    for t in range(count):
        a, b, c = x[t] - u[start + t], y[t] - v[start + t], z[t] - w[start + t]
        square = a * a + b * b + c * c
        squares[t] += square
        total += np.sqrt(square)
        largest = max(largest, square)
    return float(total), float(largest)


@compiled(fastmath=True)
def _roots(squares: _Rows, count: int) -> float:
    total = np.float32(0)
    for t in range(count):
        total += np.sqrt(squares[t])
    return float(total)


@compiled(fastmath=EXACT)
def departure_kernel(
    Xt: _Rows,
    original: _Rows,
    known: Any,
    turned: _Rows,
    placed: _Rows,
    strays: _Rows,
    before: _Rows,
    plan: Any,
) -> tuple[float, float, float]:
    """Return the mean over frames of the norm of all distances, the sum of all distances, and the largest, metres.

    `Xt` (n_columns, n_frames) float32 radians and metres, `original` (3 * T, n_frames) metres. `known` are rotations
    and places as `pose_blocks` fills them, right for the joints that `turned` (K,) and `placed` (K,) mark. Only the
    targets that `strays` (T,) marks are looked at; `before` (n_frames,) holds the squared distances of the others.
    """
    parent, (target_joint, target_far, target_offset) = plan[0], plan[14:]
    known_rotation, known_place = known
    n_frames, n_joints = Xt.shape[1], len(parent)
    rotation, place = np.empty((n_joints, 9, BLOCK), np.float32), np.empty((n_joints, 3, BLOCK), np.float32)
    world, origin = np.zeros((9, BLOCK), np.float32), np.zeros((3, BLOCK), np.float32)
    world[0], world[4], world[8] = 1, 1, 1
    far, squares = np.empty((3, BLOCK), np.float32), np.empty(BLOCK, np.float32)
    norms, total, largest = 0.0, 0.0, 0.0
    for block in range((n_frames + BLOCK - 1) // BLOCK):
        start = block * BLOCK
        count = min(BLOCK, n_frames - start)
        for j in range(n_joints):
            if turned[j] and placed[j]:
                continue
            p = parent[j]
            outer, near = world, origin
            if p >= 0:
                outer = known_rotation[block, p] if turned[p] else rotation[p]
                near = known_place[block, p] if placed[p] else place[p]
            _joint(Xt, j, start, count, outer, near, place[j], rotation[j], plan)
        squares[:count] = before[start : start + count]
        for k in range(len(target_joint)):
            if not strays[k]:
                continue
            j = target_joint[k]
            away = known_place[block, j] if placed[j] else place[j]
            if target_far[k]:
                turning = known_rotation[block, j] if turned[j] else rotation[j]
                carry(far, 0, turning, target_offset[k], away, count)
                away = far
            one, most = _stray(away, original[3 * k : 3 * k + 3], start, count, squares)
            total += one
            largest = max(largest, most)
        norms += _roots(squares, count)
    return norms / n_frames, total, np.sqrt(largest)
