"""The compiled loop of `motion/retarget.py`: all joints of one frame after the other."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled
from qmd_studio.motion.joint_fit_kernels import STRAIGHT, fit, turned

_Rows: TypeAlias = NDArray[Any]


@compiled()
def product(a: _Rows, b: _Rows, out: _Rows) -> None:
    """Fill `out` with a @ b, all (3, 3)."""
    for row in range(3):
        for column in range(3):
            out[row, column] = a[row, 0] * b[0, column] + a[row, 1] * b[1, column] + a[row, 2] * b[2, column]


@compiled()
def inverse_product(a: _Rows, b: _Rows, out: _Rows) -> None:
    """Fill `out` with the inverse of the rotation a, times b."""
    for row in range(3):
        for column in range(3):
            out[row, column] = a[0, row] * b[0, column] + a[1, row] * b[1, column] + a[2, row] * b[2, column]


@compiled()
def about(axis: _Rows, angle: float, out: _Rows) -> None:
    """Fill `out` with the turn of `angle` about the unit vector `axis`."""
    s, c = np.sin(angle), np.cos(angle)
    x, y, z = axis[0], axis[1], axis[2]
    d = 1.0 - c
    out[0, 0], out[0, 1], out[0, 2] = c + d * x * x, d * x * y - s * z, d * x * z + s * y
    out[1, 0], out[1, 1], out[1, 2] = d * x * y + s * z, c + d * y * y, d * y * z - s * x
    out[2, 0], out[2, 1], out[2, 2] = d * x * z - s * y, d * y * z + s * x, c + d * z * z


@compiled()
def part_way(start: _Rows, end: _Rows, share: float, scratch: _Rows, out: _Rows) -> None:
    """Fill `out` with the rotation at `share`, 0 to 1, of the shortest way from `start` to `end`."""
    relative, turn = scratch[0], scratch[1]
    inverse_product(start, end, relative)
    w = np.sqrt(max(0.0, 1.0 + relative[0, 0] + relative[1, 1] + relative[2, 2])) / 2.0
    axis = np.empty(3)
    if w > 0.1:
        axis[0] = (relative[2, 1] - relative[1, 2]) / (4.0 * w)
        axis[1] = (relative[0, 2] - relative[2, 0]) / (4.0 * w)
        axis[2] = (relative[1, 0] - relative[0, 1]) / (4.0 * w)
    else:
        k = 0
        for a in range(1, 3):
            if relative[a, a] > relative[k, k]:
                k = a
        u, v = (k + 1) % 3, (k + 2) % 3
        axis[k] = np.sqrt(max(0.0, 1.0 + relative[k, k] - relative[u, u] - relative[v, v])) / 2.0
        w = (relative[v, u] - relative[u, v]) / (4.0 * axis[k])
        axis[u] = (relative[u, k] + relative[k, u]) / (4.0 * axis[k])
        axis[v] = (relative[v, k] + relative[k, v]) / (4.0 * axis[k])
    length = np.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    if length < 1e-14:
        out[:] = start
        return
    angle = 2.0 * np.arctan2(length, w)
    if angle > np.pi:
        angle -= 2.0 * np.pi
    about(axis / length, share * angle, turn)
    product(start, turn, out)


@compiled()
def _roll_for_hinge(wanted: _Rows, child: _Rows, hinge: _Rows, bone: _Rows, lower: _Rows, turn: _Rows) -> float:
    """Return by how much to roll `wanted` about its `bone` so that a lone `hinge` below it reaches the lower bone.

    `hinge` and `bone` are unit vectors in the upper joint's frame, `lower` (3,) the lower bone in the world; `child`
    is the lower bone at rest in the upper joint's frame.
    """
    v = np.empty(3)
    for a in range(3):
        v[a] = wanted[0, a] * lower[0] + wanted[1, a] * lower[1] + wanted[2, a] * lower[2]
    along = hinge @ bone
    p = hinge @ v - along * (bone @ v)
    q = hinge[0] * (bone[1] * v[2] - bone[2] * v[1])
    q += hinge[1] * (bone[2] * v[0] - bone[0] * v[2])
    q += hinge[2] * (bone[0] * v[1] - bone[1] * v[0])
    # rolling by t takes v to the component p cos t - q sin t (+ const) along the hinge
    reach = np.sqrt(p * p + q * q)
    if reach < 1e-9:
        return 0.0
    level = hinge @ child - along * (bone @ v)
    phase = np.arctan2(q, p)
    half = np.arccos(min(1.0, max(-1.0, level / reach)))
    first, second = half - phase, -half - phase
    first -= 2.0 * np.pi * np.round(first / (2.0 * np.pi))
    second -= 2.0 * np.pi * np.round(second / (2.0 * np.pi))
    roll = first if abs(first) < abs(second) else second
    return float(roll * (reach * reach / (reach * reach + STRAIGHT * STRAIGHT)))


@compiled()
def apart(a: _Rows, b: _Rows, bone: _Rows) -> float:
    """Return the angle between two rotations, or of the unit vector `bone` turned by either where it is not zero."""
    gap = 0.0
    if bone[0] != 0.0 or bone[1] != 0.0 or bone[2] != 0.0:
        for row in range(3):
            way = 0.0
            for column in range(3):
                way += (a[row, column] - b[row, column]) * bone[column]
            gap += way * way
        return float(2.0 * np.arcsin(min(1.0, np.sqrt(gap) / 2.0)))
    for row in range(3):
        for column in range(3):
            gap += (a[row, column] - b[row, column]) ** 2
    return float(2.0 * np.arcsin(min(1.0, np.sqrt(gap / 8.0))))


@compiled()
def directed(world: _Rows, upright: _Rows, joints: _Rows, frames: _Rows, out: _Rows) -> None:
    """Fill `out` (n_frames, S, 3, 3) with the frames of the source's parts in the upright world."""
    turn = np.empty((3, 3))
    for frame in range(len(world)):
        for k in range(len(joints)):
            product(upright, world[frame, joints[k], :3, :3], turn)
            product(turn, frames[k], out[frame, k])


@compiled()
def wanted_kernel(parts: _Rows, source: _Rows, base: _Rows, share: _Rows, frame_inverse: _Rows, wanted: _Rows) -> None:
    """Fill `wanted` (n_frames, J, 3, 3): the world rotation of each target joint that a source joint drives."""
    scratch, way = np.empty((2, 3, 3)), np.empty((3, 3))
    for frame in range(len(parts)):
        for j in range(len(source)):
            if source[j] < 0:
                continue
            if base[j] >= 0 and share[j] < 1.0:
                part_way(parts[frame, base[j]], parts[frame, source[j]], share[j], scratch, way)
                product(way, frame_inverse[j], wanted[frame, j])
            else:
                product(parts[frame, source[j]], frame_inverse[j], wanted[frame, j])


@compiled()
def fit_kernel(  # noqa: PLR0913 - compiled code takes no record
    wanted: _Rows,
    source: _Rows,
    parent: _Rows,
    orientation: _Rows,
    offset: _Rows,
    n_axes: _Rows,
    axes: _Rows,
    sign: _Rows,
    column: _Rows,
    lead: _Rows,
    low: _Rows,
    high: _Rows,
    keep: bool,
    hinge_child: _Rows,
    hinge: _Rows,
    bone: _Rows,
    child_bone: _Rows,
    lower_bone: _Rows,
    world: _Rows,
    X: _Rows,
    error: _Rows,
    beyond: _Rows,
) -> None:
    """Turn each joint's columns so that `world` (n_frames, J, 4, 4) comes near to `wanted`; the root stays at rest.

    `error` (n_frames, J) gets the angles that are left, of the bone alone where its roll is left to the next joint;
    `beyond` (n_columns,) how often a value lay outside its limits.
    """
    scratch, angles = np.empty((2, 3, 3)), np.zeros(3)
    local, outer, aim, turn = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    lower = np.empty(3)
    for frame in range(len(wanted)):
        for j in range(len(parent)):
            pose = world[frame, j]
            if parent[j] < 0:
                outer[:] = orientation[j]
                for a in range(3):
                    pose[a, 3] = offset[j, a]
            else:
                above = world[frame, parent[j]]
                product(above, orientation[j], outer)
                for a in range(3):
                    pose[a, 3] = above[a, 3] + above[a, 0] * offset[j, 0] + above[a, 1] * offset[j, 1]
                    pose[a, 3] += above[a, 2] * offset[j, 2]
            pose[3, 0], pose[3, 1], pose[3, 2], pose[3, 3] = 0.0, 0.0, 0.0, 1.0
            if source[j] >= 0 and n_axes[j] > 0:
                aim[:] = wanted[frame, j]
                child = hinge_child[j]
                if child >= 0:
                    for a in range(3):
                        lower[a] = 0.0
                        for b in range(3):
                            lower[a] += wanted[frame, child, a, b] * lower_bone[j, b]
                    about(bone[j], _roll_for_hinge(aim, child_bone[j], hinge[j], bone[j], lower, turn), turn)
                    product(wanted[frame, j], turn, aim)
                inverse_product(outer, aim, local)
                n = n_axes[j]
                fit(local, n, axes[j], lead[j], low[j], high[j], scratch, angles)
                for a in range(n):
                    if angles[a] < low[j, a] - 1e-6 or angles[a] > high[j, a] + 1e-6:
                        beyond[column[j, a]] += 1
                if keep:
                    for a in range(n):
                        angles[a] = min(max(angles[a], low[j, a]), high[j, a])
                for a in range(n):
                    turned(outer, axes[j, a], angles[a])
                    X[frame, column[j, a]] = sign[j, a] * angles[a]
            for a in range(3):
                for b in range(3):
                    pose[a, b] = outer[a, b]
            if source[j] >= 0:
                if hinge_child[j] >= 0:
                    error[frame, j] = apart(outer, wanted[frame, j], bone[j])
                else:
                    error[frame, j] = apart(outer, wanted[frame, j], lead[j])
