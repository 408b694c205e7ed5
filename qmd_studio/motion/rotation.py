"""Rotation matrices from angles about principal axes, in plain NumPy."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray


def axis_rotation(axis: int, angle: FloatArray) -> FloatArray:
    """Return the matrices (..., 3, 3) that turn by `angle` (...) radians about x, y or z (`axis` 0, 1, 2)."""
    angle = np.asarray(angle, dtype=np.float64)
    cosine, sine = np.cos(angle), np.sin(angle)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((*angle.shape, 3, 3))
    matrix[..., axis, axis] = 1.0
    matrix[..., u, u] = matrix[..., v, v] = cosine
    matrix[..., u, v] = -sine
    matrix[..., v, u] = sine
    return matrix


def euler_matrix(angles: FloatArray, order: str) -> FloatArray:
    """Return the product of rotations (..., 3, 3), left to right in `order` ("zyx" gives Rz @ Ry @ Rx).

    `angles` (..., len(order)) are radians in the same order.
    """
    angles = np.asarray(angles, dtype=np.float64)
    matrix = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3))
    for position, letter in enumerate(order):
        matrix = matrix @ axis_rotation("xyz".index(letter), angles[..., position])
    return np.ascontiguousarray(matrix)


def between_quaternions(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    """Return quaternions (n, 4) at `share` (n, 1), 0 to 1, of the shorter way from one to another, at even speed.

    `first` and `second` (n, 4) are of unit length, their real part first or last alike.
    """
    cosine = (first * second).sum(axis=1, keepdims=True)
    second, cosine = np.where(cosine < 0, -second, second), np.minimum(np.abs(cosine), 1.0)
    angle = np.arccos(cosine)
    sine = np.sin(angle)
    near = sine < 1e-8
    safe = np.where(near, 1.0, sine)
    own = np.where(near, 1 - share, np.sin((1 - share) * angle) / safe)
    other = np.where(near, share, np.sin(share * angle) / safe)
    return np.asarray(own * first + other * second)
