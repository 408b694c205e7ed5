"""A scene as a file holds it: generic nodes with their fields in order, so that what was read can be written again.

It serves X3D (ISO/IEC 19775-1, 19776-1 and -2) and VRML97 (ISO/IEC 14772-1) alike and knows nothing of figures.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeAlias

import numpy as np

from qmd_studio.errors import FormatError

MAX_DEPTH = 128
"""Deeper nesting is refused; real figures have about fifty levels."""
MAX_NODES = 50_000
"""Files with more nodes are refused; real figures have some thousands."""
MAX_ITEMS = 150_000
"""Files with more fields and statements are refused."""
MAX_COMMENTS = 1_000
"""More comments than this are not kept."""


class Encoding(StrEnum):
    """The three ways in which a scene stands in a file."""

    XML = "xml"
    CLASSIC = "classic"
    VRML97 = "vrml97"


class Raw(str):
    """The text of an XML attribute whose type is not known, or that is not what its type wants: kept as it stands."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Is:
    """A field inside a PROTO that stands for a field of the PROTO's interface."""

    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Listed:
    """A value in brackets of a field whose type is not known: what it holds, and that it is a list."""

    value: Any


@dataclass(frozen=True, slots=True)
class Route:
    """ROUTE from_node.from_field TO to_node.to_field, nodes by their DEF."""

    from_node: str
    from_field: str
    to_node: str
    to_field: str


@dataclass(frozen=True, slots=True)
class Statement:
    """IMPORT or EXPORT, with its words as XML names them."""

    kind: str
    words: tuple[tuple[str, str], ...]


@dataclass(slots=True, eq=False)
class Node:
    """A node: its type, its DEF, and (field, value) in the file's order; a list of nodes is one pair a node.

    A value is a bool, a text, texts, an array of numbers, another `Node`, a `Use`, None for NULL, `Is`, `Raw` or
    `Listed`. Pairs without a name are the statements inside: `Route`, `Proto`, `Declared` and `Statement`. `proto`
    tells a ProtoInstance of XML.
    """

    type: str
    name: str | None = None
    fields: list[tuple[str, Any]] = field(default_factory=list)
    proto: bool = False

    def get(self, name: str) -> Any:
        """Return the last value of the field `name`, None where it is absent."""
        found = None
        for key, value in self.fields:
            if key == name:
                found = value
        return found


@dataclass(slots=True, eq=False)
class Use:
    """USE of the node with this DEF: the very node, or None where there is none."""

    name: str
    node: Node | None = None


@dataclass(slots=True, eq=False)
class Declared:
    """A field that a PROTO or a Script declares: access as X3D names it, type, name, default or an empty list."""

    access: str
    type: str
    name: str
    values: list[Any] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Proto:
    """PROTO with its body, or EXTERNPROTO with `urls` and no body, which is never fetched."""

    name: str
    interface: list[Declared] = field(default_factory=list)
    body: Node | None = None
    urls: tuple[str, ...] = ()


Edge: TypeAlias = tuple[str, Node]


@dataclass(slots=True, eq=False)
class Scene:
    """A file's scene: what its head says, and `root`, whose children the nodes of the file are.

    `comments` are those outside all nodes, such as who made the file. `warnings` say what the parser put up with.
    """

    encoding: Encoding
    version: str = ""
    profile: str = ""
    components: list[tuple[str, str]] = field(default_factory=list)
    units: list[tuple[str, str, str]] = field(default_factory=list)
    metas: list[tuple[str, str]] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)
    root: Node = field(default_factory=lambda: Node("Scene"))
    warnings: list[str] = field(default_factory=list)


def title(node: Node) -> str:
    """Return what an error calls `node`: its type, and its name or DEF."""
    own = node.get("name")
    name = own if isinstance(own, str) and own else node.name or ""
    return f"{node.type} {name[:60]!r}" if name else node.type


def link(scene: Scene) -> None:
    """Give each USE its node: the latest DEF before it, else the first after it.

    Raises `FormatError` where a node holds itself. A USE of nothing is a warning.
    """
    _link_scope(scene, [scene.root])
    _check_acyclic(scene.root)


def _link_scope(scene: Scene, roots: list[Node]) -> None:
    """Link the nodes under `roots`; the bodies of PROTOs are scopes of their own."""
    latest: dict[str, Node] = {}
    first: dict[str, Node] = {}
    forward: list[Use] = []
    inner: list[list[Node]] = []
    waiting: list[Any] = list(reversed(roots))
    while waiting:
        item = waiting.pop()
        if isinstance(item, Node):
            if item.name is not None:
                latest[item.name] = item
                first.setdefault(item.name, item)
            waiting.extend(value for _, value in reversed(item.fields) if isinstance(value, Node | Use | Proto))
            waiting.extend(v for _, d in item.fields if isinstance(d, Declared) for v in d.values)
        elif isinstance(item, Use):
            item.node = latest.get(item.name)
            if item.node is None:
                forward.append(item)
        elif isinstance(item, Proto):
            inner.append([item.body] if item.body else [])
            waiting.extend(value for declared in item.interface for value in declared.values)
    for use in forward:
        use.node = first.get(use.name)
        if use.node is None:
            scene.warnings.append(f"USE {use.name[:60]!r} names no node: it is left out")
    for body in inner:
        _link_scope(scene, body)


def _check_acyclic(root: Node) -> None:
    done: set[int] = set()
    path: set[int] = set()
    waiting: list[tuple[Node, bool]] = [(root, False)]
    while waiting:
        node, leaving = waiting.pop()
        if leaving:
            path.discard(id(node))
            done.add(id(node))
            continue
        if id(node) in done:
            continue
        if id(node) in path:
            raise FormatError("a node holds itself", at=title(node), hint="A USE inside its own DEF has no end")
        path.add(id(node))
        waiting.append((node, True))
        waiting.extend((child, False) for child in _targets(node))


def _targets(node: Node) -> Iterator[Node]:
    for _, value in node.fields:
        if isinstance(value, Node):
            yield value
        elif isinstance(value, Use) and value.node is not None:
            yield value.node
        elif isinstance(value, Proto) and value.body is not None:
            yield value.body


def same_scene(a: Scene, b: Scene) -> bool:
    """Tell whether two scenes are equal: heads, types, names, values in order, and which node each USE stands for."""
    heads = [(s.version, s.profile, s.components, s.units, s.metas, s.comments) for s in (a, b)]
    return heads[0] == heads[1] and _same(a.root, b.root, {})


def _same(a: Any, b: Any, twins: dict[int, int]) -> bool:
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return bool(np.array_equal(a, b, equal_nan=True))
    if isinstance(a, Node):
        if twins.setdefault(id(a), id(b)) != id(b):
            return False
        heads = (a.type, a.name, a.proto, len(a.fields)) == (b.type, b.name, b.proto, len(b.fields))
        pairs = zip(a.fields, b.fields, strict=False)
        return heads and all(x[0] == y[0] and _same(x[1], y[1], twins) for x, y in pairs)
    if isinstance(a, Use):
        if a.name != b.name or (a.node is None) != (b.node is None):
            return False
        return a.node is None or twins.setdefault(id(a.node), id(b.node)) == id(b.node)
    if isinstance(a, Listed):
        return _same(a.value, b.value, twins)
    if isinstance(a, Proto):
        same = (a.name, a.urls, len(a.interface)) == (b.name, b.urls, len(b.interface))
        declared = zip(a.interface, b.interface, strict=False)
        return same and all(_same(x, y, twins) for x, y in declared) and _same(a.body, b.body, twins)
    if isinstance(a, Declared):
        same = (a.access, a.type, a.name, len(a.values)) == (b.access, b.type, b.name, len(b.values))
        return same and all(_same(x, y, twins) for x, y in zip(a.values, b.values, strict=False))
    return bool(a == b)
