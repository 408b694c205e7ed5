"""Normals of a mesh that has none of its own."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray


def area_normals(positions: FloatArray, faces: IntArray) -> FloatArray:
    """Return unit normals (n, 3), faces weighing by their area; a point of no area looks up."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    corners = faces.ravel()
    total = np.stack(
        [np.bincount(corners, np.repeat(normal[:, axis], 3), minlength=len(positions)) for axis in range(3)], axis=1
    )
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.where(length > 0, length, 1.0), [0.0, 1.0, 0.0])
