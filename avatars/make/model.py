"""A figure put together: skin and pieces, what each triangle is made of, and which joints each vertex follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from avatars.make.dress import MATERIALS, dressed, limbs
from avatars.make.extras import pieces
from avatars.make.figure import Figure
from avatars.make.remesh import vertex_normals
from avatars.make.skinning import weights_of
from avatars.make.surface import build_field, half_mesh, mirrored

ALL_MATERIALS = (*MATERIALS, "nails", "eyes", "irises", "pupils")


@dataclass(frozen=True, slots=True)
class Model:
    """Points (n, 3) metres with normals, faces (m, 3) with a material each, weights (n, n_joints) of named joints.

    The first `n_skin` faces are the seamless skin, the others are pieces that follow one joint.
    """

    figure: Figure
    joints: list[str]
    points: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    materials: np.ndarray
    weights: np.ndarray
    n_skin: int


def make_model(figure: Figure) -> Model:
    """Return the finished figure."""
    field, _ = build_field(figure)
    half, half_faces = half_mesh(field, figure)
    half, material = dressed(half, half_faces, field, figure)
    limb = limbs(field.registers(half))
    points, faces, twin = mirrored(half, half_faces)
    normals = _evened(vertex_normals(points, faces), len(half), twin)
    joints, weights = weights_of(points, faces, figure, limb[twin])
    skin = Model(figure, joints, points, normals, faces, np.tile(material, 2), weights, len(faces))
    return _with_pieces(skin, pieces(field, figure))


def _evened(normals: np.ndarray, n_half: int, twin: np.ndarray) -> np.ndarray:
    """Return normals that are the same on both sides and look straight ahead in the middle."""
    flip = np.ones((len(normals), 3))
    flip[n_half:, 0] = -1
    result = normals[twin] * flip
    middle = np.bincount(twin, minlength=n_half)[:n_half] == 1
    result[:n_half][middle, 0] = 0
    return result / np.linalg.norm(result, axis=1, keepdims=True)


def _with_pieces(model: Model, extra) -> Model:
    points, normals, faces = [model.points], [model.normals], [model.faces]
    materials, weights = [model.materials], [model.weights]
    n = len(model.points)
    for piece in extra:
        points.append(piece.points)
        normals.append(vertex_normals(piece.points, piece.faces))
        faces.append(piece.faces + n)
        materials.append(np.array([ALL_MATERIALS.index(name) for name in piece.materials]))
        share = np.zeros((len(piece.points), len(model.joints)))
        share[:, model.joints.index(piece.joint)] = 1.0
        weights.append(share)
        n += len(piece.points)
    return Model(
        model.figure,
        model.joints,
        np.concatenate(points),
        np.concatenate(normals),
        np.concatenate(faces),
        np.concatenate(materials),
        np.concatenate(weights),
        model.n_skin,
    )
