"""ClassicVRML (ISO/IEC 19776-2) and VRML97 (ISO/IEC 14772-1) to a scene."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_fields import field_type
from qmd_studio.formats.scene_graph import (
    MAX_COMMENTS,
    MAX_DEPTH,
    MAX_ITEMS,
    MAX_NODES,
    Declared,
    Encoding,
    Is,
    Listed,
    Node,
    Proto,
    Route,
    Scene,
    Statement,
    Use,
    link,
)
from qmd_studio.formats.scene_values import parse_numbers, unquoted
from qmd_studio.formats.vrml_tokens import Tokens

ACCESS = {"eventIn": "inputOnly", "eventOut": "outputOnly", "field": "initializeOnly", "exposedField": "inputOutput"}
_ACCESS_WORDS = {**ACCESS, **{word: word for word in ACCESS.values()}}
_HEADER = re.compile(r"#(X3D|VRML) V([\d.]+)[ \t]+(\w+)?([^\n\r]*)")
_NOT_A_NUMBER = re.compile(r"[-+]?(?:nan|inf|infinity)(?:\(ind\))?", re.IGNORECASE)
_FIELD_TYPE = re.compile(r"[SM]F[A-Z]\w*")
_WHOLE = frozenset({"MFInt32", "SFInt32", "SFImage"})


def is_vrml(head: bytes) -> Encoding | None:
    """Return the encoding of a file that begins with `head`, None where it is neither ClassicVRML nor VRML97."""
    head = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if head.startswith(b"#X3D V"):
        return Encoding.CLASSIC
    return Encoding.VRML97 if head.startswith(b"#VRML V2") else None


def parse_vrml(data: bytes) -> Scene:
    """Parse a file; raises `FormatError` with line and column where it breaks the grammar, is too deep or too large."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    header = _HEADER.match(text.lstrip())
    if header is None:
        raise FormatError("the file is no VRML", at="line 1", wanted="#X3D V… utf8 or #VRML V2.0 utf8", got=text[:20])
    encoding = Encoding.CLASSIC if header[1] == "X3D" else Encoding.VRML97
    scene = Scene(encoding, version=header[2], comments=_head_comments(text))
    _Parser(scene, Tokens(text)).run()
    link(scene)
    return scene


def _head_comments(text: str) -> list[str]:
    """Return the comments between the header and the first statement."""
    lines = text.lstrip().splitlines()[1:]
    comments = []
    for line in lines:
        line = line.strip()
        if line.startswith("#"):
            comments.append(line[1:])
        elif line:
            break
    return comments[:MAX_COMMENTS]


class _Parser:
    """Reads statements one after the other; `types` are those of the PROTOs' fields, by (PROTO, field)."""

    def __init__(self, scene: Scene, tokens: Tokens) -> None:
        self.scene, self.tokens = scene, tokens
        self.types: dict[tuple[str, str], str] = {}
        self.depth = self.n_nodes = self.n_items = 0

    def run(self) -> None:
        tokens = self.tokens
        tokens.advance()
        while tokens.kind != "end":
            if tokens.kind != "word":
                raise tokens.wrong("the file breaks its grammar", wanted="a node or a statement")
            if not self._header_statement():
                self._statement(self.scene.root, "children")

    def _header_statement(self) -> bool:
        tokens, scene = self.tokens, self.scene
        if tokens.word not in ("PROFILE", "COMPONENT", "META", "UNIT") or scene.encoding is Encoding.VRML97:
            return False
        word = tokens.word
        tokens.advance()
        if word == "PROFILE":
            scene.profile = tokens.take("word", "a profile")
        elif word == "COMPONENT":
            name, _, level = tokens.take("word", "name:level").partition(":")
            if not level:
                level = tokens.take("numbers", "a level").strip(" ,\t\r\n")
            scene.components.append((name, level))
        elif word == "META":
            name = unquoted(tokens.take("string", "a quoted name"))
            scene.metas.append((name, unquoted(tokens.take("string", "a quoted text"))))
        else:
            category, name = tokens.take("word", "a category"), tokens.take("word", "a unit")
            scene.units.append((category, name, tokens.take("numbers", "a factor").strip(" ,\t\r\n")))
        return True

    def _statement(self, parent: Node, place: str) -> None:
        """Read a node, ROUTE, PROTO, IMPORT or EXPORT into `parent`."""
        self._count()
        tokens = self.tokens
        word = tokens.word
        if word == "ROUTE":
            tokens.advance()
            source = self._dotted()
            tokens.expect("TO")
            parent.fields.append(("", Route(*source, *self._dotted())))
        elif word == "PROTO":
            parent.fields.append(("", self._proto()))
        elif word == "EXTERNPROTO":
            parent.fields.append(("", self._extern_proto()))
        elif word in ("IMPORT", "EXPORT") and self.scene.encoding is Encoding.CLASSIC:
            parent.fields.append(("", self._link_statement(word)))
        else:
            parent.fields.append((place, self._node_value()))

    def _count(self) -> None:
        self.n_items += 1
        if self.n_items > MAX_ITEMS:
            raise self.tokens.wrong("the scene is too large", wanted=f"at most {MAX_ITEMS} fields and statements")

    def _dotted(self) -> tuple[str, str]:
        node = self.tokens.take("word", "the name of a node")
        self.tokens.expect(".")
        return node, self.tokens.take("word", "the name of a field")

    def _link_statement(self, kind: str) -> Statement:
        tokens = self.tokens
        tokens.advance()
        if kind == "IMPORT":
            inline, name = self._dotted()
            words = [("inlineDEF", inline), ("importedDEF", name)]
        else:
            words = [("localDEF", tokens.take("word", "the name of a node"))]
        if tokens.kind == "word" and tokens.word == "AS":
            tokens.advance()
            words.append(("AS", tokens.take("word", "a name")))
        return Statement(kind, tuple(words))

    def _node_value(self) -> Node | Use | None:
        """Read NULL, USE or a node with or without DEF."""
        tokens = self.tokens
        word = tokens.take("word", "a node")
        if word == "NULL":
            return None
        if word == "USE":
            return Use(tokens.take("word", "the name of a node"))
        name = None
        if word == "DEF":
            name = tokens.take("word", "a name")
            word = tokens.take("word", "the type of a node")
        return self._node_body(Node(word, name))

    def _node_body(self, node: Node) -> Node:
        tokens = self.tokens
        self.n_nodes += 1
        self.depth += 1
        if self.n_nodes > MAX_NODES:
            raise tokens.wrong("the scene is too large", wanted=f"at most {MAX_NODES} nodes")
        if self.depth > MAX_DEPTH:
            raise tokens.wrong("the scene is nested too deeply", wanted=f"at most {MAX_DEPTH} levels")
        tokens.expect("{")
        while not (tokens.kind == "mark" and tokens.word == "}"):
            if tokens.kind != "word":
                raise tokens.wrong("the file breaks its grammar", wanted="the name of a field or }")
            if tokens.word in ("ROUTE", "PROTO", "EXTERNPROTO"):
                self._statement(node, "")
                continue
            name = tokens.word
            tokens.advance()
            if name in _ACCESS_WORDS and tokens.kind == "word" and _FIELD_TYPE.fullmatch(tokens.word):
                node.fields.append(("", self._declared(name)))
            else:
                self._field(node, name)
        tokens.advance()
        self.depth -= 1
        return node

    def _field(self, node: Node, name: str) -> None:
        self._count()
        tokens = self.tokens
        if tokens.kind == "word" and tokens.word == "IS":
            tokens.advance()
            node.fields.append((name, Is(tokens.take("word", "a field of the PROTO"))))
            return
        kind = self.types.get((node.type, name)) or field_type(node.type, name)
        node.fields.extend((name, value) for value in self._values(kind))

    def _values(self, kind: str | None) -> list[Any]:
        """Read a field's value: one, or one a node."""
        tokens = self.tokens
        if tokens.kind == "mark" and tokens.word == "[":
            tokens.advance()
            values = self._list(kind)
            tokens.expect("]")
            return values
        if tokens.kind == "string":
            text = unquoted(tokens.word)
            tokens.advance()
            return [(text,) if kind == "MFString" else text]
        if tokens.kind == "word" and tokens.word in ("TRUE", "FALSE"):
            flag = tokens.word == "TRUE"
            tokens.advance()
            return [(flag,) if kind == "MFBool" else flag]
        if self._at_number():
            return [self._numbers(kind)]
        if tokens.kind != "word":
            raise tokens.wrong("the file breaks its grammar", wanted="a value")
        value = self._node_value()
        return [] if value is None and kind is not None else [value]

    def _list(self, kind: str | None) -> list[Any]:
        tokens = self.tokens
        found: Any
        if tokens.kind == "string":
            texts = []
            while tokens.kind == "string":
                texts.append(unquoted(tokens.word))
                tokens.advance()
            found = tuple(texts)
        elif self._at_number():
            found = self._numbers(kind)
        elif tokens.kind == "word" and tokens.word in ("TRUE", "FALSE"):
            flags = []
            while tokens.kind == "word" and tokens.word in ("TRUE", "FALSE"):
                flags.append(tokens.word == "TRUE")
                tokens.advance()
            found = tuple(flags)
        elif tokens.kind == "word":
            holder = Node("")
            while tokens.kind == "word":
                self._statement(holder, "children")
            return [value for _, value in holder.fields]
        else:  # an empty list
            if kind is None:
                return [Listed(())]
            if kind.endswith("Node"):
                return []
            found = () if kind in ("MFString", "MFBool") else np.zeros(0, np.int64 if kind in _WHOLE else np.float64)
        return [Listed(found) if kind is None else found]

    def _at_number(self) -> bool:
        tokens = self.tokens
        return tokens.kind == "numbers" or (tokens.kind == "word" and _NOT_A_NUMBER.fullmatch(tokens.word) is not None)

    def _numbers(self, kind: str | None) -> Any:
        tokens = self.tokens
        start = tokens.start
        words = []
        while self._at_number():
            words.append(tokens.word)
            tokens.advance()
        values = parse_numbers(" ".join(words) if len(words) > 1 else words[0], kind in _WHOLE)
        if values is None:
            tokens.start = start
            raise tokens.wrong("these are no numbers", wanted="numbers")
        return values

    def _proto(self) -> Proto:
        tokens = self.tokens
        tokens.advance()
        proto = Proto(tokens.take("word", "the name of the PROTO"))
        self._interface(proto, with_values=True)
        tokens.expect("{")
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise tokens.wrong("the scene is nested too deeply", wanted=f"at most {MAX_DEPTH} levels")
        proto.body = Node("ProtoBody")
        while not (tokens.kind == "mark" and tokens.word == "}"):
            if tokens.kind != "word":
                raise tokens.wrong("the file breaks its grammar", wanted="a node or }")
            self._statement(proto.body, "children")
        tokens.advance()
        self.depth -= 1
        return proto

    def _extern_proto(self) -> Proto:
        tokens = self.tokens
        tokens.advance()
        proto = Proto(tokens.take("word", "the name of the PROTO"))
        self._interface(proto, with_values=False)
        urls = self._values("MFString")
        proto.urls = urls[0] if urls and isinstance(urls[0], tuple) else ()
        return proto

    def _interface(self, proto: Proto, *, with_values: bool) -> None:
        tokens = self.tokens
        tokens.expect("[")
        while tokens.kind == "word":
            access = tokens.word
            if access not in _ACCESS_WORDS:
                raise tokens.wrong("the file breaks its grammar", wanted="field, exposedField, eventIn or eventOut")
            tokens.advance()
            declared = self._declared(access, with_values=with_values)
            proto.interface.append(declared)
            self.types[(proto.name, declared.name)] = declared.type
        tokens.expect("]")

    def _declared(self, access: str, *, with_values: bool = True) -> Declared:
        self._count()
        tokens = self.tokens
        kind = tokens.take("word", "the type of a field")
        declared = Declared(_ACCESS_WORDS[access], kind, tokens.take("word", "the name of a field"))
        if declared.access in ("initializeOnly", "inputOutput") and with_values:
            if tokens.kind == "word" and tokens.word == "IS":
                tokens.advance()
                declared.values = [Is(tokens.take("word", "a field of the PROTO"))]
            else:
                declared.values = self._values(kind)
        return declared
