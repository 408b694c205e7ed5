"""Displacers of an H-Anim figure: changes of shape, from points of a Coordinate to the surface's vertices."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Displacer
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_surface import Gathered, skin_coordinate
from qmd_studio.formats.hanim_view import integers, kind_of, label, number, numbers
from qmd_studio.formats.scene_graph import Node

MAX_DISPLACERS = 5_000


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A displacer's node, the name it goes by, and its joint."""

    node: Node
    name: str
    joint: int
    coordinate: Node | None


def find_displacers(gathered: Gathered) -> list[Found]:
    """Return the displacers of joints and segments, each with a name of its own."""
    view, figure = gathered.view, gathered.figure
    skin = skin_coordinate(view, figure)
    owners: list[tuple[int, Node, Node | None]] = [(j, node, skin) for j, node in enumerate(figure.joints)]
    for joint, segment in figure.segments:
        coordinate = view.child(segment, "Coordinate", "CoordinateDouble")
        own = [part.coordinate for part in gathered.parts if part.joint == joint]
        owners.append((joint, segment, coordinate if coordinate is not None else own[0] if own else None))
    found: list[Found] = []
    names, counts = set(figure.names), Counter[str]()
    seen: set[int] = set()
    for joint, owner, coordinate in owners:
        for _, child in view.children(owner):
            if kind_of(child) == "HAnimDisplacer" and id(child) not in seen:
                seen.add(id(child))
                name = base = label(child) or f"{figure.names[joint]} displacer"
                while name in names:
                    counts[base] = max(counts[base], 1) + 1
                    name = f"{base} #{counts[base]}"
                names.add(name)
                if len(found) >= MAX_DISPLACERS:
                    raise FormatError("the figure has too many displacers", wanted=f"at most {MAX_DISPLACERS}")
                found.append(Found(child, name, joint, coordinate))
    return found


def displacers_of(gathered: Gathered, found: list[Found]) -> tuple[Displacer, ...]:
    """Return the displacers on the surface's vertices, in metres. Raises `FormatError` for fields that are none."""
    result = []
    for each in found:
        index, values = integers(each.node, "coordIndex"), numbers(each.node, "displacements")
        count = min(len(index), len(values) // 3)
        if count < max(len(index), -(-len(values) // 3)):
            gathered.view.warn(
                each.node,
                f"{len(index)} coordIndex and {len(values) / 3:g} displacements; {count} are used",
            )
        vertices, moves = _on_vertices(gathered, each, index[:count], values[: 3 * count].reshape(-1, 3))
        result.append(
            Displacer(each.name, each.joint, vertices, moves.astype(np.float32), number(each.node, "weight", 0.0))
        )
    return tuple(result)


def _on_vertices(gathered: Gathered, each: Found, index: IntArray, moves: FloatArray) -> tuple[IntArray, FloatArray]:
    vertices: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    displacements: list[FloatArray] = [np.zeros((0, 3))]
    parts = [part for part in gathered.parts if part.coordinate is each.coordinate and each.coordinate is not None]
    for part in parts:
        order = np.argsort(part.points, kind="stable")
        left = np.searchsorted(part.points[order], index, side="left")
        right = np.searchsorted(part.points[order], index, side="right")
        counts = right - left
        entry = np.repeat(np.arange(len(index)), counts)
        within = np.arange(len(entry)) - np.repeat(np.cumsum(counts) - counts, counts)
        vertices.append(part.first + order[left[entry] + within])
        displacements.append(moves[entry] @ part.linear.T)
    if len(index) and not any(len(some) for some in vertices):
        gathered.view.warn(each.node, "it moves no vertex of the figure; it is kept without effect")
    return np.concatenate(vertices), np.concatenate(displacements)
