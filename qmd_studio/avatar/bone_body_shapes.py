"""Closed rounded shapes for bodies made from bones: tubes of rings, ellipsoids, and the list that gathers them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Surface

_Number = TypeVar("_Number", bound=np.generic)
Weights = tuple[IntArray, FloatArray]
"""Joints (V, 4) and weights (V, 4) of a shape's vertices."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A closed triangle mesh: `vertices` (V, 3) metres, `faces` (F, 3), outside where they turn anticlockwise."""

    vertices: FloatArray
    faces: IntArray


def tube(rings: FloatArray) -> Shape:
    """Return the closed skin over `rings` (n, k, 3), n at least 1, each end drawn together at its ring's middle."""
    n, k = rings.shape[:2]
    poles = np.stack([rings[0].mean(axis=0), rings[-1].mean(axis=0)])
    around = np.arange(k)
    after = (around + 1) % k
    first = np.stack([np.full(k, n * k), after, around], axis=1)
    last = np.stack([np.full(k, n * k + 1), (n - 1) * k + around, (n - 1) * k + after], axis=1)
    steps = k * np.arange(n - 1)[:, None]
    low = np.stack([steps + around, steps + after, steps + k + after], axis=-1).reshape(-1, 3)
    high = np.stack([steps + around, steps + k + after, steps + k + around], axis=-1).reshape(-1, 3)
    return outward(Shape(np.concatenate([rings.reshape(-1, 3), poles]), np.concatenate([first, low, high, last])))


def outward(shape: Shape) -> Shape:
    """Return a closed shape with its outside outside."""
    return shape if volume(shape) >= 0 else Shape(shape.vertices, shape.faces[:, ::-1])


def volume(shape: Shape) -> float:
    """Return the volume inside a closed shape, negative where it is inside out."""
    a, b, c = (shape.vertices[shape.faces[:, i]] - shape.vertices[0] for i in range(3))
    return float(np.einsum("fi,fi->", a, np.cross(b, c)) / 6)


def circle(n: int) -> FloatArray:
    """Return cosine and sine (n, 2) of a turn in n steps."""
    angle = np.arange(n) * (2 * np.pi / n)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def ellipsoid(centre: ArrayLike, axes: FloatArray, resolution: tuple[int, int] = (10, 16)) -> Shape:
    """Return an ellipsoid: `axes` (3, 3) are its half axes as rows, the first the pole; (rings, around) steps."""
    n, k = resolution
    angle = (np.arange(n) + 0.5) / n * np.pi
    turn = circle(k)
    across = turn[:, :1] * axes[1] + turn[:, 1:] * axes[2]
    rings = -np.cos(angle)[:, None, None] * axes[0] + np.sin(angle)[:, None, None] * across
    return tube(rings + np.asarray(centre))


def capsule(start: FloatArray, end: FloatArray, radii: tuple[float, float], resolution: tuple[int, int]) -> Shape:
    """Return a tapered capsule between two places, round at both ends; (rings, around) steps."""
    n, k = resolution
    along = end - start
    length = float(np.linalg.norm(along))
    forward = along / length if length > 1e-9 else np.array([0.0, 1.0, 0.0])
    side, front = across(forward, np.array([0.0, 0.0, 1.0]))
    half = max(n // 3, 2)
    angle = (np.arange(half) + 0.5) / half * (np.pi / 2)
    place = np.concatenate([-radii[0] * np.cos(angle), [length * 0.5], length + radii[1] * np.sin(angle)])
    width = np.concatenate([radii[0] * np.sin(angle), [(radii[0] + radii[1]) * 0.5], radii[1] * np.cos(angle)])
    turn = circle(k)
    ring = turn[:, :1] * side + turn[:, 1:] * front
    return tube(start + place[:, None, None] * forward + width[:, None, None] * ring)


def across(forward: FloatArray, towards: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit side and front vectors square to the unit `forward`, front as near to `towards` as can be."""
    front = towards - forward * float(towards @ forward)
    if np.linalg.norm(front) < 0.2 * max(float(np.linalg.norm(towards)), 1e-12):
        spare = np.eye(3)[int(np.argmin(np.abs(forward)))]
        front = spare - forward * float(spare @ forward)
    front = front / np.linalg.norm(front)
    return np.cross(front, forward), front


@dataclass(slots=True)
class ShapeList:
    """Gathers coloured, weighted shapes and joins them to a surface."""

    parts: list[tuple[Shape, FloatArray, Weights]] = field(default_factory=list)

    def add(self, shape: Shape, colour: FloatArray, weights: Weights | int) -> None:
        """Add a shape in a linear colour (3,), carried by one joint or by weighted ones."""
        if isinstance(weights, int):
            weights = rigid(weights, len(shape.vertices))
        self.parts.append((shape, colour, weights))

    @property
    def n_faces(self) -> int:
        """The number of triangles so far."""
        return sum(len(shape.faces) for shape, _, _ in self.parts)

    def carriers(self) -> set[int]:
        """Return the joints that carry something."""
        return {int(j) for _, _, (joints, weights) in self.parts for j in np.unique(joints[weights > 1e-3])}

    def surface(self) -> Surface:
        """Return everything as one surface with smooth normals in each shape."""
        starts = np.cumsum([0] + [len(shape.vertices) for shape, _, _ in self.parts])
        return Surface(
            vertices=_joined([shape.vertices for shape, _, _ in self.parts], 3).astype(np.float32),
            normals=_joined([smooth_normals(shape) for shape, _, _ in self.parts], 3).astype(np.float32),
            faces=_joined([p[0].faces + start for p, start in zip(self.parts, starts[:-1], strict=True)], 3),
            colours=_joined([np.broadcast_to(c, s.vertices.shape) for s, c, _ in self.parts], 3).astype(np.float32),
            joints=_joined([w[0] for _, _, w in self.parts], 4).astype(np.int64),
            weights=_joined([w[1] for _, _, w in self.parts], 4).astype(np.float32),
        )


def rigid(joint: int, n_vertices: int) -> Weights:
    """Return the weights of vertices that one joint carries."""
    joints = np.zeros((n_vertices, 4), dtype=np.int64)
    joints[:, 0] = joint
    weights = np.zeros((n_vertices, 4))
    weights[:, 0] = 1.0
    return joints, weights


def along_joints(place: FloatArray, joints: list[int], starts: FloatArray, soft: float) -> Weights:
    """Return weights of vertices at `place` (V,) along a chain whose joint i begins at `starts[i]` (rising).

    Within `soft` of a joint's beginning the joint before and the joint share the vertex smoothly.
    """
    n = len(place)
    result = np.zeros((n, 4), dtype=np.int64), np.zeros((n, 4))
    index = np.clip(np.searchsorted(starts, place, side="right") - 1, 0, len(joints) - 1)
    ends = np.append(starts[1:], np.inf)
    numbers = np.asarray(joints)
    gap_before = np.where(index > 0, np.minimum(soft, 0.5 * (ends - starts)[index]), soft)
    from_start = place - starts[index]
    to_end = ends[index] - place
    share_before = np.where(index > 0, np.clip(0.5 - 0.5 * from_start / np.maximum(gap_before, 1e-9), 0, 0.5), 0.0)
    reach = np.minimum(soft, 0.5 * (ends - starts)[index])
    share_after = np.where(np.isfinite(to_end), np.clip(0.5 - 0.5 * to_end / np.maximum(reach, 1e-9), 0, 0.5), 0.0)
    result[0][:, 0] = numbers[index]
    result[0][:, 1] = numbers[np.maximum(index - 1, 0)]
    result[0][:, 2] = numbers[np.minimum(index + 1, len(joints) - 1)]
    result[1][:, 0] = 1.0 - share_before - share_after
    result[1][:, 1] = share_before
    result[1][:, 2] = share_after
    return result


def smooth_normals(shape: Shape) -> FloatArray:
    """Return unit normals (V, 3): each vertex the mean of its triangles' by area."""
    a, b, c = (shape.vertices[shape.faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    total = np.zeros_like(shape.vertices)
    for corner in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(shape.faces[:, corner], normal[:, axis], len(total))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 1e-15, total / np.maximum(length, 1e-15), (0.0, 1.0, 0.0))


def _joined(arrays: list[NDArray[_Number]], width: int) -> NDArray[_Number]:
    empty: NDArray[Any] = np.zeros((0, width))
    return np.concatenate(arrays) if arrays else empty
