"""The geometry nodes of X3D as triangles: face sets, triangle sets, strips and fans, and the four solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_solids import SOLIDS
from qmd_studio.formats.hanim_view import View, flag, integers, kind_of, number, raw_numbers, wrong
from qmd_studio.formats.scene_graph import Node, title
from qmd_studio.motion.skeleton import LARGEST

GEOMETRIES = frozenset(
    {
        "IndexedFaceSet",
        "IndexedTriangleSet",
        "TriangleSet",
        "IndexedTriangleStripSet",
        "TriangleStripSet",
        "IndexedTriangleFanSet",
        "TriangleFanSet",
        *SOLIDS,
    }
)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A geometry: `points` (n, 3) in its own units, `triangles` (m, 3) point numbers.

    `corners` (m, 3) are the places in the geometry's index that the triangles' corners came from, `polygons` (m,) the
    faces they are of: by these, colours and normals are found. `crease` is the crease angle in radians, below which
    neighbouring faces share their normals. `coordinate` is the node of the points, None for a solid.
    """

    points: FloatArray
    triangles: IntArray
    corners: IntArray
    polygons: IntArray
    crease: float
    coordinate: Node | None


def mesh_of(view: View, node: Node) -> Mesh | None:
    """Return the triangles of a geometry node; None, with a warning, where too little of it is right.

    Raises `FormatError` for a face with a point that does not exist.
    """
    kind = kind_of(node)
    if kind in SOLIDS:
        points, triangles, crease = SOLIDS[kind](node)
        m = np.arange(len(triangles))
        return Mesh(points, triangles, triangles, m, crease, None)
    coordinate = view.child(node, "Coordinate", "CoordinateDouble")
    points = positions_of(view, coordinate) if coordinate is not None else np.zeros((0, 3))
    if kind == "IndexedFaceSet":
        index = integers(node, "coordIndex")
        corners, polygons = fans(index)
    else:
        index, corners, polygons = _set(node, kind, len(points))
    triangles = _looked_up(view, node, index, corners, len(points))
    kept: BoolArray = np.logical_and.reduce(triangles >= 0, axis=1)
    whole: BoolArray = np.logical_and.reduce(np.isfinite(points), axis=1)
    if not whole.all():
        view.warn(coordinate or node, f"{int((~whole).sum())} points are not finite; faces with them are left out")
        kept &= whole[np.where(kept[:, None], triangles, 0)].all(axis=1)
        points = np.where(whole[:, None], points, 0.0)
    if not kept.all():
        triangles, corners, polygons = triangles[kept], corners[kept], polygons[kept]
    if not flag(node, "ccw", True):
        triangles, corners = triangles[:, ::-1], corners[:, ::-1]
    usual = 0.0 if kind == "IndexedFaceSet" else np.pi if flag(node, "normalPerVertex", True) else 0.0
    return Mesh(points, triangles, corners, polygons, number(node, "creaseAngle", usual), coordinate)


def positions_of(view: View, coordinate: Node) -> FloatArray:
    """Return a Coordinate's points (n, 3); those that are not finite stay so."""
    values = raw_numbers(coordinate, "point")
    if len(values) % 3:
        raise wrong(coordinate, "point", "three numbers a point", str(len(values)))
    if (np.abs(values) > LARGEST).any() and np.isfinite(values).all():
        raise wrong(coordinate, "point", "numbers of a usual size", "one that is not")
    return values.reshape(-1, 3)


def fans(index: IntArray) -> tuple[IntArray, IntArray]:
    """Return corners (m, 3), places in `index`, and polygon numbers (m,): polygons that end with -1, cut into fans."""
    polygon = np.concatenate([[0], np.cumsum(index[:-1] == -1)]) if len(index) else np.zeros(0, dtype=np.int64)
    place = np.flatnonzero(index != -1)
    polygon = polygon[place]
    if len(place) < 3:
        return np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    starts = np.flatnonzero(np.concatenate([[True], polygon[1:] != polygon[:-1]]))
    first = np.repeat(starts, np.diff(np.append(starts, len(place))))
    second = np.flatnonzero((polygon[1:] == polygon[:-1]) & (first[:-1] != np.arange(len(place) - 1)))
    return np.stack([place[first[second]], place[second], place[second + 1]], axis=1), polygon[second]


def _strips(index: IntArray) -> tuple[IntArray, IntArray]:
    """Return corners and polygon numbers of strips that end with -1; every other triangle is turned round."""
    strip = np.concatenate([[0], np.cumsum(index[:-1] == -1)]) if len(index) else np.zeros(0, dtype=np.int64)
    place = np.flatnonzero(index != -1)
    strip = strip[place]
    if len(place) < 3:
        return np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    first = np.flatnonzero(strip[2:] == strip[:-2])
    starts = np.flatnonzero(np.concatenate([[True], strip[1:] != strip[:-1]]))
    odd = (first - starts[np.searchsorted(starts, first, side="right") - 1]) % 2 == 1
    second, third = np.where(odd, first + 2, first + 1), np.where(odd, first + 1, first + 2)
    return np.stack([place[first], place[second], place[third]], axis=1), np.arange(len(first))


def _set(node: Node, kind: str, n_points: int) -> tuple[IntArray, IntArray, IntArray]:
    """Return the index, corners and polygons of a triangle, strip or fan set, indexed or not."""
    if kind in ("TriangleSet", "IndexedTriangleSet"):
        index = integers(node, "index") if kind.startswith("Indexed") else np.arange(n_points)
        index = index[index != -1] if len(index) and -1 in index else index
        whole = len(index) // 3
        return index, np.arange(3 * whole).reshape(-1, 3), np.arange(whole)
    if kind.startswith("Indexed"):
        index = integers(node, "index")
    else:
        counts = integers(node, "stripCount" if "Strip" in kind else "fanCount")
        total = int(counts.sum()) if len(counts) and counts.min() >= 0 else -1
        if total > n_points or (len(counts) and counts.min() < 3):
            raise FormatError(
                "a strip has points that do not exist", at=title(node), wanted=f"at most {n_points}", got=str(total)
            )
        index = np.insert(np.arange(max(total, 0)), np.cumsum(counts), -1) if total > 0 else np.zeros(0, dtype=np.int64)
    return index, *(_strips(index) if "Strip" in kind else fans(index))


def _looked_up(view: View, node: Node, index: IntArray, corners: IntArray, n_points: int) -> IntArray:
    """Return the point numbers of `corners`; -1, with a warning, where none exists."""
    triangles = index[corners] if len(corners) else np.zeros((0, 3), dtype=np.int64)
    bad = (triangles < 0) | (triangles >= n_points)
    if bad.any():
        faces = int(bad.any(axis=1).sum())
        if faces == len(triangles):
            got = f"{index.min()} to {index.max()}"
            message = "a face has a point that does not exist"
            raise FormatError(message, at=title(node), wanted=f"0 to {n_points - 1}", got=got)
        view.warn(node, f"{faces} faces have a point that does not exist; they are left out")
        triangles = np.where(bad, -1, triangles)
    return triangles
