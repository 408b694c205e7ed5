"""Colours and normals of a mesh: those that the file gives, else a material's colour and normals reckoned by area."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.formats.hanim_geometry import Mesh
from qmd_studio.formats.hanim_view import View, flag, integers, kind_of, numbers, raw_numbers, vector
from qmd_studio.formats.scene_graph import Node

_GREY = (0.8, 0.8, 0.8)


def corner_colours(view: View, shape: Node, geometry: Node, mesh: Mesh) -> FloatArray:
    """Return the colour of each corner as linear light (m, 3, 3), 0 to 1; (1, 1, 3) where all are the same."""
    node = view.child(geometry, "Color", "ColorRGBA")
    if node is not None:
        width = 4 if kind_of(node) == "ColorRGBA" else 3
        values = numbers(node, "color")
        table = values[: len(values) // width * width].reshape(-1, width)[:, :3]
        place = _places(view, geometry, node, mesh, ("colorIndex", "colorPerVertex", len(table)))
        if place is not None:
            return _linear(table)[place]
    return _linear(_material(view, shape))[None, None]


def corner_normals(view: View, geometry: Node, mesh: Mesh) -> FloatArray | None:
    """Return the normals (m, 3, 3) that the file gives its corners, of unit length; None where it gives none."""
    node = view.child(geometry, "Normal")
    if node is None:
        return None
    values = raw_numbers(node, "vector")
    table = values[: len(values) // 3 * 3].reshape(-1, 3)
    with np.errstate(over="ignore"):  # a length beyond all numbers is no direction either
        length = np.linalg.norm(table, axis=1)
    if not (np.isfinite(length) & (length > 0)).all():
        view.warn(node, "some normals have no direction; all are reckoned anew")
        return None
    place = _places(view, geometry, node, mesh, ("normalIndex", "normalPerVertex", len(table)))
    unit = np.where(np.abs(length - 1) < 1e-6, 1.0, length)[:, None]
    return None if place is None else (table / unit)[place]


def _places(view: View, geometry: Node, node: Node, mesh: Mesh, names: tuple[str, str, int]) -> IntArray | None:
    """Return which entry of a table of colours or normals each corner has (m, 3); None where the table is too short."""
    index_name, per_vertex_name, count = names
    index = integers(geometry, index_name)
    if flag(geometry, per_vertex_name, True):
        if len(index):
            wanted = mesh.corners
        else:
            index, wanted = np.arange(count), mesh.triangles
    else:
        index = index if len(index) else np.arange(count)
        wanted = np.repeat(mesh.polygons[:, None], 3, axis=1)
    if wanted.size and wanted.max() >= len(index):
        view.warn(node, f"it has fewer entries ({len(index)}) than are asked for; it is left out")
        return None
    place = index[wanted]
    if place.size and (place.min() < 0 or place.max() >= count):
        view.warn(node, f"{index_name} asks for entries that do not exist; it is left out")
        return None
    return place


def _material(view: View, shape: Node) -> FloatArray:
    appearance = view.child(shape, "Appearance")
    material = view.child(appearance, "Material", "PhysicalMaterial", "UnlitMaterial") if appearance else None
    if material is None:
        return np.array(_GREY)
    name = {"PhysicalMaterial": "baseColor", "UnlitMaterial": "emissiveColor"}.get(kind_of(material), "diffuseColor")
    return vector(material, name, (1.0, 1.0, 1.0) if name != "diffuseColor" else _GREY)


def _linear(colour: FloatArray) -> FloatArray:
    return np.asarray(np.clip(colour, 0.0, 1.0) ** 2.2)
