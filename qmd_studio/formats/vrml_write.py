"""A scene to ClassicVRML (ISO/IEC 19776-2) or VRML97 (ISO/IEC 14772-1)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_fields import declared_types, field_type
from qmd_studio.formats.scene_graph import (
    MAX_DEPTH,
    Declared,
    Encoding,
    Is,
    Listed,
    Node,
    Proto,
    Raw,
    Route,
    Scene,
    Statement,
    Use,
    title,
)
from qmd_studio.formats.scene_values import guessed_value, numbers_text, parse_value, quoted
from qmd_studio.formats.vrml_parse import ACCESS

_OLD_ACCESS = {new: old for old, new in ACCESS.items()}
_NAME = re.compile(r"""[^\s,"'\#\[\]{}.\x00-\x20+\-\d\\][^\s,"'\#\[\]{}.\x00-\x20\\]*""")


def write_vrml(scene: Scene, encoding: Encoding) -> bytes:
    """Return `scene` in `encoding`; raises `FormatError` where a name cannot stand there or the nesting is too deep."""
    writer = _Writer(scene, encoding)
    if encoding is Encoding.VRML97:
        writer.lines.append("#VRML V2.0 utf8\n")
    else:
        writer.lines.append(f"#X3D V{scene.version or '4.0'} utf8\n")
    writer.lines += [f"#{part}\n" for comment in scene.comments for part in comment.splitlines() or [""]]
    writer.lines.append("\n")
    if encoding is Encoding.CLASSIC:
        writer.head(scene)
    for _, value in scene.root.fields:
        writer.write(value, 0)
        writer.lines.append("\n")
    return "".join(writer.lines).encode("utf-8", errors="replace")


class _Writer:
    """Gathers the pieces of a file; `types` are those of the PROTOs' fields."""

    def __init__(self, scene: Scene, encoding: Encoding) -> None:
        self.lines: list[str] = []
        self.old = encoding is Encoding.VRML97
        self.types = declared_types(scene)

    def head(self, scene: Scene) -> None:
        if scene.profile:
            self.lines.append(f"PROFILE {scene.profile}\n")
        self.lines += [f"COMPONENT {name}:{level}\n" for name, level in scene.components]
        self.lines += [f"UNIT {category} {name} {factor}\n" for category, name, factor in scene.units]
        self.lines += [f"META {quoted(name)} {quoted(content)}\n" for name, content in scene.metas]

    def write(self, value: Any, depth: int) -> None:
        if isinstance(value, Node):
            self._node(value, depth)
        elif isinstance(value, Use):
            self.lines.append(f"USE {_checked(value.name, 'USE')}")
        elif isinstance(value, Route):
            words = [_checked(word, "ROUTE") for word in _words(value)]
            self.lines.append(f"ROUTE {words[0]}.{words[1]} TO {words[2]}.{words[3]}")
        elif isinstance(value, Proto):
            self._proto(value, depth)
        elif isinstance(value, Declared):
            self._declared(value, depth)
        elif isinstance(value, Statement):
            self._link(value)
        elif isinstance(value, Is):
            self.lines.append(f"IS {_checked(value.name, 'IS')}")
        elif value is None:
            self.lines.append("NULL")
        else:
            self.lines.append(plain(value))

    def _node(self, node: Node, depth: int) -> None:
        if depth > MAX_DEPTH - 2:
            raise FormatError("the scene is nested too deeply to be read again", wanted=f"at most {MAX_DEPTH} levels")
        if node.name is not None:
            self.lines.append(f"DEF {_checked(node.name, title(node))} ")
        self.lines.append(f"{_checked(node.type, title(node))} {{\n")
        written: set[str] = set()
        for name, value in node.fields:
            if name == "":
                self.write(value, depth + 1)
            elif name in written or name == "CDATA":
                continue
            else:
                written.add(name)
                self.lines.append(f"{_checked(name, title(node))} ")
                self._field(node, name, depth)
            self.lines.append("\n")
        self.lines.append("}")

    def _field(self, node: Node, name: str, depth: int) -> None:
        values = [value for key, value in node.fields if key == name]
        kind = self.types.get((node.type, name)) or field_type(node.type, name)
        nodes = [value for value in values if isinstance(value, Node | Use) or value is None]
        if not nodes:
            self.lines.append(text_of(kind, values[-1]))
        elif kind == "MFNode" or len(nodes) > 1:
            self.lines.append("[\n")
            for value in nodes:
                self.write(value, depth + 1)
                self.lines.append("\n")
            self.lines.append("]")
        else:
            self.write(nodes[0], depth + 1)

    def _proto(self, proto: Proto, depth: int) -> None:
        word = "PROTO" if proto.body is not None else "EXTERNPROTO"
        self.lines.append(f"{word} {_checked(proto.name, word)} [\n")
        for declared in proto.interface:
            self._declared(declared, depth + 1, with_values=proto.body is not None)
            self.lines.append("\n")
        self.lines.append("]\n")
        if proto.body is None:
            self.lines.append("[ " + " ".join(map(quoted, proto.urls)) + " ]")
            return
        self.lines.append("{\n")
        for _, value in proto.body.fields:
            self.write(value, depth + 1)
            self.lines.append("\n")
        self.lines.append("}")

    def _declared(self, declared: Declared, depth: int, with_values: bool = True) -> None:
        access = _OLD_ACCESS.get(declared.access, declared.access) if self.old else declared.access
        self.lines.append(f"{access} {declared.type} {_checked(declared.name, 'a field')}")
        if not with_values or declared.access in ("inputOnly", "outputOnly"):
            return
        self.lines.append(" ")
        nodes = [value for value in declared.values if isinstance(value, Node | Use)]
        if declared.type == "MFNode":
            self.lines.append("[ ")
            for node in nodes:
                self.write(node, depth + 1)
            self.lines.append(" ]")
        elif declared.type == "SFNode" and not nodes:
            self.lines.append("NULL")
        elif nodes:
            self.write(nodes[0], depth + 1)
        else:
            value = declared.values[-1] if declared.values else _nothing(declared.type)
            self.lines.append(f"IS {value.name}" if isinstance(value, Is) else text_of(declared.type, value))

    def _link(self, statement: Statement) -> None:
        words = dict(statement.words)
        inline = words.get("inlineDEF")
        name = words.get("importedDEF") or words.get("localDEF") or ""
        head = f"{_checked(inline, statement.kind)}." if inline else ""
        self.lines.append(f"{statement.kind} {head}{_checked(name, statement.kind)}")
        if words.get("AS"):
            self.lines.append(f" AS {_checked(words['AS'], statement.kind)}")


def _words(route: Route) -> tuple[str, str, str, str]:
    return route.from_node, route.from_field, route.to_node, route.to_field


def _nothing(kind: str) -> Any:
    if kind.startswith("MF"):
        return ()
    return {"SFString": "", "SFBool": False, "SFRotation": np.array([0.0, 0.0, 1.0, 0.0])}.get(
        kind, np.zeros(int(found[0]) if (found := re.findall(r"\d", kind)) and kind != "SFInt32" else 1)
    )


def text_of(kind: str | None, value: Any) -> str:
    """Return a value of a field of type `kind` as text; what XML kept as text is read as what it most likely is."""
    if isinstance(value, Raw):
        value = parse_value(kind, value) if kind is not None else guessed_value(value)
        if isinstance(value, Raw):
            value = guessed_value(value)
    if isinstance(value, Is):
        return f"IS {value.name}"
    if kind is not None and kind.startswith("MF") and not isinstance(value, Listed):
        return f"[ {plain(value)} ]"
    return plain(value)


def plain(value: Any) -> str:
    """Return a value as text, brackets only where it came with them."""
    if isinstance(value, Listed):
        return f"[ {plain(value.value)} ]"
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, tuple):
        return " ".join(plain(part) for part in value)
    return numbers_text(value)


def _checked(name: str, where: str) -> str:
    if not _NAME.fullmatch(name):
        hint = "Rename it, or save as .x3d"
        raise FormatError("a name cannot stand in VRML", at=where, got=repr(name[:60]), hint=hint)
    return name
