"""A body's surface as the skin of an H-Anim figure: one Coordinate, at most four joints a vertex."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.formats.scene_graph import Node, Use

MOST_INFLUENCES = 4
"""More joints a vertex are not played by some viewers."""
_PALETTE = 1024


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The nodes of a skin, and which vertices (n,) follow which joints (n,) by which weights (n,)."""

    coordinate: Node | None
    normal: Node | None
    shape: Node | None
    vertex: IntArray
    joint: IntArray
    weight: FloatArray

    def influences(self, joint: int) -> list[tuple[str, Any]]:
        """Return the fields of a joint that say which points of the skin follow it."""
        first, last = np.searchsorted(self.joint, [joint, joint + 1])
        if first == last:
            return []
        return [("skinCoordIndex", self.vertex[first:last]), ("skinCoordWeight", self.weight[first:last])]


def skin_nodes(body: Body, new_name: Callable[[str], str]) -> Skin:
    """Return the skin of a body: nothing but an empty one where it has no faces."""
    surface = body.surface
    vertex, joint, weight = strongest(surface, len(body.skeleton.joints))
    if not len(surface.faces):
        return Skin(None, None, None, vertex[:0], joint[:0], weight[:0])
    coordinate = Node("Coordinate", new_name("skin_points"), [("point", exact(surface.vertices))])
    normal = Node("Normal", new_name("skin_normals"), [("vector", exact(surface.normals))])
    colours = np.clip(surface.colours.astype(np.float64), 0.0, 1.0) ** (1 / 2.2)
    faces = np.concatenate([surface.faces, np.full((len(surface.faces), 1), -1, dtype=np.int64)], axis=1).ravel()
    mesh = Node("IndexedFaceSet", new_name("skin_faces"))
    mesh.fields += [("creaseAngle", np.array([3.1416])), ("coordIndex", faces)]
    palette, which = np.unique(_rounded(colours), axis=0, return_inverse=True)
    if 1 < len(palette) <= _PALETTE:
        index = np.where(faces >= 0, which.ravel()[faces], -1)
        mesh.fields.append(("colorIndex", index))
    mesh.fields.append(("coord", Use(coordinate.name or "", coordinate)))
    mesh.fields.append(("normal", Use(normal.name or "", normal)))
    if len(palette) > 1:
        table = palette if len(palette) <= _PALETTE else _rounded(colours)
        mesh.fields.append(("color", Node("Color", None, [("color", table.ravel())])))
    material = Node("Material", None, [("diffuseColor", palette[0] if len(palette) == 1 else np.full(3, 0.8))])
    shape = Node("Shape", new_name("skin_shape"))
    shape.fields += [("appearance", Node("Appearance", None, [("material", material)])), ("geometry", mesh)]
    return Skin(coordinate, normal, shape, vertex, joint, weight)


def strongest(surface: Surface, n_joints: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Return (vertex, joint, weight), by joint, of the four strongest joints of each vertex.

    Where more are cut off, the four take over what those had. The share of the figure itself is left out: it is what
    the weights leave below 1.
    """
    joints, weights = surface.joints, np.where(surface.joints < n_joints, surface.weights, 0.0).astype(np.float64)
    if joints.shape[1] > MOST_INFLUENCES:
        order = np.argsort(-weights, axis=1, kind="stable")[:, :MOST_INFLUENCES]
        total = weights.sum(axis=1, keepdims=True)
        joints, weights = np.take_along_axis(joints, order, 1), np.take_along_axis(weights, order, 1)
        kept = weights.sum(axis=1, keepdims=True)
        weights = np.where(kept < total, weights * (total / np.where(kept > 0, kept, 1.0)), weights)
    vertex, column = np.nonzero(weights > 0)
    joint, weight = joints[vertex, column], weights[vertex, column]
    order = np.lexsort((vertex, joint))
    return vertex[order].astype(np.int64), joint[order], exact(weight[order].astype(np.float32))


def displacer_fields(displacer: Displacer) -> list[tuple[str, Any]]:
    """Return the fields of an HAnimDisplacer."""
    return [
        ("coordIndex", np.asarray(displacer.vertices, dtype=np.int64)),
        ("displacements", exact(displacer.displacements)),
        ("weight", np.array([displacer.weight])),
    ]


def exact(values: NDArray[Any]) -> FloatArray:
    """Return float32 numbers (flat) as the doubles of the fewest digits that read back as the same float32."""
    single = np.ascontiguousarray(values, dtype=np.float32).ravel()
    return np.array([float(word) for word in single.astype("U16").tolist()], dtype=np.float64) + 0.0


def _rounded(colours: FloatArray) -> FloatArray:
    """Return colours to nine decimals, finer than float32 can tell."""
    return np.round(colours, 9)
