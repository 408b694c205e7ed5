"""A scene to X3D in XML (ISO/IEC 19776-1)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_fields import default_place
from qmd_studio.formats.scene_graph import (
    MAX_DEPTH,
    Declared,
    Is,
    Listed,
    Node,
    Proto,
    Route,
    Scene,
    Statement,
    Use,
    title,
)
from qmd_studio.formats.scene_values import numbers_text, quoted

_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def write_xml(scene: Scene) -> bytes:
    """Return `scene` as an X3D file; raises `FormatError` where it is nested more deeply than any reader takes."""
    version = scene.version or "4.0"
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>\n',
        f'<!DOCTYPE X3D PUBLIC "ISO//Web3D//DTD X3D {_text(version)}//EN" '
        f'"https://www.web3d.org/specifications/x3d-{_text(version)}.dtd">\n',
        f"<X3D version={_attribute(version)}",
        f" profile={_attribute(scene.profile)}>\n" if scene.profile else ">\n",
    ]
    for comment in scene.comments:
        lines.append(f"<!--{_NOT_XML.sub('?', comment).replace('--', '- -').removesuffix('-')}-->\n")
    lines.append("<head>\n")
    lines += [f"<component name={_attribute(name)} level={_attribute(level)}/>\n" for name, level in scene.components]
    for category, name, factor in scene.units:
        unit = f"category={_attribute(category)} name={_attribute(name)} conversionFactor={_attribute(factor)}"
        lines.append(f"<unit {unit}/>\n")
    lines += [f"<meta name={_attribute(name)} content={_attribute(content)}/>\n" for name, content in scene.metas]
    lines.append("</head>\n<Scene>\n")
    for place, value in scene.root.fields:
        _write(lines, scene.root, place, value, 1)
    lines.append("</Scene>\n</X3D>\n")
    return "".join(lines).encode("utf-8")


def _write(lines: list[str], parent: Node | None, place: str, value: Any, depth: int) -> None:
    if depth > MAX_DEPTH - 2:
        raise FormatError("the scene is nested too deeply to be read again", wanted=f"at most {MAX_DEPTH} levels")
    if isinstance(value, Node):
        _write_node(lines, parent, place, value, depth)
    elif isinstance(value, Use):
        kind = value.node.type if value.node is not None else "Group"
        tag, name = ("ProtoInstance", kind) if value.node is not None and value.node.proto else (kind, None)
        own = f" name={_attribute(name)}" if name else ""
        lines.append(f"<{tag}{own} USE={_attribute(value.name)}{_place(parent, kind, place)}/>\n")
    elif isinstance(value, Route):
        words = zip(("fromNode", "fromField", "toNode", "toField"), _words(value), strict=True)
        lines.append("<ROUTE " + " ".join(f"{name}={_attribute(word)}" for name, word in words) + "/>\n")
    elif isinstance(value, Statement):
        words_text = " ".join(f"{name}={_attribute(word)}" for name, word in value.words)
        lines.append(f"<{value.kind} {words_text}/>\n")
    elif isinstance(value, Proto):
        _write_proto(lines, value, depth)
    elif isinstance(value, Declared):
        _write_declared(lines, value, depth)


def _words(route: Route) -> tuple[str, str, str, str]:
    return route.from_node, route.from_field, route.to_node, route.to_field


def _write_node(lines: list[str], parent: Node | None, place: str, node: Node, depth: int) -> None:
    _check_name(node.type if not node.proto else "ProtoInstance", node)
    tag = "ProtoInstance" if node.proto else node.type
    lines.append(f"<{tag}")
    if node.proto:
        lines.append(f" name={_attribute(node.type)}")
    if node.name is not None:
        lines.append(f" DEF={_attribute(node.name)}")
    lines.append(_place(parent, node.type, place))
    values = [(name, value) for name, value in node.fields if _is_value(value) and name != "CDATA"]
    if not node.proto:
        for name, value in values:
            _check_name(name, node)
            lines.append(f" {name}={_attribute(value_text(value))}")
    inner: list[str] = []
    if node.proto:
        inner += [f"<fieldValue name={_attribute(n)} value={_attribute(value_text(v))}/>\n" for n, v in values]
    links = [(name, value.name) for name, value in node.fields if isinstance(value, Is)]
    if links:
        connects = [f"<connect nodeField={_attribute(a)} protoField={_attribute(b)}/>" for a, b in links]
        inner.append("<IS>" + "".join(connects) + "</IS>\n")
    for name, value in node.fields:
        if name == "CDATA":
            inner.append(_text(value))
        elif isinstance(value, Listed) or _is_value(value) or isinstance(value, Is):
            continue
        elif node.proto and name:
            inner.append(f"<fieldValue name={_attribute(name)}>")
            _write(inner, None, name, value, depth + 2)
            inner.append("</fieldValue>\n")
        else:
            _write(inner, node, name, value, depth + 1)
    if inner:
        lines.append(">" if node.get("CDATA") else ">\n")
        lines += inner
        lines.append(f"</{tag}>\n")
    else:
        lines.append("/>\n")


def _write_proto(lines: list[str], proto: Proto, depth: int) -> None:
    tag = "ProtoDeclare" if proto.body is not None else "ExternProtoDeclare"
    url = f" url={_attribute(' '.join(map(quoted, proto.urls)))}" if proto.urls else ""
    lines.append(f"<{tag} name={_attribute(proto.name)}{url}>\n")
    if proto.body is not None:
        lines.append("<ProtoInterface>\n")
    for declared in proto.interface:
        _write_declared(lines, declared, depth + 2)
    if proto.body is not None:
        lines.append("</ProtoInterface>\n<ProtoBody>\n")
        for place, value in proto.body.fields:
            _write(lines, proto.body, place, value, depth + 2)
        lines.append("</ProtoBody>\n")
    lines.append(f"</{tag}>\n")


def _write_declared(lines: list[str], declared: Declared, depth: int) -> None:
    head = f"<field accessType={_attribute(declared.access)} type={_attribute(declared.type)}"
    lines.append(f"{head} name={_attribute(declared.name)}")
    nodes = [value for value in declared.values if isinstance(value, Node | Use)]
    for value in declared.values:
        if _is_value(value):
            lines.append(f" value={_attribute(value_text(value))}")
    if not nodes:
        lines.append("/>\n")
        return
    lines.append(">\n")
    for node in nodes:
        _write(lines, None, "children", node, depth + 1)
    lines.append("</field>\n")


def _place(parent: Node | None, kind: str, place: str) -> str:
    if parent is None or place == default_place(kind, parent.type):
        return ""
    return f" containerField={_attribute(place)}"


def _is_value(value: Any) -> bool:
    if isinstance(value, Listed):
        return _is_value(value.value)
    return isinstance(value, bool | str | tuple | np.ndarray)


def value_text(value: Any) -> str:
    """Return a value as the text of an XML attribute."""
    if isinstance(value, Listed):
        return value_text(value.value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, tuple):
        return " ".join(("true" if v else "false") if isinstance(v, bool) else quoted(v) for v in value)
    return numbers_text(value)


_NAME = re.compile(r"[^\W\d][\w.\-]*(?::[\w.\-]+)?")


def _check_name(name: str, node: Node) -> None:
    if not _NAME.fullmatch(name):
        raise FormatError("a name cannot stand in XML", at=title(node), got=name[:60])


def _text(text: str) -> str:
    return _NOT_XML.sub("?", text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _attribute(text: str) -> str:
    text = _text(text).replace("'", "&apos;").replace("\n", "&#10;").replace("\r", "&#13;").replace("\t", "&#9;")
    return f"'{text}'"
