"""X3D in XML as a tree of elements with DEF and USE resolved, and its fields as numbers.

X3D (ISO/IEC 19775-1) is read with defusedxml: no entity is expanded and nothing is fetched, whatever the file names.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element, ParseError

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.skeleton import LARGEST

MAX_DEPTH = 200
"""Deeper nesting is refused; real figures have about thirty levels."""
MAX_VISITS = 20_000
"""Walks over more elements, each USE counted as often as it stands, are refused: USE can double at each level."""


@dataclass(slots=True)
class Scene:
    """The elements of a file: `named` by their DEF. `visits` counts the steps of all walks."""

    root: Element
    named: dict[str, Element] = field(default_factory=dict)
    visits: int = 0

    def resolved(self, element: Element) -> Element | None:
        """Return the element that `element` stands for: itself, or what it USEs; None where no such DEF exists."""
        name = element.get("USE")
        return element if name is None else self.named.get(name)

    def children(self, element: Element) -> Iterator[tuple[Element, str | None]]:
        """Yield the children of `element`, USE resolved, each with the containerField it was given there.

        Raises `FormatError` after `MAX_VISITS` of them in all.
        """
        for child in element:
            self.visits += 1
            if self.visits > MAX_VISITS:
                raise FormatError("the scene is too large or uses itself", wanted=f"at most {MAX_VISITS} nodes")
            found = self.resolved(child)
            if found is not None:
                yield found, child.get("containerField")

    def child(self, element: Element, *tags: str) -> Element | None:
        """Return the first child with one of `tags`, USE resolved."""
        return next((child for child, _ in self.children(element) if child.tag in tags), None)


def parse_scene(data: bytes) -> Scene:
    """Parse an X3D file; raises `FormatError` for XML that is broken, nested too deeply, or defines entities."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root = fromstring(data, forbid_entities=True, forbid_external=True)
    except ParseError as problem:
        line, column = problem.position
        text = str(problem).split(":")[0]
        raise FormatError(f"the XML is broken: {text}", at=f"line {line}, column {column + 1}") from None
    except (DefusedXmlException, ValueError, LookupError) as problem:  # LookupError: an encoding that does not exist
        raise FormatError("the XML holds what is not allowed here", got=str(problem)[:80]) from None
    if root.tag != "X3D":
        raise FormatError("the file is XML but not X3D", wanted="X3D", got=str(root.tag)[:40])
    scene = Scene(root)
    waiting = [(root, 1)]
    while waiting:
        element, depth = waiting.pop()
        if depth > MAX_DEPTH:
            raise FormatError("the scene is nested too deeply", wanted=f"at most {MAX_DEPTH} levels")
        name = element.get("DEF")
        if name is not None:
            scene.named.setdefault(name, element)
        waiting.extend((child, depth + 1) for child in element)
    return scene


def title(element: Element) -> str:
    """Return what an error calls `element`: its tag and its name or DEF."""
    name = element.get("name") or element.get("DEF") or ""
    return f"{element.tag} {name[:60]!r}" if name else str(element.tag)


def numbers(element: Element, name: str) -> FloatArray:
    """Return a field of numbers (n,), commas being blanks; raises `FormatError` for a word that is none."""
    text = element.get(name, "")
    try:
        values = np.array(text.replace(",", " ").split(), dtype=np.float64)
    except ValueError as problem:
        raise _wrong(element, name, "numbers", str(problem)[-40:]) from None
    if not np.isfinite(values).all() or (len(values) and np.abs(values).max() > LARGEST):
        raise _wrong(element, name, "numbers of a usual size", "one that is not")
    return values


def integers(element: Element, name: str) -> IntArray:
    """Return a field of whole numbers (n,); raises `FormatError` for others."""
    values = numbers(element, name)
    if (values != np.round(values)).any():
        raise _wrong(element, name, "whole numbers", "a fraction")
    return values.astype(np.int64)


def vector(element: Element, name: str, default: tuple[float, ...]) -> FloatArray:
    """Return a field of as many numbers as `default` has, or `default` where it is absent."""
    if element.get(name) is None:
        return np.array(default)
    values = numbers(element, name)
    if len(values) != len(default):
        raise _wrong(element, name, f"{len(default)} numbers", str(len(values)))
    return values


def points(element: Element, name: str) -> FloatArray:
    """Return a field of positions (n, 3)."""
    values = numbers(element, name)
    if len(values) % 3:
        raise _wrong(element, name, "three numbers a point", str(len(values)))
    return values.reshape(-1, 3)


def axis_angle_matrix(rotation: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of an SFRotation (4,): an axis of any length, none being no turn, and radians."""
    length = float(np.linalg.norm(rotation[:3]))
    if length == 0:
        return np.eye(3)
    x, y, z = rotation[:3] / length
    sine, cosine = math.sin(rotation[3]), math.cos(rotation[3])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))


def transform_matrix(element: Element) -> FloatArray:
    """Return the matrix (4, 4) of a Transform's fields: T · C · R · SR · S · SR⁻¹ · C⁻¹ (ISO/IEC 19775-1, 10.4.4)."""
    turn = axis_angle_matrix(vector(element, "rotation", (0.0, 0.0, 1.0, 0.0)))
    stretch = axis_angle_matrix(vector(element, "scaleOrientation", (0.0, 0.0, 1.0, 0.0)))
    linear = turn @ stretch @ np.diag(vector(element, "scale", (1.0, 1.0, 1.0))) @ stretch.T
    centre = vector(element, "center", (0.0, 0.0, 0.0))
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    matrix[:3, 3] = vector(element, "translation", (0.0, 0.0, 0.0)) + centre - linear @ centre
    return matrix


def _wrong(element: Element, name: str, wanted: str, got: str) -> FormatError:
    return FormatError("a field is not what it should be", at=f"{title(element)}, {name}", wanted=wanted, got=got)
