"""Skinning on the processor: the formula that the graphics card evaluates, for tests, picking, framing and export."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Body, Displacer, Surface


def skin_matrices(body: Body, world_from_joint: FloatArray, world_from_figure: FloatArray | None = None) -> FloatArray:
    """Return what moves a vertex from the binding pose to this one, (n_joints + 1, 4, 4), the figure's own last.

    `world_from_joint` (n_joints, 4, 4) is the pose; `world_from_figure` (4, 4) is where the figure's own space stands
    in it, the identity if None.
    """
    moved = np.asarray(world_from_joint, dtype=np.float64) @ np.linalg.inv(body.bind)
    figure = np.eye(4) if world_from_figure is None else np.asarray(world_from_figure, dtype=np.float64)
    return np.concatenate([moved, figure[None]])


def rest_weights(body: Body) -> FloatArray:
    """Return the weights of the body's displacers as its file has them, (n_displacers,)."""
    return np.array([displacer.weight for displacer in body.displacers], dtype=np.float64)


def skinned(
    surface: Surface, matrices: FloatArray, displacers: Sequence[Displacer] = (), weights: ArrayLike = ()
) -> tuple[FloatArray, FloatArray]:
    """Return the posed vertices (V, 3), metres, and unit normals (V, 3).

    `matrices` are those of `skin_matrices`. The displacers move vertices first, each by its weight; then a vertex goes
    to sum(weight * matrix @ vertex), and its normal is turned by the inverse transpose of that sum of matrices.
    """
    vertices, normals = displaced(surface, displacers, weights)
    blended = blended_matrices(surface.joints, surface.weights, matrices)
    posed = np.einsum("vij,vj->vi", blended[:, :, :3], vertices) + blended[:, :, 3]
    return posed, turned_normals(blended[:, :, :3], normals)


def blended_matrices(joints: IntArray, weights: ArrayLike, matrices: FloatArray) -> FloatArray:
    """Return each vertex's own matrix, the upper three rows (V, 3, 4), from its joints and weights (V, K)."""
    weights = np.asarray(weights, dtype=np.float64)
    rows = np.asarray(matrices, dtype=np.float64)[:, :3]
    result = np.zeros((len(joints), 3, 4))
    for k in range(joints.shape[1]):
        used = np.flatnonzero(weights[:, k])
        result[used] += weights[used, k, None, None] * rows[joints[used, k]]
    return result


def turned_normals(turns: FloatArray, normals: FloatArray) -> FloatArray:
    """Return unit normals (V, 3) under the linear maps `turns` (V, 3, 3).

    The cofactor matrix stands for the inverse transpose: it differs by the determinant only, so that a map that
    flattens is no division by zero.
    """
    x, y, z = turns[:, 0], turns[:, 1], turns[:, 2]
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    turned = np.einsum("vij,vj->vi", cofactors, normals)
    turned *= np.where(np.einsum("vi,vi->v", x, cofactors[:, 0]) < 0, -1.0, 1.0)[:, None]
    return np.asarray(turned / np.maximum(np.linalg.norm(turned, axis=1), 1e-30)[:, None])


def displaced(surface: Surface, displacers: Sequence[Displacer], weights: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return vertices and unit normals (V, 3) in the binding pose after the displacers, each by its weight.

    The normals near what moved turn as those of the bare triangles do, so that creases stay where the surface has them.
    """
    vertices = surface.vertices.astype(np.float64)
    normals = surface.normals.astype(np.float64)
    active = [(d, w) for d, w in zip(displacers, np.asarray(weights, dtype=np.float64), strict=True) if w]
    if not active:
        return vertices, normals
    for displacer, weight in active:
        np.add.at(vertices, displacer.vertices, weight * displacer.displacements.astype(np.float64))
    moved = np.zeros(len(vertices), dtype=bool)
    moved[np.concatenate([displacer.vertices for displacer, _ in active])] = True
    faces = surface.faces[moved[surface.faces].any(axis=1)]
    touched = np.unique(faces)
    change = _face_normals(vertices, faces) - _face_normals(surface.vertices.astype(np.float64), faces)
    turned = normals[touched] + change[touched]
    normals[touched] = turned / np.maximum(np.linalg.norm(turned, axis=1), 1e-30)[:, None]
    return vertices, normals


def _face_normals(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """The unit normals (V, 3) that the triangles alone give, each by its area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    sums = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(sums, faces[:, k], areas)
    return np.asarray(sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-30)[:, None])
