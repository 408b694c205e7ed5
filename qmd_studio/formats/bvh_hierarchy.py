"""The HIERARCHY of a BVH file: text to a flat list of joints and end sites, in all dialects met so far.

Keywords in any case, braces and line breaks anywhere, names with blanks, no CHANNELS line, CHANNELS 0, one or three or
six channels on any joint, several roots, decimal commas. The walk keeps its own stack, so depth costs no recursion.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from qmd_studio.errors import FormatError
from qmd_studio.motion.skeleton import Vector3

_WORD = re.compile(r"[{}]|[^\s{}]+")
_NAME = re.compile(r"[^{}\r\n]*")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:[.,][0-9]*)?|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?")
_CHANNEL = re.compile(r"([xyz])(position|rotation)", re.IGNORECASE)
_NEWLINE = re.compile(r"\r\n|\r|\n")

SHOWN_CHARACTERS = 40
"""How much of a wrong word an error shows."""


@dataclass(slots=True)
class BvhNode:
    """A joint or end site as the file has it: `offset` in file units, `channels` such as ("Xposition", "Zrotation")."""

    name: str
    parent: int
    is_site: bool = False
    offset: Vector3 | None = None
    channels: tuple[str, ...] = ()


@dataclass(slots=True)
class _Scanner:
    text: str
    position: int = 0
    start: int = 0

    def word(self) -> str:
        """Return the next word or brace, or "" at the end."""
        found = _WORD.search(self.text, self.position)
        if found is None:
            self.start = self.position = len(self.text)
            return ""
        self.start, self.position = found.span()
        return found.group()

    def name(self) -> str:
        """Return the rest of the line up to a brace: a name may hold blanks."""
        found = _NAME.match(self.text, self.position)
        assert found is not None  # the pattern matches the empty text
        self.position = found.end()
        return found.group().strip()

    def skip_blanks(self) -> None:
        """Go to the next character that is not blank, over line ends."""
        while self.position < len(self.text) and self.text[self.position].isspace():
            self.position += 1

    def line(self) -> int:
        """Return the line of the last word, counted from 1."""
        return 1 + sum(1 for _ in _NEWLINE.finditer(self.text, 0, self.start))

    def error(self, message: str, *, wanted: str | None = None, got: str | None = None) -> FormatError:
        shown = got if got is None or len(got) <= SHOWN_CHARACTERS else f"{got[:SHOWN_CHARACTERS]}…"
        return FormatError(message, at=f"line {self.line()}", wanted=wanted, got=shown or "the end of the file")


def parse_hierarchy(text: str) -> list[BvhNode]:
    """Parse everything before MOTION into joints and end sites, in the order of the file, parents by list index.

    Raises `FormatError` with the line.
    """
    scanner = _Scanner(text)
    first = scanner.word()
    if first.lower() != "hierarchy":
        raise scanner.error("the file does not begin as BVH does", wanted="HIERARCHY", got=first)
    nodes: list[BvhNode] = []
    stack: list[int] = []
    while word := scanner.word():
        key = word.lower()
        if key in ("root", "joint", "end"):
            stack.append(_open_node(scanner, key, nodes, stack))
        elif word == "}" and stack:
            _close_node(scanner, nodes[stack.pop()])
        elif key == "offset" and stack:
            nodes[stack[-1]].offset = _vector(scanner)
        elif key == "channels" and stack:
            nodes[stack[-1]].channels = _channels(scanner, nodes[stack[-1]])
        else:
            wanted = "JOINT, End Site, OFFSET, CHANNELS or }" if stack else "ROOT or MOTION"
            raise scanner.error("this word does not belong here", wanted=wanted, got=word)
    if stack:
        raise scanner.error(f"the joint {nodes[stack[-1]].name!r} is not closed", wanted="}", got="")
    if not nodes:
        raise scanner.error("the hierarchy has no joint", wanted="ROOT", got="")
    return nodes


def parse_number(word: str) -> float:
    """Return a decimal number, with point or comma; raises `ValueError` for anything else and for infinity."""
    if not _NUMBER.fullmatch(word):
        raise ValueError(word)
    value = float(word.replace(",", "."))
    if not math.isfinite(value):
        raise ValueError(word)
    return value


def _open_node(scanner: _Scanner, key: str, nodes: list[BvhNode], stack: list[int]) -> int:
    if (key == "root") == bool(stack) or (stack and nodes[stack[-1]].is_site):
        raise scanner.error(f"{key.upper()} does not belong here", wanted="ROOT outside, JOINT and End Site inside")
    name = scanner.name()
    if key == "end":
        name = re.sub(r"(?i)\A(?:site\b)?\s*", "", name)
    elif not name:
        scanner.skip_blanks()
        name = scanner.name()
        if not name:
            raise scanner.error("a joint has no name", wanted=f"a name after {key.upper()}", got="nothing")
    brace = scanner.word()
    if brace != "{":
        raise scanner.error(f"{name or 'End Site'!r} does not begin with a brace", wanted="{", got=brace)
    nodes.append(BvhNode(name, stack[-1] if stack else -1, is_site=key == "end"))
    return len(nodes) - 1


def _close_node(scanner: _Scanner, node: BvhNode) -> None:
    if node.offset is None:
        raise scanner.error(f"{node.name or 'End Site'!r} has no OFFSET", wanted="OFFSET x y z", got="}")


def _vector(scanner: _Scanner) -> Vector3:
    values = []
    for _ in range(3):
        word = scanner.word()
        try:
            values.append(parse_number(word))
        except ValueError:
            raise scanner.error("an OFFSET is not three numbers", wanted="a number", got=word) from None
    return (values[0], values[1], values[2])


def _channels(scanner: _Scanner, node: BvhNode) -> tuple[str, ...]:
    count = scanner.word()
    if not re.fullmatch(r"[0-9]{1,3}", count):
        raise scanner.error("CHANNELS has no count", wanted="a number", got=count)
    names: list[str] = []
    for _ in range(int(count)):
        word = scanner.word()
        found = _CHANNEL.fullmatch(word)
        if found is None:
            raise scanner.error(
                "this is no channel", wanted=f"{count} of Xposition … Zposition, Xrotation … Zrotation", got=word
            )
        names.append(found.group(1).upper() + found.group(2).lower())
    if node.is_site and names:
        raise scanner.error("an End Site has channels", wanted="OFFSET only", got=f"CHANNELS {count}")
    return tuple(names)
