"""A scene as a tree to walk: USE and Inline resolved, H-Anim's PROTOs taken for the nodes they are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_fields import HANIM_PROTOS
from qmd_studio.formats.scene_graph import Listed, Node, Route, Scene, Use, title
from qmd_studio.motion.skeleton import LARGEST

MAX_VISITS = 100_000
"""Walks over more nodes, each USE counted as often as it stands, are refused: USE can double at each level."""


@dataclass(slots=True)
class View:
    """A scene under way to a figure: `inlined` holds the roots of Inline files by the Inline's id."""

    scene: Scene
    warnings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    inlined: dict[int, list[Scene]] = field(default_factory=dict)
    visits: int = 0

    def children(self, node: Node) -> Iterator[tuple[str, Node]]:
        """Yield (field, node) of all nodes in the fields of `node`, USE resolved.

        Raises `FormatError` after `MAX_VISITS` of them in all.
        """
        for name, value in node.fields:
            found = value.node if isinstance(value, Use) else value
            if isinstance(found, Node):
                self.visits += 1
                if self.visits > MAX_VISITS:
                    raise FormatError("the scene is too large or uses itself", wanted=f"at most {MAX_VISITS} nodes")
                yield name, found
        for scene in self.inlined.get(id(node), ()):
            yield from (("children", child) for _, child in self.children(scene.root))

    def child(self, node: Node, *kinds: str) -> Node | None:
        """Return the first child of one of `kinds`."""
        return next((child for _, child in self.children(node) if kind_of(child) in kinds), None)

    def every(self, *kinds: str) -> list[Node]:
        """Return the nodes of `kinds` in the scene and its Inlines, each once, in the file's order."""
        return [node for node in self.scene_nodes() if kind_of(node) in kinds]

    def scene_nodes(self) -> Iterator[Node]:
        """Yield the nodes of the scene and its Inlines, each once, in the file's order."""
        return all_nodes([self.scene.root, *(s.root for many in self.inlined.values() for s in many)])

    def routes(self) -> list[Route]:
        """Return all ROUTEs, wherever they stand."""
        found = []
        for node in all_nodes([self.scene.root]):
            found += [value for name, value in node.fields if name == "" and isinstance(value, Route)]
        return found

    def named(self) -> dict[str, Node]:
        """Return the nodes by their DEF, the last of a name counting."""
        return {node.name: node for node in all_nodes([self.scene.root]) if node.name is not None}

    def warn(self, node: Node, rule: str) -> None:
        """Add a warning: the node, the rule it breaks and what was done about it."""
        self.warnings.append(f"{title(node)}: {rule}")


def all_nodes(roots: list[Node]) -> Iterator[Node]:
    """Yield the nodes where they are defined, depth first; bodies of PROTOs are left out."""
    waiting = roots[::-1]
    while waiting:
        node = waiting.pop()
        yield node
        waiting.extend(value for _, value in reversed(node.fields) if isinstance(value, Node))


def kind_of(node: Node) -> str:
    """Return the node's type, H-Anim's PROTOs of VRML97 under the names of X3D."""
    return HANIM_PROTOS.get(node.type, node.type)


def label(node: Node) -> str:
    """Return the node's name, else its DEF, else ""."""
    name = node.get("name")
    return name if isinstance(name, str) and name else node.name or ""


def text(node: Node, name: str) -> str:
    """Return a field of text, texts being joined by blanks."""
    value = node.get(name)
    return " ".join(v for v in value if isinstance(v, str)) if isinstance(value, tuple) else str(value or "")


def flag(node: Node, name: str, default: bool) -> bool:
    """Return a flag, `default` where it is absent or is none."""
    value = node.get(name)
    return value if isinstance(value, bool) else default


def raw_numbers(node: Node, name: str) -> FloatArray:
    """Return a field of numbers (n,), not checked for size; raises `FormatError` for a word that is none."""
    value: Any = node.get(name)
    if isinstance(value, Listed):
        value = value.value
    if value is None or (isinstance(value, tuple | str) and not value):
        return np.zeros(0)
    if not isinstance(value, np.ndarray):
        raise wrong(node, name, "numbers", str(value)[:40])
    return value.astype(np.float64)


def numbers(node: Node, name: str) -> FloatArray:
    """Return a field of numbers (n,), all finite and of a usual size, or raise `FormatError`."""
    values = raw_numbers(node, name)
    if len(values) and not np.abs(values).max() <= LARGEST:
        raise wrong(node, name, "numbers of a usual size", "one that is not")
    return values


def integers(node: Node, name: str) -> IntArray:
    """Return a field of whole numbers (n,); raises `FormatError` for others."""
    value = node.get(name)
    if isinstance(value, np.ndarray) and value.dtype == np.int64:
        if len(value) and not -LARGEST <= value.min() <= value.max() <= LARGEST:
            raise wrong(node, name, "numbers of a usual size", "one that is not")
        return value
    values = numbers(node, name)
    if (values != np.round(values)).any():
        raise wrong(node, name, "whole numbers", "a fraction")
    return values.astype(np.int64)


def vector(node: Node, name: str, default: tuple[float, ...]) -> FloatArray:
    """Return a field of as many numbers as `default` has, or `default` where it is absent."""
    if node.get(name) is None:
        return np.array(default)
    values = numbers(node, name)
    if len(values) != len(default):
        raise wrong(node, name, f"{len(default)} numbers", str(len(values)))
    return values


def number(node: Node, name: str, default: float) -> float:
    """Return a field of one number."""
    return float(vector(node, name, (default,))[0])


def axis_angle_matrix(rotation: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of an SFRotation (4,): an axis of any length, none being no turn, and radians."""
    length = float(np.linalg.norm(rotation[:3]))
    if length == 0:
        return np.eye(3)
    x, y, z = rotation[:3] / length
    sine, cosine = math.sin(rotation[3]), math.cos(rotation[3])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))


def transform_matrix(node: Node) -> FloatArray:
    """Return the matrix (4, 4) of a Transform's fields: T · C · R · SR · S · SR⁻¹ · C⁻¹ (ISO/IEC 19775-1, 10.4.4)."""
    return compose(
        vector(node, "translation", (0.0, 0.0, 0.0)),
        axis_angle_matrix(vector(node, "rotation", (0.0, 0.0, 1.0, 0.0))) @ stretch_matrix(node),
        vector(node, "center", (0.0, 0.0, 0.0)),
    )


def stretch_matrix(node: Node) -> FloatArray:
    """Return SR · S · SR⁻¹ (3, 3) of a node with scale and scaleOrientation."""
    turn = axis_angle_matrix(vector(node, "scaleOrientation", (0.0, 0.0, 1.0, 0.0)))
    return np.asarray(turn @ np.diag(vector(node, "scale", (1.0, 1.0, 1.0))) @ turn.T)


def compose(translation: FloatArray, linear: FloatArray, centre: FloatArray) -> FloatArray:
    """Return the matrix (4, 4) that applies `linear` about `centre` and then moves by `translation`."""
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    matrix[:3, 3] = translation + centre - linear @ centre
    return matrix


def applied(matrix: FloatArray, points: FloatArray) -> FloatArray:
    """Return `points` (..., 3) moved by `matrix` (4, 4)."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def wrong(node: Node, name: str, wanted: str, got: str) -> FormatError:
    """Return the error for a field that is not what it should be."""
    return FormatError("a field is not what it should be", at=f"{title(node)}, {name}", wanted=wanted, got=got)
