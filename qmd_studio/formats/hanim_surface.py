"""The surface of an H-Anim figure: shapes of segments, each following its joint, and the skin, following several."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.area_normals import area_normals
from qmd_studio.avatar.humanoid import Surface
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_figure import Figure
from qmd_studio.formats.hanim_geometry import GEOMETRIES, Mesh, mesh_of, positions_of
from qmd_studio.formats.hanim_shading import corner_colours, corner_normals
from qmd_studio.formats.hanim_skin import Binding, rigid_binding, skin_binding
from qmd_studio.formats.hanim_view import View, applied, kind_of, number, transform_matrix
from qmd_studio.formats.scene_graph import MAX_DEPTH, Node, title
from qmd_studio.motion.skeleton import LARGEST

MAX_CORNERS = 600_000
MAX_PARTS = 8_000
"""A figure of more corners of triangles or meshes is refused: USE could make thousands of copies of one mesh."""
_SMOOTH_FROM = 0.5
"""Crease angles from here on, in radians, are shown with shared normals, smaller ones with flat faces."""
_GROUPS = frozenset(
    {"Group", "StaticGroup", "Transform", "Anchor", "Collision", "Billboard", "HAnimSegment", "HAnimSite", "Inline"}
)


@dataclass(slots=True, eq=False)
class Part:
    """One shape's share of the surface: which points of which Coordinate its vertices are, and under what matrix."""

    coordinate: Node | None
    points: IntArray
    first: int
    linear: FloatArray
    joint: int
    """The joint of the segment it stands in; -1 for the skin."""


@dataclass(slots=True)
class Gathered:
    """What has been gathered: arrays of every shape, vertex by vertex, and where each came from."""

    view: View
    figure: Figure
    vertices: list[FloatArray] = field(default_factory=list)
    normals: list[FloatArray] = field(default_factory=list)
    faces: list[IntArray] = field(default_factory=list)
    colours: list[FloatArray] = field(default_factory=list)
    bindings: list[Binding] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    n_vertices: int = 0
    n_corners: int = 0
    not_shown: set[str] = field(default_factory=set)
    meshes: dict[int, Mesh | None] = field(default_factory=dict)
    matrices: dict[int, FloatArray] = field(default_factory=dict)
    skin_bindings: dict[int, Binding] = field(default_factory=dict)


def gather(view: View, figure: Figure) -> Gathered:
    """Return the figure's shapes as vertices at rest. Raises `FormatError` for meshes that do not fit together."""
    gathered = Gathered(view, figure)
    for joint, segment in figure.segments:
        for shape, matrix in _shapes(gathered, segment, figure.space):
            _add(gathered, shape, matrix, joint)
    skins = []
    for place, child in view.children(figure.humanoid):
        if place == "skin" or (place == "humanoidBody" and kind_of(child) in ("Shape", "Group", "Transform", "LOD")):
            skins.append(child)
    for skin in skins:
        for shape, matrix in _shapes(gathered, skin, figure.space):
            _add(gathered, shape, matrix, -1)
    if gathered.not_shown:
        view.notes.append(f"not shown: {', '.join(sorted(gathered.not_shown))}")
    return gathered


def skin_coordinate(view: View, figure: Figure) -> Node | None:
    """Return the Coordinate that the joints' skinCoordIndex counts in."""
    found = [
        (place, child)
        for place, child in view.children(figure.humanoid)
        if kind_of(child) in ("Coordinate", "CoordinateDouble")
    ]
    return next((child for place, child in found if place == "skinCoord"), found[0][1] if found else None)


def surface_of(gathered: Gathered) -> Surface | None:
    """Return the surface of what was gathered, None where there is no triangle."""
    if not gathered.vertices:
        return None
    width = max(binding.joints.shape[1] for binding in gathered.bindings)
    joints = np.zeros((gathered.n_vertices, width), dtype=np.int64)
    weights = np.zeros((gathered.n_vertices, width), dtype=np.float32)
    for part, binding in zip(gathered.parts, gathered.bindings, strict=True):
        rows = slice(part.first, part.first + len(part.points))
        joints[rows, : binding.joints.shape[1]] = binding.joints
        weights[rows, : binding.joints.shape[1]] = binding.weights
    return Surface(
        vertices=np.concatenate(gathered.vertices).astype(np.float32),
        normals=np.concatenate(gathered.normals).astype(np.float32),
        faces=np.concatenate(gathered.faces),
        colours=np.concatenate(gathered.colours).astype(np.float32),
        joints=joints,
        weights=weights,
    )


def _shapes(gathered: Gathered, node: Node, matrix: FloatArray) -> Iterator[tuple[Node, FloatArray]]:
    """Yield the Shapes under `node` with the matrix to metres, depth first."""
    view = gathered.view
    waiting = [(node, matrix, 0)]
    while waiting:
        item, outer, depth = waiting.pop()
        kind = kind_of(item)
        if depth > MAX_DEPTH:
            raise FormatError("the scene uses itself", at=title(item))
        if kind == "Shape":
            yield item, outer
        elif kind in _GROUPS:
            inner = outer
            if kind in ("Transform", "HAnimSite"):
                if id(item) not in gathered.matrices:
                    gathered.matrices[id(item)] = transform_matrix(item)
                inner = _usual(outer @ gathered.matrices[id(item)], item)
            waiting.extend((child, inner, depth + 1) for _, child in reversed(list(view.children(item))))
        elif kind in ("LOD", "Switch"):
            chosen = int(number(item, "whichChoice", -1.0)) if kind == "Switch" else 0
            options = [child for place, child in view.children(item) if place in ("children", "choice", "level")]
            if 0 <= chosen < len(options):
                waiting.append((options[chosen], outer, depth + 1))
        elif item.proto or kind in ("Script",):
            gathered.not_shown.add(kind[:40])


def _usual(values: FloatArray, node: Node) -> FloatArray:
    """Return `values`; raises `FormatError` where scales upon scales have made them too large."""
    if not np.abs(values).max(initial=0.0) <= LARGEST:
        raise FormatError("a mesh is too large", at=title(node), wanted=f"at most {LARGEST:g} m in size")
    return values


def _geometry(gathered: Gathered, shape: Node) -> tuple[Node, Mesh] | None:
    view = gathered.view
    for place, child in view.children(shape):
        if place == "appearance" or place == "metadata":
            continue
        if kind_of(child) not in GEOMETRIES:
            gathered.not_shown.add(child.type[:40])
            return None
        if id(child) not in gathered.meshes:
            gathered.meshes[id(child)] = mesh_of(view, child)
        mesh = gathered.meshes[id(child)]
        return (child, mesh) if mesh is not None else None
    return None


def _add(gathered: Gathered, shape: Node, matrix: FloatArray, joint: int) -> None:
    found = _geometry(gathered, shape)
    if found is None:
        return
    geometry, mesh = found
    if len(gathered.parts) >= MAX_PARTS:
        raise FormatError("the figure has too many meshes", wanted=f"at most {MAX_PARTS}")
    gathered.n_corners += mesh.triangles.size
    if gathered.n_corners > MAX_CORNERS:
        raise FormatError("the figure's meshes are too large", wanted=f"at most {MAX_CORNERS} corners of triangles")
    if not mesh.triangles.size:
        return
    figure = gathered.figure
    positions = _usual(applied(matrix, mesh.points), geometry)
    binding = rigid_binding(joint, len(positions)) if joint >= 0 else _skin(gathered, mesh)
    positions = _stretched(figure, positions, binding)
    kept, faces, colours, normals = _vertices(gathered.view, shape, geometry, mesh)
    own = positions[kept]
    if normals is None:
        normals = area_normals(own, faces)
    else:
        turned = normals @ np.linalg.pinv(matrix[:3, :3])
        length = np.linalg.norm(turned, axis=1, keepdims=True)
        same = np.abs(length - 1) < 1e-6
        normals = turned / np.where(same | (length == 0), 1.0, length)
    gathered.vertices.append(own)
    gathered.normals.append(normals)
    gathered.faces.append(faces + gathered.n_vertices)
    gathered.colours.append(np.broadcast_to(colours, own.shape))
    gathered.bindings.append(Binding(binding.joints[kept], binding.weights[kept]))
    gathered.parts.append(Part(mesh.coordinate, kept, gathered.n_vertices, matrix[:3, :3], joint))
    gathered.n_vertices += len(kept)


def _vertices(
    view: View, shape: Node, geometry: Node, mesh: Mesh
) -> tuple[IntArray, IntArray, FloatArray, FloatArray | None]:
    """Return the points (V,) that become vertices, faces (m, 3), colours (V, 3) and normals (V, 3) if given.

    A point is one vertex where its corners have one colour and normal; else every corner is a vertex of its own.
    """
    colours = corner_colours(view, shape, geometry, mesh)
    normals = corner_normals(view, geometry, mesh)
    used = mesh.triangles.ravel()
    smooth = normals is not None or mesh.crease >= _SMOOTH_FROM
    if smooth:
        kept, first, corners = np.unique(used, return_index=True, return_inverse=True)
        shared = [values.reshape(-1, 3) for values in (colours, normals) if values is not None and values.size > 3]
        if all((values[first][corners] == values).all() for values in shared):
            flat = colours.reshape(-1, 3)
            return (
                kept,
                corners.reshape(-1, 3).astype(np.int64),
                flat if len(flat) == 1 else flat[first],
                None if normals is None else normals.reshape(-1, 3)[first],
            )
    faces = np.arange(len(used)).reshape(-1, 3)
    return used, faces, colours.reshape(-1, 3), None if normals is None else normals.reshape(-1, 3)


def _skin(gathered: Gathered, mesh: Mesh) -> Binding:
    """Return what a skin's points follow: as the joints say where they are the humanoid's skinCoord."""
    view, figure = gathered.view, gathered.figure
    coordinate = skin_coordinate(view, figure)
    own = mesh.coordinate
    n_points = len(mesh.points)
    if own is not None and own is not coordinate:
        if coordinate is None:
            view.warn(figure.humanoid, "it has no skinCoord; the joints are taken to count in the skin's own points")
        elif _equal(view, own, coordinate):
            view.warn(own, "it is a copy of skinCoord and not that very node (USE); it is taken for it")
        else:
            view.warn(own, "it is a skin on other points than skinCoord; it stays at rest")
            own = None
    if own is None:
        return rigid_binding(len(figure.joints), n_points)
    if id(own) not in gathered.skin_bindings:
        gathered.skin_bindings[id(own)] = skin_binding(view, figure, n_points)
    return gathered.skin_bindings[id(own)]


def _equal(view: View, a: Node, b: Node) -> bool:
    return np.array_equal(positions_of(view, a), positions_of(view, b))


def _stretched(figure: Figure, positions: FloatArray, binding: Binding) -> FloatArray:
    """Return rest positions with the joints' scales taken in, by the formula that also skins."""
    if figure.stretch is None:
        return positions
    to_metres = figure.space
    back = np.linalg.inv(to_metres)
    chain = np.concatenate([to_metres @ figure.stretch @ back, np.eye(4)[None]])
    moved = np.einsum("nkij,nj->nki", chain[binding.joints][..., :3, :3], positions) + chain[binding.joints][..., :3, 3]
    rest = 1 - binding.weights.sum(axis=1, keepdims=True)
    return np.asarray((binding.weights[..., None] * moved).sum(axis=1) + rest * positions)
