"""A rotation written as turns about a joint's own axes, compiled: exact for three axes, as near as can be for fewer.

With axes i, j, k all different (parity s = +1 for xyz, yzx, zxy) R = Ri(a) Rj(b) Rk(c) has R[i,k] = s·sin b; with the
first axis once more, R = Ri(a) Rj(b) Ri(c) has R[i,i] = cos b. The same rotation is also (a+π, π-b, c+π), and for the
second kind (a+π, -b, c+π).
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled

_Rows: TypeAlias = NDArray[Any]

STRAIGHT = 0.02
"""Below about this bend, in radians, a hinge's own direction fades: a straight arm tells nothing of it."""
_OWN_TURN = 1e-3
_LOCKED = 1e-9
_FAR = 0.35


@compiled()
def turned(matrix: _Rows, axis: int, angle: float) -> None:
    """Multiply `matrix` (3, 3) from the right by a turn of `angle` about `axis`, in place."""
    s, c = np.sin(angle), np.cos(angle)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    for row in range(3):
        first, second = matrix[row, u], matrix[row, v]
        matrix[row, u] = first * c + second * s
        matrix[row, v] = second * c - first * s


@compiled()
def turned_back(matrix: _Rows, axis: int, angle: float, out: _Rows) -> None:
    """Fill `out` with the turn of -`angle` about `axis` times `matrix`."""
    s, c = np.sin(angle), np.cos(angle)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    for column in range(3):
        out[axis, column] = matrix[axis, column]
        out[u, column] = c * matrix[u, column] + s * matrix[v, column]
        out[v, column] = c * matrix[v, column] - s * matrix[u, column]


@compiled()
def principal(matrix: _Rows, axes: _Rows, inner: _Rows, angles: _Rows) -> None:
    """Fill `angles` (3,) with a, b, c for `matrix`; `axes` (3,) are i, j and i or the third one; `inner` is scratch."""
    i, j, last = axes[0], axes[1], axes[2]
    k = 3 - i - j
    s = 1.0 if (i + 1) % 3 == j else -1.0
    if last == i:
        y, x = matrix[j, i], -s * matrix[k, i]
        angles[0] = np.arctan2(y, x) if y * y + x * x > _LOCKED * _LOCKED else 0.0
        turned_back(matrix, i, angles[0], inner)
        angles[1] = np.arctan2(-s * inner[k, i], inner[i, i])
        angles[2] = np.arctan2(-s * inner[j, k], inner[j, j])
    else:
        y, x = -s * matrix[j, k], matrix[k, k]
        angles[0] = np.arctan2(y, x) if y * y + x * x > _LOCKED * _LOCKED else 0.0
        turned_back(matrix, i, angles[0], inner)
        angles[1] = np.arctan2(s * inner[i, k], inner[k, k])
        angles[2] = np.arctan2(s * inner[j, i], inner[j, j])


@compiled()
def other_branch(angles: _Rows, proper: bool, out: _Rows) -> None:
    """Fill `out` (3,) with the other triple of the same rotation."""
    out[0] = angles[0] + np.pi
    out[1] = -angles[1] if proper else np.pi - angles[1]
    out[2] = angles[2] + np.pi


@compiled()
def into(value: float, low: float, high: float) -> float:
    """Return `value` moved by whole turns to lie as near as can be to the middle of `low` and `high`."""
    middle = 0.0 if low < -1e9 or high > 1e9 else 0.5 * (low + high)
    return float(value - 2.0 * np.pi * np.round((value - middle) / (2.0 * np.pi)))


@compiled()
def outside(angles: _Rows, n: int, low: _Rows, high: _Rows) -> float:
    """Bring the first `n` of `angles` into range by whole turns; return by how much they stay outside, radians."""
    total = 0.0
    for a in range(n):
        angles[a] = into(angles[a], low[a], high[a])
        total += max(0.0, low[a] - angles[a]) + max(0.0, angles[a] - high[a])
    return total


@compiled()
def _turned_vector(axis: int, angle: float, vector: _Rows, out: _Rows) -> None:
    s, c = np.sin(angle), np.cos(angle)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    out[axis] = vector[axis]
    out[u] = c * vector[u] - s * vector[v]
    out[v] = s * vector[u] + c * vector[v]


@compiled()
def _pointed(way: _Rows, axes: _Rows, bone: _Rows, branch: float, angles: _Rows, scratch: _Rows) -> None:
    """Fill `angles` with a, b so that Ri(a) Rj(b) turns the unit vector `bone` to `way`; `branch` is 1 or -1."""
    i, j = axes[0], axes[1]
    k = 3 - i - j
    s = 1.0 if (i + 1) % 3 == j else -1.0
    reach = np.hypot(bone[i], bone[k])
    cosine = min(1.0, max(-1.0, way[i] / max(reach, 1e-12)))
    angles[1] = s * np.arctan2(bone[k], bone[i]) + branch * np.arccos(cosine)
    _turned_vector(j, angles[1], bone, scratch)
    angles[0] = s * (np.arctan2(way[k], way[j]) - np.arctan2(scratch[k], scratch[j]))
    angles[2] = 0.0


@compiled()
def _settled(matrix: _Rows, axes: _Rows, bone: _Rows, way: _Rows, scratch: _Rows, angles: _Rows) -> None:
    """Let the first turn of a nearly straight hinge fade, unless it holds all of the rotation as it is."""
    i, j = axes[0], axes[1]
    k = 3 - i - j
    s = 1.0 if (i + 1) % 3 == j else -1.0
    turned_back(matrix, i, angles[0], scratch[0])
    turned_back(scratch[0], j, angles[1], scratch[1])
    cosine = (scratch[1, 0, 0] + scratch[1, 1, 1] + scratch[1, 2, 2] - 1.0) / 2.0
    roll = np.arccos(min(1.0, max(-1.0, cosine)))
    foreign = min(1.0, max(0.0, (roll - _OWN_TURN) / (10.0 * _OWN_TURN)))
    bend = max(0.0, 1.0 - way[i] ** 2)
    angles[0] *= 1.0 - foreign * (1.0 - bend / (bend + STRAIGHT * STRAIGHT))
    _turned_vector(i, -angles[0], way, scratch[0, 0])
    angles[1] = s * (np.arctan2(scratch[0, 0, i], scratch[0, 0, k]) - np.arctan2(bone[i], bone[k]))


@compiled()
def _fit_pointing(
    matrix: _Rows, axes: _Rows, bone: _Rows, low: _Rows, high: _Rows, scratch: _Rows, angles: _Rows
) -> None:
    """Fill two of `angles` so that `bone` points where `matrix` turns it; what is left is a roll about the bone."""
    way, other = np.empty(3), np.empty(3)
    for a in range(3):
        way[a] = matrix[a, 0] * bone[0] + matrix[a, 1] * bone[1] + matrix[a, 2] * bone[2]
    _pointed(way, axes, bone, 1.0, angles, scratch[0, 0])
    _pointed(way, axes, bone, -1.0, other, scratch[0, 0])
    mine, its = outside(angles, 2, low, high), outside(other, 2, low, high)
    if abs(mine - its) > _FAR and abs(angles[1] - other[1]) > 2.0 * _FAR:
        better = its < mine
    else:
        better = abs(other[0]) < abs(angles[0])
    if better:
        angles[:] = other
    _settled(matrix, axes, bone, way, scratch, angles)
    outside(angles, 2, low, high)


@compiled()
def fit(
    matrix: _Rows, n: int, axes: _Rows, bone: _Rows, low: _Rows, high: _Rows, scratch: _Rows, angles: _Rows
) -> None:
    """Fill the first `n` of `angles` (3,) so that the turns about `axes` come as near to `matrix` as they can.

    Of equal ways the one within `low` and `high` is taken. Two axes whose third is the first again keep the way of the
    unit vector `bone` and give up the roll about it; other two give up a turn about the third, which is innermost.
    `scratch` is (2, 3, 3).
    """
    if n == 1:
        i = axes[0]
        u, v = (i + 1) % 3, (i + 2) % 3
        angles[0] = np.arctan2(matrix[v, u] - matrix[u, v], matrix[u, u] + matrix[v, v])
        outside(angles, 1, low, high)
        return
    if n == 2 and axes[2] == axes[0]:
        _fit_pointing(matrix, axes, bone, low, high, scratch, angles)
        return
    other = scratch[1, 0]
    principal(matrix, axes, scratch[0], angles)
    other_branch(angles, axes[2] == axes[0], other)
    mine, its = outside(angles, n, low, high), outside(other, n, low, high)
    if n == 2:  # the two differ by half a turn about what is given up
        better = abs(into(other[2], -1.0, 1.0)) < abs(into(angles[2], -1.0, 1.0))
    else:
        nearer = np.abs(other).sum() < np.abs(angles).sum() - 1e-12
        better = its < mine - 1e-9 or (its < mine + 1e-9 and nearer)
    if better:
        angles[:] = other


@compiled()
def follow(X: _Rows, columns: _Rows, signs: _Rows, axes: _Rows, low: _Rows, high: _Rows, keep: bool) -> None:
    """Choose in each frame of X (n_frames, n_columns), in place, the equal turns nearest to the frame before.

    `columns` (3,) are those of one joint in the order in which they multiply, with their `signs`. With
    `keep` a way outside the limits `low` and `high` of the angles is not taken.
    """
    n = 3
    proper = axes[2] == axes[0]
    before, plain, other = np.empty(3), np.zeros(3), np.zeros(3)
    s = 1.0 if (axes[0] + 1) % 3 == axes[1] else -1.0
    for a in range(n):
        before[a] = signs[a] * X[0, columns[a]]
    for frame in range(1, len(X)):
        for a in range(n):
            plain[a] = signs[a] * X[frame, columns[a]]
        if (
            n == 3 and not proper and abs(np.cos(plain[1])) < 1e-7 and not keep
        ):  # only the sum of the outer turns counts
            shift = before[0] - plain[0]
            plain[0] += shift
            plain[2] -= s * np.sign(np.sin(plain[1])) * shift
        other_branch(plain, proper, other)
        best, least = plain, np.inf
        for candidate in (plain, other):
            distance, wrong = 0.0, 0.0
            for a in range(n):
                if not keep:
                    candidate[a] -= 2.0 * np.pi * np.round((candidate[a] - before[a]) / (2.0 * np.pi))
                else:
                    candidate[a] = into(candidate[a], low[a], high[a])
                    wrong += max(0.0, low[a] - candidate[a]) + max(0.0, candidate[a] - high[a])
                distance += abs(candidate[a] - before[a])
            if wrong < 1e-9 and distance < least - 1e-12:
                best, least = candidate, distance
        for a in range(n):
            before[a] = best[a]
            X[frame, columns[a]] = signs[a] * best[a]
