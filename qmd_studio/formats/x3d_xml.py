"""X3D in XML (ISO/IEC 19776-1) to a scene. No entity is expanded and nothing is fetched, whatever the file names."""

from __future__ import annotations

from typing import Any
from xml.etree.ElementTree import ParseError

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_fields import default_place, field_type
from qmd_studio.formats.scene_graph import (
    MAX_COMMENTS,
    MAX_DEPTH,
    MAX_NODES,
    Declared,
    Encoding,
    Is,
    Node,
    Proto,
    Route,
    Scene,
    Statement,
    Use,
    link,
)
from qmd_studio.formats.scene_values import parse_value

_QUIET = frozenset({"X3D", "head", "ProtoInterface", "IS"})
_ACCESS = {"eventIn": "inputOnly", "eventOut": "outputOnly", "field": "initializeOnly", "exposedField": "inputOutput"}


def parse_xml(data: bytes) -> Scene:
    """Parse an X3D file; raises `FormatError` for XML that is broken, too deep or too large, or defines entities."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import XMLParser

    builder = _Builder()
    parser = XMLParser(target=builder, forbid_entities=True, forbid_external=True)
    try:
        parser.feed(data)
        parser.close()
    except ParseError as problem:
        line, column = problem.position
        text = str(problem).split(":")[0]
        raise FormatError(f"the XML is broken: {text}", at=f"line {line}, column {column + 1}") from None
    except FormatError as problem:
        problem.at = problem.at or f"line {parser.parser.CurrentLineNumber}"
        raise
    except (DefusedXmlException, ValueError, LookupError) as problem:  # LookupError: an encoding that does not exist
        raise FormatError("the XML holds what is not allowed here", got=str(problem)[:80]) from None
    scene = builder.scene
    link(scene)
    return scene


class _Builder:
    """What the XML parser calls: it keeps the path from the root to the element that is open."""

    def __init__(self) -> None:
        self.scene = Scene(Encoding.XML)
        self.path: list[Any] = []
        self.places: list[str] = []
        self.types: dict[tuple[str, str], str] = {}
        self.n_nodes = 0
        self.in_nodes = 0
        self.texts: list[str] = []

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if not self.path and tag != "X3D":
            raise FormatError("the file is XML but not X3D", wanted="X3D", got=tag[:40])
        self.n_nodes += 1
        if self.n_nodes > MAX_NODES:
            raise FormatError("the scene is too large", wanted=f"at most {MAX_NODES} nodes")
        if len(self.path) > MAX_DEPTH:
            raise FormatError("the scene is nested too deeply", wanted=f"at most {MAX_DEPTH} levels")
        self.path.append(self._open(tag, attributes))

    def end(self, tag: str) -> None:
        item = self.path.pop()
        if self.texts:
            text = "".join(self.texts).strip()
            self.texts.clear()
            if isinstance(item, Node) and text:
                item.fields.append(("CDATA", text))

    def data(self, text: str) -> None:
        if text.strip() or self.texts:
            self.texts.append(text)

    def comment(self, text: str) -> None:
        outside = all(not isinstance(item, Node) or item is self.scene.root for item in self.path)
        if outside and len(self.scene.comments) < MAX_COMMENTS:
            self.scene.comments.append(text)

    def close(self) -> None:
        return None

    def _open(self, tag: str, attributes: dict[str, str]) -> Any:
        parent = self.path[-1] if self.path else None
        method = _TAGS.get(tag)
        if method is not None:
            return method(self, parent, attributes)
        if tag in _QUIET:
            return parent if tag in ("ProtoInterface", "IS") else self._head(tag, attributes)
        return self._node(tag, parent, attributes)

    def _head(self, tag: str, attributes: dict[str, str]) -> None:
        if tag == "X3D":
            self.scene.version = attributes.get("version", "")
            self.scene.profile = attributes.get("profile", "")

    def _node(self, tag: str, parent: Any, attributes: dict[str, str]) -> Any:
        proto = tag == "ProtoInstance"
        kind = attributes.get("name", "") if proto else tag
        place = attributes.get("containerField") or default_place(kind, parent.type if isinstance(parent, Node) else "")
        if "USE" in attributes:
            use = Use(attributes["USE"])
            self._add(parent, place, use)
            return use
        node = Node(kind, attributes.get("DEF"), proto=proto)
        for name, text in attributes.items():
            if name not in ("DEF", "containerField") and name[0] != "{" and not (proto and name == "name"):
                known = self.types.get((kind, name)) or field_type(kind, name)
                node.fields.append((name, parse_value(known, text)))
        self._add(parent, place, node)
        return node

    def _add(self, parent: Any, place: str, value: Any) -> None:
        if isinstance(parent, Node):
            parent.fields.append((place, value))
        elif isinstance(parent, _FieldValue):
            parent.node.fields.append((parent.name, value))
        elif isinstance(parent, Declared):
            parent.values.append(value)
        elif parent is not None or isinstance(value, Proto | Node | Use):
            self.scene.warnings.append("a node stands where none can be: it is left out")

    def _scene(self, parent: Any, attributes: dict[str, str]) -> Any:
        return self.scene.root

    def _component(self, parent: Any, attributes: dict[str, str]) -> None:
        self.scene.components.append((attributes.get("name", ""), attributes.get("level", "1")))

    def _unit(self, parent: Any, attributes: dict[str, str]) -> None:
        words = [attributes.get(name, "") for name in ("category", "name", "conversionFactor")]
        self.scene.units.append((words[0], words[1], words[2]))

    def _meta(self, parent: Any, attributes: dict[str, str]) -> None:
        self.scene.metas.append((attributes.get("name", ""), attributes.get("content", "")))

    def _route(self, parent: Any, attributes: dict[str, str]) -> None:
        words = [attributes.get(name, "") for name in ("fromNode", "fromField", "toNode", "toField")]
        self._add(parent, "", Route(words[0], words[1], words[2], words[3]))

    def _import(self, parent: Any, attributes: dict[str, str]) -> None:
        self._add(parent, "", Statement("IMPORT", tuple(attributes.items())))

    def _export(self, parent: Any, attributes: dict[str, str]) -> None:
        self._add(parent, "", Statement("EXPORT", tuple(attributes.items())))

    def _proto(self, parent: Any, attributes: dict[str, str]) -> Any:
        url = parse_value("MFString", attributes.get("url", ""))
        proto = Proto(attributes.get("name", ""), urls=url)
        self._add(parent, "", proto)
        return proto

    def _body(self, parent: Any, attributes: dict[str, str]) -> Any:
        body = Node("ProtoBody")
        if isinstance(parent, Proto):
            parent.body = body
        return body

    def _field(self, parent: Any, attributes: dict[str, str]) -> Any:
        access = attributes.get("accessType", "initializeOnly")
        declared = Declared(_ACCESS.get(access, access), attributes.get("type", ""), attributes.get("name", ""))
        if "value" in attributes:
            declared.values.append(parse_value(declared.type or None, attributes["value"]))
        if isinstance(parent, Proto):
            parent.interface.append(declared)
            self.types[(parent.name, declared.name)] = declared.type
        else:
            self._add(parent, "", declared)
        return declared

    def _field_value(self, parent: Any, attributes: dict[str, str]) -> Any:
        if not isinstance(parent, Node):
            return None
        name = attributes.get("name", "")
        if "value" in attributes:
            known = self.types.get((parent.type, name)) or field_type(parent.type, name)
            parent.fields.append((name, parse_value(known, attributes["value"])))
        return _FieldValue(parent, name)

    def _connect(self, parent: Any, attributes: dict[str, str]) -> None:
        self._add(parent, attributes.get("nodeField", ""), Is(attributes.get("protoField", "")))


class _FieldValue:
    """A fieldValue that is open: nodes inside it are values of its field."""

    def __init__(self, node: Node, name: str) -> None:
        self.node, self.name = node, name


_TAGS: dict[str, Any] = {
    "Scene": _Builder._scene,
    "component": _Builder._component,
    "unit": _Builder._unit,
    "meta": _Builder._meta,
    "ROUTE": _Builder._route,
    "IMPORT": _Builder._import,
    "EXPORT": _Builder._export,
    "ProtoDeclare": _Builder._proto,
    "ExternProtoDeclare": _Builder._proto,
    "ProtoBody": _Builder._body,
    "field": _Builder._field,
    "fieldValue": _Builder._field_value,
    "connect": _Builder._connect,
}
