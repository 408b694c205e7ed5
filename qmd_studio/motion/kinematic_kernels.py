"""The compiled loops of `motion/fast_kinematics.py`, in whichever precision their arrays have.

The innermost loops run over frames and compile to vector instructions; a block of frames stays in the cache while all
joints pass over it. They release the interpreter's lock, so that a window stays live while a worker computes.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled

_Rows: TypeAlias = NDArray[Any]

BLOCK = 128
"""Frames that pass over all joints together."""

EXACT = {"contract", "nnan", "ninf", "nsz"}
"""Freedoms for the compiler that leave the order of additions alone: range reduction lives on it."""


@compiled(fastmath=EXACT)
def sine_cosine(angle: _Rows, start: int, sign: float, sine: _Rows, cosine: _Rows, count: int) -> None:
    """Fill the first `count` of `sine` and `cosine` for `sign * angle[start:]`."""
    if angle.itemsize == 8:
        for t in range(count):
            sine[t] = sign * np.sin(angle[start + t])
            cosine[t] = np.cos(angle[start + t])
        return
    one, half, two = np.float32(1), np.float32(0.5), np.float32(2)
    for t in range(count):
        x = angle[start + t]
        # x = turns * pi + r with |r| <= pi / 2; pi in two parts, the first short enough that its multiples are exact
        turns = np.floor(x * np.float32(0.31830987) + half)
        r = (x - turns * np.float32(3.140625)) - turns * np.float32(9.67653589793e-4)
        flip = one - two * (turns - two * np.floor(turns * half))
        q = r * r
        # minimax polynomials on [-pi/2, pi/2], within 2e-7
        s = np.float32(2.7525562e-6) - q * np.float32(2.3889859e-8)
        s = np.float32(-1.9840874e-4) + q * s
        s = np.float32(8.3333310e-3) + q * s
        s = r + r * q * (np.float32(-1.6666667e-1) + q * s)
        c = np.float32(2.47609e-5) - q * np.float32(2.605e-7)
        c = np.float32(-1.388888e-3) + q * c
        c = np.float32(4.16666418e-2) + q * c
        c = one + q * (q * c - half)
        sine[t] = flip * sign * s
        cosine[t] = flip * c


@compiled(fastmath=EXACT)
def turn(matrix: _Rows, axis: int, sine: _Rows, cosine: _Rows, count: int) -> None:
    """Multiply the matrices (9, block) from the right by a turn about `axis`."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    for row in range(3):
        first, second = matrix[3 * row + u], matrix[3 * row + v]
        for t in range(count):
            x, y = first[t], second[t]
            first[t] = x * cosine[t] + y * sine[t]
            second[t] = y * cosine[t] - x * sine[t]


@compiled(fastmath=EXACT)
def copy_rows(source: _Rows, target: _Rows, start: int, count: int) -> None:
    """Copy the first `count` of each row of `source` to `target` from `start` on."""
    for a in range(len(source)):
        ours, theirs = source[a], target[a]
        for t in range(count):
            theirs[start + t] = ours[t]


@compiled(fastmath=EXACT)
def orient(outer: _Rows, orientation: _Rows, aligned: bool, matrix: _Rows, count: int) -> None:
    """Fill the matrices (9, block) with `outer` @ `orientation`."""
    if aligned:
        copy_rows(outer, matrix, 0, count)
        return
    for row in range(3):
        x, y, z = outer[3 * row], outer[3 * row + 1], outer[3 * row + 2]
        for column in range(3):
            a, b, c = orientation[0, column], orientation[1, column], orientation[2, column]
            target = matrix[3 * row + column]
            for t in range(count):
                target[t] = x[t] * a + y[t] * b + z[t] * c


@compiled(fastmath=EXACT)
def carry(place: _Rows, start: int, outer: _Rows, offset: _Rows, near: _Rows, count: int) -> None:
    """Fill `place` (3, …) from `start` on with `near` + `outer` @ `offset` (3,)."""
    a, b, c = offset[0], offset[1], offset[2]
    for row in range(3):
        x, y, z = outer[3 * row], outer[3 * row + 1], outer[3 * row + 2]
        base, target = near[row], place[row]
        for t in range(count):
            target[start + t] = base[t] + (x[t] * a + y[t] * b + z[t] * c)


@compiled(fastmath=EXACT)
def carry_each(place: _Rows, outer: _Rows, moved: _Rows, near: _Rows, count: int) -> None:
    """Fill `place` (3, block) with `near` + `outer` @ `moved` (3, block): an offset for each frame."""
    a, b, c = moved[0], moved[1], moved[2]
    for row in range(3):
        x, y, z = outer[3 * row], outer[3 * row + 1], outer[3 * row + 2]
        base, target = near[row], place[row]
        for t in range(count):
            target[t] = base[t] + (x[t] * a[t] + y[t] * b[t] + z[t] * c[t])


@compiled(fastmath=EXACT)
def position_kernel(  # noqa: PLR0913 - compiled code takes no record
    Xt: _Rows,
    positions: _Rows,
    parent: _Rows,
    turns: _Rows,
    aligned: _Rows,
    joined: _Rows,
    orientation: _Rows,
    offset: _Rows,
    turn_start: _Rows,
    turn_column: _Rows,
    turn_axis: _Rows,
    turn_sign: _Rows,
    move_start: _Rows,
    move_column: _Rows,
    move_axis: _Rows,
    move_sign: _Rows,
    target_joint: _Rows,
    target_far: _Rows,
    target_offset: _Rows,
) -> None:
    """Fill `positions` (3 * T, n_frames) from `Xt` (n_columns, n_frames), one block of frames after the other."""
    n_frames, n_joints = Xt.shape[1], len(parent)
    rotation = np.empty((n_joints, 9, BLOCK), Xt.dtype)
    place = np.empty((n_joints, 3, BLOCK), Xt.dtype)
    moved = np.empty((3, BLOCK), Xt.dtype)
    sine, cosine = np.empty(BLOCK, Xt.dtype), np.empty(BLOCK, Xt.dtype)
    world = np.zeros((9, BLOCK), Xt.dtype)
    world[0], world[4], world[8] = 1, 1, 1
    origin = np.zeros((3, BLOCK), Xt.dtype)
    for start in range(0, n_frames, BLOCK):
        count = min(BLOCK, n_frames - start)
        for j in range(n_joints):
            p = parent[j]
            outer = rotation[p] if p >= 0 else world
            near = place[p] if p >= 0 else origin
            if move_start[j] < move_start[j + 1]:
                for a in range(3):
                    for t in range(count):
                        moved[a, t] = offset[j, a]
                for k in range(move_start[j], move_start[j + 1]):
                    row, values = moved[move_axis[k]], Xt[move_column[k]]
                    for t in range(count):
                        row[t] += move_sign[k] * values[start + t]
                carry_each(place[j], outer, moved, near, count)
            elif joined[j]:
                copy_rows(near, place[j], 0, count)
            else:
                carry(place[j], 0, outer, offset[j], near, count)
            if turns[j]:
                orient(outer, orientation[j], aligned[j], rotation[j], count)
                for k in range(turn_start[j], turn_start[j + 1]):
                    sine_cosine(Xt[turn_column[k]], start, turn_sign[k], sine, cosine, count)
                    turn(rotation[j], turn_axis[k], sine, cosine, count)
        for k in range(len(target_joint)):
            j = target_joint[k]
            target = positions[3 * k : 3 * k + 3]
            if target_far[k]:
                carry(target, start, rotation[j], target_offset[k], place[j], count)
            else:
                copy_rows(place[j], target, start, count)


@compiled(fastmath=EXACT)
def pose_kernel(  # noqa: PLR0913 - compiled code takes no record
    X: _Rows,
    parent: _Rows,
    orientation: _Rows,
    offset: _Rows,
    turn_start: _Rows,
    turn_column: _Rows,
    turn_axis: _Rows,
    turn_sign: _Rows,
    move_start: _Rows,
    move_column: _Rows,
    move_axis: _Rows,
    move_sign: _Rows,
    world: _Rows,
) -> None:
    """Fill `world` (n_frames, n_joints, 4, 4) from X (n_frames, n_columns), frame after frame."""
    local = np.empty(3)
    for frame in range(len(X)):
        for j in range(len(parent)):
            for a in range(3):
                local[a] = offset[j, a]
            for k in range(move_start[j], move_start[j + 1]):
                local[move_axis[k]] += move_sign[k] * X[frame, move_column[k]]
            pose = world[frame, j]
            above = world[frame, max(parent[j], 0)]
            for a in range(3):
                if parent[j] < 0:
                    for b in range(3):
                        pose[a, b] = orientation[j, a, b]
                    pose[a, 3] = local[a]
                    continue
                x, y, z = above[a, 0], above[a, 1], above[a, 2]
                for b in range(3):
                    pose[a, b] = x * orientation[j, 0, b] + y * orientation[j, 1, b] + z * orientation[j, 2, b]
                pose[a, 3] = above[a, 3] + x * local[0] + y * local[1] + z * local[2]
            for k in range(turn_start[j], turn_start[j + 1]):
                angle = turn_sign[k] * X[frame, turn_column[k]]
                s, c = np.sin(angle), np.cos(angle)
                u, v = (turn_axis[k] + 1) % 3, (turn_axis[k] + 2) % 3
                for a in range(3):
                    first, second = pose[a, u], pose[a, v]
                    pose[a, u] = first * c + second * s
                    pose[a, v] = second * c - first * s
            pose[3, 0], pose[3, 1], pose[3, 2], pose[3, 3] = 0.0, 0.0, 0.0, 1.0
