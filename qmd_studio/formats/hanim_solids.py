"""Box, Sphere, Cylinder and Cone as triangles, about the origin (ISO/IEC 19775-1, clause 13)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.formats.hanim_view import flag, number, vector
from qmd_studio.formats.scene_graph import Node

Solid: TypeAlias = tuple[FloatArray, IntArray, float]
_AROUND = 16
_DOWN = 8
_EDGES = 0.9
"""Crease angle that keeps the rim of a cylinder sharp; the walls' own steps are smaller."""


def _box(node: Node) -> Solid:
    half = np.abs(vector(node, "size", (2.0, 2.0, 2.0))) / 2
    points = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=np.float64) * half
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return points, np.array(faces, dtype=np.int64), 0.0


def _sphere(node: Node) -> Solid:
    radius = abs(number(node, "radius", 1.0))
    turns = 2 * np.pi * np.arange(_AROUND) / _AROUND
    rings = np.pi * np.arange(1, _DOWN) / _DOWN
    ring = [
        (np.sin(down) * np.sin(turn), np.cos(down), np.sin(down) * np.cos(turn)) for down in rings for turn in turns
    ]
    points = radius * np.array([(0.0, 1.0, 0.0), *ring, (0.0, -1.0, 0.0)])
    return points, _rings(_DOWN - 1, closed=(True, True)), np.pi


def _cylinder(node: Node) -> Solid:
    radius, half = abs(number(node, "radius", 1.0)), abs(number(node, "height", 2.0)) / 2
    points = _tower([(radius, half), (radius, -half)], half, -half)
    return points, _rings(2, closed=(flag(node, "top", True), flag(node, "bottom", True)), side=_side(node)), _EDGES


def _cone(node: Node) -> Solid:
    radius, half = abs(number(node, "bottomRadius", 1.0)), abs(number(node, "height", 2.0)) / 2
    points = _tower([(radius, -half)], half, -half)
    return points, _rings(1, closed=(_side(node), flag(node, "bottom", True))), _EDGES


def _side(node: Node) -> bool:
    return flag(node, "side", True)


def _tower(rings: list[tuple[float, float]], top: float, bottom: float) -> FloatArray:
    turns = 2 * np.pi * np.arange(_AROUND) / _AROUND
    ring = [(radius * np.sin(turn), y, radius * np.cos(turn)) for radius, y in rings for turn in turns]
    return np.array([(0.0, top, 0.0), *ring, (0.0, bottom, 0.0)])


def _rings(count: int, *, closed: tuple[bool, bool], side: bool = True) -> IntArray:
    """Return triangles of a pole, `count` rings downwards and a pole, seen from outside anticlockwise."""
    faces: list[tuple[int, int, int]] = []
    last = 1 + count * _AROUND
    for k in range(_AROUND):
        after = (k + 1) % _AROUND
        if closed[0]:
            faces.append((0, 1 + k, 1 + after))
        for ring in range(count - 1):
            a, b = 1 + ring * _AROUND + k, 1 + ring * _AROUND + after
            if side:
                faces += [(a, a + _AROUND, b + _AROUND), (a, b + _AROUND, b)]
        if closed[1]:
            faces.append((last, last - _AROUND + after, last - _AROUND + k))
    return np.array(faces, dtype=np.int64).reshape(-1, 3)


SOLIDS: dict[str, Callable[[Node], Solid]] = {"Box": _box, "Sphere": _sphere, "Cylinder": _cylinder, "Cone": _cone}
"""What makes points, triangles and crease angle of each solid."""
