"""What small changes of the columns do to the measured points and to the joints' orientations, frame by frame.

With J the Jacobian of all measured points' positions, stacked with `ORIENTATION_REACH` times that of all joints'
orientations (rotation vectors), the sensitivity of a frame is H = Jᵀ J, (n_columns, n_columns): a small error e of the
columns moves the points by a stacked distance of √(eᵀ H e). J itself is never formed: the points beyond a joint enter
H by their number, sum and second moment alone, gathered from the leaves inward, as the masses of a linked body are in
the composite-rigid-body method (Walker and Orin, 1982).

Importing this module imports numba.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.kinematics import chain_of
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import Skeleton

ORIENTATION_REACH = 0.5
"""What a radian of a joint's orientation counts for, in ASF units: its error is seen 28 mm from the joint."""

_Values: TypeAlias = NDArray[Any]


class Body(NamedTuple):
    """A skeleton for the kernel, lengths in ASF units; J joints, P measured ends of bones.

    `weight` (J,) counts how often each joint is a measured point, `site_joint` (P,) and `site_offset` (P, 3) are the
    measured end sites. The rest is as in `Chain`.
    """

    parent: IntArray
    orientation: FloatArray
    offset: FloatArray
    turn_start: IntArray
    turn_column: IntArray
    turn_axis: IntArray
    turn_sign: FloatArray
    move_start: IntArray
    move_column: IntArray
    move_axis: IntArray
    move_sign: FloatArray
    weight: FloatArray
    site_joint: IntArray
    site_offset: FloatArray


class Workspace(NamedTuple):
    """Memory for `sensitivity_at`: poses of J joints, moments of what hangs from them, twists of M columns."""

    rotation: FloatArray
    place: FloatArray
    moments: FloatArray
    twist: FloatArray
    wrench: FloatArray


@lru_cache(maxsize=64)
def body_of(skeleton: Skeleton) -> Body:
    """Return the arrays of `skeleton` that the kernel takes, made once."""
    chain = chain_of(skeleton)
    n_joints = len(skeleton.joints)
    ends = chain.points[chain.points >= n_joints] - n_joints
    near = chain.points[chain.points < n_joints]
    return Body(
        parent=chain.parent,
        orientation=chain.orientation,
        offset=chain.offset / ASF_UNIT_M,
        turn_start=chain.turn_start,
        turn_column=chain.turn_column,
        turn_axis=chain.turn_axis,
        turn_sign=chain.turn_sign,
        move_start=chain.move_start,
        move_column=chain.move_column,
        move_axis=chain.move_axis,
        move_sign=chain.move_sign,
        weight=np.bincount(near, minlength=n_joints).astype(np.float64),
        site_joint=chain.site_joint[ends],
        site_offset=chain.site_offset[ends] / ASF_UNIT_M,
    )


def workspace_of(skeleton: Skeleton) -> Workspace:
    """Return memory for `sensitivity_at` on `skeleton`, to be used by one thread at a time."""
    n_joints = len(skeleton.joints)
    return Workspace(
        rotation=np.empty((n_joints, 3, 3)),
        place=np.empty((n_joints, 3)),
        moments=np.empty((n_joints, 11)),
        twist=np.zeros((skeleton.n_columns, 6)),
        wrench=np.empty(6),
    )


def sensitivities(skeleton: Skeleton, rows: FloatArray) -> FloatArray:
    """Return H of each row, (n_rows, n_columns, n_columns), in squared ASF units per squared unit of the columns.

    `rows` (n_rows, n_columns) are radians and, other than everywhere else, ASF units of length: the units of QMD.
    """
    rows = np.ascontiguousarray(rows, dtype=np.float64)
    found = np.empty((len(rows), skeleton.n_columns, skeleton.n_columns))
    body, workspace = body_of(skeleton), workspace_of(skeleton)
    for row, H in zip(rows, found, strict=True):
        sensitivity_at(body, row, workspace, H)
    return found


def column_sensitivities(skeleton: Skeleton, rows: FloatArray) -> FloatArray:
    """Return the diagonal of H of each row, (n_rows, n_columns): what each column does by itself.

    `rows` and units are those of `sensitivities`.
    """
    rows = np.ascontiguousarray(rows, dtype=np.float64)
    found = np.empty(rows.shape)
    _diagonals(body_of(skeleton), rows, workspace_of(skeleton), found)
    return found


@njit(cache=True, nogil=True)
def _diagonals(body: Body, rows: FloatArray, workspace: Workspace, found: FloatArray) -> None:
    H = np.empty((rows.shape[1], rows.shape[1]))
    for row in range(len(rows)):
        sensitivity_at(body, rows[row], workspace, H)
        found[row] = np.diag(H)


@njit(cache=True, nogil=True)
def sensitivity_at(body: Body, row: _Values, workspace: Workspace, H: FloatArray) -> None:
    """Fill `H` (n_columns, n_columns) for the pose `row` (n_columns,) in radians and ASF units."""
    _pose(body, row, workspace)
    _gather(body, workspace)
    H[:] = 0.0
    twist, wrench = workspace.twist, workspace.wrench
    for joint in range(len(body.parent)):
        for kind in range(2):
            start, columns = (body.turn_start, body.turn_column) if kind == 0 else (body.move_start, body.move_column)
            for k in range(start[joint], start[joint + 1]):
                column = columns[k]
                _push(workspace.moments[joint], twist[column], wrench)
                above = joint
                while above >= 0:
                    for other in body.turn_column[body.turn_start[above] : body.turn_start[above + 1]]:
                        H[column, other] = H[other, column] = _work(twist[other], wrench)
                    for other in body.move_column[body.move_start[above] : body.move_start[above + 1]]:
                        H[column, other] = H[other, column] = _work(twist[other], wrench)
                    above = body.parent[above]


@njit(cache=True, nogil=True)
def _pose(body: Body, row: _Values, workspace: Workspace) -> None:
    """Place all joints, as seen from the first one, and write each column's twist: its turn, then its move at 0."""
    rotation, place, twist = workspace.rotation, workspace.place, workspace.twist
    origin, local = np.zeros(3), np.empty(3)
    for j in range(len(body.parent)):
        p = body.parent[j]
        for a in range(3):
            local[a] = body.offset[j, a]
        for k in range(body.move_start[j], body.move_start[j + 1]):
            axis, sign, column = body.move_axis[k], body.move_sign[k], body.move_column[k]
            local[axis] += sign * row[column]
            for a in range(3):
                twist[column, a] = 0.0
                twist[column, 3 + a] = sign * (rotation[p, a, axis] if p >= 0 else np.float64(a == axis))
        _place(body.orientation[j], local, p, j, rotation, place)
        if j == 0:
            for a in range(3):
                origin[a] = place[0, a]
        if p < 0:
            for a in range(3):
                place[j, a] -= origin[a]  # far from the world's origin the moments would drown in rounding
        x, y, z = place[j, 0], place[j, 1], place[j, 2]
        for k in range(body.turn_start[j], body.turn_start[j + 1]):
            axis, sign, column = body.turn_axis[k], body.turn_sign[k], body.turn_column[k]
            u, v = (axis + 1) % 3, (axis + 2) % 3
            a, b, c = sign * rotation[j, 0, axis], sign * rotation[j, 1, axis], sign * rotation[j, 2, axis]
            twist[column, 0], twist[column, 1], twist[column, 2] = a, b, c
            twist[column, 3], twist[column, 4], twist[column, 5] = y * c - z * b, z * a - x * c, x * b - y * a
            sine, cosine = sign * np.sin(row[column]), np.cos(row[column])
            for i in range(3):
                first, second = rotation[j, i, u], rotation[j, i, v]
                rotation[j, i, u] = first * cosine + second * sine
                rotation[j, i, v] = second * cosine - first * sine


@njit(cache=True, nogil=True)
def _place(orientation: FloatArray, local: FloatArray, p: int, j: int, rotation: FloatArray, place: FloatArray) -> None:
    """Write the untouched rotation of joint `j` and where it is, below joint `p` (-1: the world)."""
    for a in range(3):
        if p < 0:
            place[j, a] = local[a]
            for b in range(3):
                rotation[j, a, b] = orientation[a, b]
            continue
        x, y, z = rotation[p, a, 0], rotation[p, a, 1], rotation[p, a, 2]
        place[j, a] = place[p, a] + x * local[0] + y * local[1] + z * local[2]
        for b in range(3):
            rotation[j, a, b] = x * orientation[0, b] + y * orientation[1, b] + z * orientation[2, b]


@njit(cache=True, nogil=True)
def _gather(body: Body, workspace: Workspace) -> None:
    """Sum up for each joint what it carries: orientations, points, Σr and the six of Σ r rᵀ."""
    rotation, place, moments = workspace.rotation, workspace.place, workspace.moments
    far = np.empty(3)
    for j in range(len(body.parent)):
        moments[j] = 0.0
        moments[j, 0] = ORIENTATION_REACH**2
        if body.weight[j] > 0.0:
            _add_point(moments[j], place[j], body.weight[j])
    for k in range(len(body.site_joint)):
        j = body.site_joint[k]
        x, y, z = body.site_offset[k, 0], body.site_offset[k, 1], body.site_offset[k, 2]
        for a in range(3):
            far[a] = place[j, a] + rotation[j, a, 0] * x + rotation[j, a, 1] * y + rotation[j, a, 2] * z
        _add_point(moments[j], far, 1.0)
    for j in range(len(body.parent) - 1, 0, -1):
        p = body.parent[j]
        if p >= 0:
            for a in range(11):
                moments[p, a] += moments[j, a]


@njit(cache=True, nogil=True)
def _add_point(moment: FloatArray, place: FloatArray, weight: float) -> None:
    x, y, z = place[0], place[1], place[2]
    moment[1] += weight
    moment[2] += weight * x
    moment[3] += weight * y
    moment[4] += weight * z
    moment[5] += weight * x * x
    moment[6] += weight * y * y
    moment[7] += weight * z * z
    moment[8] += weight * x * y
    moment[9] += weight * y * z
    moment[10] += weight * z * x


@njit(cache=True, nogil=True)
def _push(moment: FloatArray, twist: FloatArray, wrench: FloatArray) -> None:
    """Fill `wrench`, the turn's share and the move's, so that twist · wrench is what two columns do together."""
    a, b, c, u, v, w = twist[0], twist[1], twist[2], twist[3], twist[4], twist[5]
    reach, count, x, y, z = moment[0], moment[1], moment[2], moment[3], moment[4]
    xx, yy, zz, xy, yz, zx = moment[5], moment[6], moment[7], moment[8], moment[9], moment[10]
    wrench[0] = (yy + zz + reach) * a - xy * b - zx * c + y * w - z * v
    wrench[1] = (zz + xx + reach) * b - xy * a - yz * c + z * u - x * w
    wrench[2] = (xx + yy + reach) * c - zx * a - yz * b + x * v - y * u
    wrench[3] = count * u + b * z - c * y
    wrench[4] = count * v + c * x - a * z
    wrench[5] = count * w + a * y - b * x


@njit(cache=True, nogil=True)
def _work(twist: FloatArray, wrench: FloatArray) -> float:
    done: float = (
        twist[0] * wrench[0]
        + twist[1] * wrench[1]
        + twist[2] * wrench[2]
        + twist[3] * wrench[3]
        + twist[4] * wrench[4]
        + twist[5] * wrench[5]
    )  # fmt: skip
    return done
