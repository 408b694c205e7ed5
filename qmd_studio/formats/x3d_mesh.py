"""The surface of an X3D figure: meshes of segments, each following its joint, and the skin, following several."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Surface
from qmd_studio.errors import FormatError
from qmd_studio.formats.x3d_humanoid import Figure
from qmd_studio.formats.x3d_scene import MAX_DEPTH, Scene, integers, numbers, points, title, transform_matrix, vector
from qmd_studio.motion.skeleton import LARGEST

MAX_CORNERS = 600_000
"""A figure with more corners of triangles is refused: USE could make thousands of copies of one mesh."""
_SMOOTH_FROM = 0.5
"""Crease angles from here on, in radians, are shown with shared normals, smaller ones with flat faces."""
_INFLUENCES = 4
_GROUPS = frozenset({"Group", "StaticGroup", "Transform", "Anchor", "Collision", "Billboard", "HAnimSegment"})


@dataclass(slots=True)
class _Parts:
    """What has been gathered: arrays of every mesh, corner by corner."""

    scene: Scene
    vertices: list[FloatArray] = field(default_factory=list)
    normals: list[FloatArray] = field(default_factory=list)
    faces: list[IntArray] = field(default_factory=list)
    colours: list[FloatArray] = field(default_factory=list)
    joints: list[IntArray] = field(default_factory=list)
    weights: list[FloatArray] = field(default_factory=list)
    n_vertices: int = 0
    n_corners: int = 0
    not_shown: set[str] = field(default_factory=set)
    meshes: dict[int, tuple[FloatArray, IntArray]] = field(default_factory=dict)
    matrices: dict[int, FloatArray] = field(default_factory=dict)


def surface_of(scene: Scene, figure: Figure) -> tuple[Surface | None, tuple[str, ...]]:
    """Return the figure's surface at rest, None where it has no mesh, and notes on what is not shown.

    Raises `FormatError` for meshes that do not fit together.
    """
    parts = _Parts(scene)
    for joint, segment in figure.segments:
        for shape, matrix in _shapes(parts, segment, figure.space):
            _add(parts, shape, matrix, joint=joint)
    skin_coordinates = None
    skins = []
    for child, place in scene.children(figure.humanoid):
        if place == "skinCoord":
            skin_coordinates = child
        elif place == "skin":
            skins.append(child)
    influences = _influences(figure)
    for skin in skins:
        for shape, matrix in _shapes(parts, skin, figure.space):
            _add(parts, shape, matrix, joint=0, skin=skin_coordinates, influences=influences)
    notes = tuple(f"shapes of kind {kind} are not shown" for kind in sorted(parts.not_shown))
    return _surface(parts), notes


def _shapes(parts: _Parts, element: Element, matrix: FloatArray) -> Iterator[tuple[Element, FloatArray]]:
    """Yield the Shape elements under `element` with the matrix to metres, depth first; USE of USE may not go round."""
    waiting = [(element, matrix, 0)]
    while waiting:
        node, outer, depth = waiting.pop()
        if depth > MAX_DEPTH:
            raise FormatError("the scene uses itself", at=title(node))
        if node.tag == "Shape":
            yield node, outer
        elif node.tag in _GROUPS:
            inner = _usual(outer @ _matrix(parts, node), node) if node.tag == "Transform" else outer
            waiting.extend((child, inner, depth + 1) for child, _ in reversed(list(parts.scene.children(node))))
        elif node.tag in ("LOD", "Switch"):
            chosen = int(vector(node, "whichChoice", (-1.0,))[0]) if node.tag == "Switch" else 0
            options = [child for child, _ in parts.scene.children(node)]
            if 0 <= chosen < len(options):
                waiting.append((options[chosen], outer, depth + 1))


def _matrix(parts: _Parts, node: Element) -> FloatArray:
    """Return a Transform's matrix (4, 4), made once however often it is used."""
    if id(node) not in parts.matrices:
        parts.matrices[id(node)] = transform_matrix(node)
    return parts.matrices[id(node)]


def _usual(values: FloatArray, node: Element) -> FloatArray:
    """Return `values`; raises `FormatError` where scales upon scales have made them too large."""
    if not np.abs(values).max(initial=0.0) <= LARGEST:
        raise FormatError("a mesh is too large", at=title(node), wanted=f"at most {LARGEST:g} m in size")
    return values


def _add(
    parts: _Parts,
    shape: Element,
    matrix: FloatArray,
    *,
    joint: int,
    skin: Element | None = None,
    influences: tuple[IntArray, IntArray, FloatArray] | None = None,
) -> None:
    geometry = next(
        (child for child, _ in parts.scene.children(shape) if child.tag not in ("Appearance", "MetadataSet")), None
    )
    if geometry is None:
        return
    if geometry.tag != "IndexedFaceSet":
        parts.not_shown.add(str(geometry.tag)[:40])
        return
    positions, triangles = _mesh(parts, geometry)
    parts.n_corners += triangles.size
    if parts.n_corners > MAX_CORNERS:
        raise FormatError("the figure's meshes are too large", wanted=f"at most {MAX_CORNERS} corners of triangles")
    if not triangles.size:
        return
    positions = _usual(positions @ matrix[:3, :3].T + matrix[:3, 3], geometry)
    joints, weights = _rigid(joint, len(positions))
    if influences is not None and skin is not None and parts.scene.child(geometry, "Coordinate") is skin:
        joints, weights = _strongest(*influences, n_points=len(positions))
    used = triangles.ravel()
    if float(vector(geometry, "creaseAngle", (0.0,))[0]) >= _SMOOTH_FROM:
        kept, corners = np.unique(used, return_inverse=True)
    else:
        kept, corners = used, np.arange(len(used))
    faces = corners.reshape(-1, 3).astype(np.int64)
    parts.vertices.append(positions[kept])
    parts.normals.append(_normals(positions[kept], faces))
    parts.faces.append(faces + parts.n_vertices)
    parts.colours.append(np.tile(_colour(parts.scene, shape), (len(kept), 1)))
    parts.joints.append(joints[kept])
    parts.weights.append(weights[kept])
    parts.n_vertices += len(kept)


def _mesh(parts: _Parts, geometry: Element) -> tuple[FloatArray, IntArray]:
    """Return an IndexedFaceSet's points (n, 3) and triangles (m, 3), polygons cut into fans; parsed once."""
    known = parts.meshes.get(id(geometry))
    if known is not None:
        return known
    coordinate = parts.scene.child(geometry, "Coordinate")
    positions = points(coordinate, "point") if coordinate is not None else np.zeros((0, 3))
    index = integers(geometry, "coordIndex")
    if len(index) and not -1 <= index.min() <= index.max() < len(positions):
        got = f"{index.min()} to {index.max()}"
        raise FormatError(
            "a face has a point that does not exist", at=title(geometry), wanted=f"below {len(positions)}", got=got
        )
    triangles = _fans(index)
    if geometry.get("ccw") == "false":
        triangles = triangles[:, ::-1]
    parts.meshes[id(geometry)] = positions, triangles
    return positions, triangles


def _fans(index: IntArray) -> IntArray:
    """Return triangles (m, 3) of polygons (n,) that end with -1: first corner, and each two that follow each other."""
    polygon = np.concatenate([[0], np.cumsum(index[:-1] == -1)]) if len(index) else np.zeros(0, dtype=np.int64)
    corner = index != -1
    index, polygon = index[corner], polygon[corner]
    if len(index) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    starts = np.flatnonzero(np.concatenate([[True], polygon[1:] != polygon[:-1]]))
    first = np.repeat(starts, np.diff(np.append(starts, len(index))))
    second = np.flatnonzero((polygon[1:] == polygon[:-1]) & (first[:-1] != np.arange(len(index) - 1)))
    return np.stack([index[first[second]], index[second], index[second + 1]], axis=1)


def _normals(positions: FloatArray, faces: IntArray) -> FloatArray:
    """Return unit normals (n, 3), faces weighing by their area; a point of no area looks up."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    total = np.zeros_like(positions)
    for k in range(3):
        np.add.at(total, faces[:, k], normal)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.where(length > 0, length, 1.0), [0.0, 1.0, 0.0])


def _colour(scene: Scene, shape: Element) -> FloatArray:
    """Return the shape's colour as linear light (3,), 0 to 1."""
    appearance = scene.child(shape, "Appearance")
    material = scene.child(appearance, "Material", "PhysicalMaterial") if appearance is not None else None
    colour = np.full(3, 0.8)
    if material is not None:
        name = "baseColor" if material.tag == "PhysicalMaterial" else "diffuseColor"
        colour = vector(material, name, (0.8, 0.8, 0.8))
    return np.asarray(np.clip(colour, 0.0, 1.0) ** 2.2)


def _rigid(joint: int, n_points: int) -> tuple[IntArray, FloatArray]:
    """Return joints and weights (n_points, 4) of points that follow one joint."""
    joints = np.zeros((n_points, _INFLUENCES), dtype=np.int64)
    weights = np.zeros((n_points, _INFLUENCES))
    joints[:, 0], weights[:, 0] = joint, 1.0
    return joints, weights


def _influences(figure: Figure) -> tuple[IntArray, IntArray, FloatArray]:
    """Return (point, joint, weight) of every entry in the joints' skinCoordIndex; a missing weight is 1."""
    point, joint, weight = [], [], []
    for number, element in enumerate(figure.elements):
        index = integers(element, "skinCoordIndex")
        given = numbers(element, "skinCoordWeight")[: len(index)]
        point.append(index)
        joint.append(np.full(len(index), number, dtype=np.int64))
        weight.append(np.concatenate([given, np.ones(len(index) - len(given))]))
    return np.concatenate(point), np.concatenate(joint), np.concatenate(weight)


def _strongest(point: IntArray, joint: IntArray, weight: FloatArray, *, n_points: int) -> tuple[IntArray, FloatArray]:
    """Return joints and weights (n_points, 4): the strongest four, summing to 1; points of no joint follow the root."""
    good = (point >= 0) & (point < n_points) & (weight > 0)
    point, joint, weight = point[good], joint[good], weight[good]
    order = np.lexsort((-weight, point))
    point, joint, weight = point[order], joint[order], weight[order]
    rank = np.arange(len(point)) - np.searchsorted(point, point)
    kept = rank < _INFLUENCES
    joints = np.zeros((n_points, _INFLUENCES), dtype=np.int64)
    weights = np.zeros((n_points, _INFLUENCES))
    joints[point[kept], rank[kept]] = joint[kept]
    weights[point[kept], rank[kept]] = weight[kept]
    weights[weights.sum(axis=1) == 0, 0] = 1.0
    return joints, weights / weights.sum(axis=1, keepdims=True)


def _surface(parts: _Parts) -> Surface | None:
    if not parts.vertices:
        return None
    return Surface(
        vertices=np.concatenate(parts.vertices).astype(np.float32),
        normals=np.concatenate(parts.normals).astype(np.float32),
        faces=np.concatenate(parts.faces),
        colours=np.concatenate(parts.colours).astype(np.float32),
        joints=np.concatenate(parts.joints),
        weights=np.concatenate(parts.weights).astype(np.float32),
    )
