"""Parsing Acclaim skeleton files (ASF): bones with a direction, a length and axes, and the tree they form."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.rotation import euler_matrix

UNIT_COMMENT = "metres-per-unit"
"""A comment of our own files that says the length unit outright, where other files leave it to be guessed."""
_UNIT_LINE = re.compile(rb"^#\s*" + UNIT_COMMENT.encode() + rb"\s+([0-9.eE+-]{1,30})\s*$", re.MULTILINE)
LARGEST = 1e9
"""The largest length or angle that is taken: beyond it arithmetic on poses in single precision breaks down."""

_DOFS = ("tx", "ty", "tz", "rx", "ry", "rz")
_Row = tuple[int, list[str]]
_NO_ROW: _Row = (0, [])


@dataclass(frozen=True, slots=True, eq=False)
class Bone:
    """A bone as the file gives it: `vector` (3,) from near to far end at rest in file units, `frame` (3, 3) its C.

    `order` is the order in which rotations are applied ("xyz" means Rz @ Ry @ Rx), `dofs` that of the values in an AMC,
    `limits` one pair per dof in radians or file units. The root's `vector`
    is its position, its `frame` its orientation.
    """

    name: str
    line: int
    vector: FloatArray
    frame: FloatArray
    order: str
    dofs: tuple[str, ...]
    limits: tuple[tuple[float, float] | None, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Asf:
    """A parsed ASF: bones by name in an order that puts parents first, the root leading; `parents` of all but the root.

    `listed` are the names in the order of the file, root first. `unit_length` is the file's own number, 0.45 at CMU.
    """

    name: str
    bones: dict[str, Bone]
    parents: dict[str, str]
    listed: tuple[str, ...]
    unit_length: float
    metres_per_unit: float | None
    degrees: bool


def parse_asf(data: bytes) -> Asf:
    """Parse the bytes of an ASF; raises `FormatError` with the line where they are not one."""
    sections = _sections(data)
    for wanted in (":root", ":bonedata", ":hierarchy"):
        if wanted not in sections:
            raise FormatError("the skeleton file lacks a section", wanted=wanted, hint="The file may be cut off")
    unit_length, degrees = _units(sections.get(":units", []))
    root = _root(sections[":root"], degrees=degrees)
    bones = {root.name: root}
    for bone in _bones(sections[":bonedata"], degrees=degrees):
        if bone.name in bones:
            raise FormatError("a bone is defined twice", at=f"line {bone.line}", got=bone.name)
        bones[bone.name] = bone
    parents = _hierarchy(sections[":hierarchy"], bones)
    stated = _UNIT_LINE.search(data)
    name_rows = sections.get(":name", [])
    return Asf(
        name=" ".join(name_rows[0][1]) if name_rows else "skeleton",
        bones={name: bones[name] for name in _parents_first(bones, parents)},
        parents=parents,
        listed=tuple(bones),
        unit_length=unit_length,
        metres_per_unit=_stated_unit(stated.group(1)) if stated else None,
        degrees=degrees,
    )


def _sections(data: bytes) -> dict[str, list[_Row]]:
    """Return the rows (line number, words) of each `:section`, comments and blank lines left out."""
    sections: dict[str, list[_Row]] = {}
    rows: list[_Row] = []
    for line, raw in enumerate(data.removeprefix(b"\xef\xbb\xbf").splitlines(), start=1):
        words = raw.split(b"#", 1)[0].decode("utf-8", "replace").split()
        if not words:
            continue
        if words[0].startswith(":"):
            rows = sections.setdefault(words[0].lower(), [])
            words = words[1:]
        if words:
            rows.append((line, words))
    return sections


def _units(rows: list[_Row]) -> tuple[float, bool]:
    fields = {words[0].lower(): (line, words[1:]) for line, words in rows}
    (length,) = _numbers(fields["length"], 1) if "length" in fields else [1.0]
    if length < 1e-6:
        raise FormatError(
            "the length unit is not positive",
            at=f"line {fields['length'][0]}",
            wanted="such as 0.45",
            got=f"{length:g}",
        )
    line, words = fields.get("angle", (0, ["deg"]))
    angle = words[0].lower() if words else ""
    if angle[:3] not in ("deg", "rad"):
        raise FormatError("the angle unit is unknown", at=f"line {line}", wanted="deg or rad", got=angle)
    return length, angle.startswith("deg")


def _root(rows: list[_Row], *, degrees: bool) -> Bone:
    fields = {words[0].lower(): (line, words[1:]) for line, words in rows}
    line, words = fields.get("order", (rows[0][0] if rows else 0, list(_DOFS)))
    dofs = _checked_dofs(line, words, allowed=_DOFS)
    order = _order(fields["axis"][0], fields["axis"][1][-1:]) if "axis" in fields else "xyz"
    position = np.array(_numbers(fields["position"], 3) if "position" in fields else [0.0] * 3)
    turned = np.array(_numbers(fields["orientation"], 3) if "orientation" in fields else [0.0] * 3)
    return Bone("root", line, position, _frame(turned, order, degrees=degrees), order, dofs, (None,) * len(dofs))


def _bones(rows: list[_Row], *, degrees: bool) -> Iterator[Bone]:
    fields: dict[str, _Row] | None = None
    key, start = "", 0
    for line, words in rows:
        word = words[0].lower()
        if word == "begin":
            fields, key, start = {}, "", line
        elif fields is None:
            raise FormatError("a line stands outside any bone", at=f"line {line}", wanted="begin", got=words[0])
        elif word == "end":
            yield _bone(fields, start, degrees=degrees)
            fields = None
        elif word.startswith("(") and key == "limits":
            fields[key][1].extend(words)
        else:
            key = word
            fields[key] = (line, words[1:])
    if fields is not None:
        raise FormatError("the file ends inside a bone", at=f"line {start}", wanted="end")


def _bone(fields: dict[str, _Row], line: int, *, degrees: bool) -> Bone:
    names = fields.get("name", _NO_ROW)[1]
    if not names:
        raise FormatError("a bone has no name", at=f"line {line}")
    for key in ("direction", "length"):
        if key not in fields:
            raise FormatError(f"bone {names[0]} has no {key}", at=f"line {line}")
    axis_line, axis = fields.get("axis", (line, ["0", "0", "0", "XYZ"]))
    order = _order(axis_line, axis[3:])
    dof_line, words = fields.get("dof", _NO_ROW)
    dofs = _checked_dofs(dof_line, words, allowed=_DOFS[3:])
    (length,) = _numbers(fields["length"], 1)
    return Bone(
        name=names[0],
        line=line,
        vector=np.array(_numbers(fields["direction"], 3)) * length,
        frame=_frame(np.array(_numbers((axis_line, axis), 3)), order, degrees=degrees),
        order=order,
        dofs=dofs,
        limits=_limits(fields.get("limits", _NO_ROW), len(dofs), degrees=degrees),
    )


def _checked_dofs(line: int, words: list[str], *, allowed: tuple[str, ...]) -> tuple[str, ...]:
    dofs = tuple(word.lower() for word in words)
    for dof in dofs:
        if dof not in allowed or dofs.count(dof) > 1:
            wanted = f"each of {' '.join(allowed)} at most once"
            raise FormatError("a degree of freedom cannot be used", at=f"line {line}", wanted=wanted, got=dof)
    return dofs


def _order(line: int, words: list[str]) -> str:
    order = words[0].lower() if words else "xyz"
    if sorted(order) != ["x", "y", "z"]:
        raise FormatError("the order of axes is not one", at=f"line {line}", wanted="such as XYZ", got=order)
    return order


def _frame(angles: FloatArray, order: str, *, degrees: bool) -> FloatArray:
    turned = np.radians(angles) if degrees else angles
    return euler_matrix(np.array([turned["xyz".index(letter)] for letter in reversed(order)]), order[::-1])


def _limits(row: _Row, count: int, *, degrees: bool) -> tuple[tuple[float, float] | None, ...]:
    line, words = row
    if not words:
        return (None,) * count
    numbers = _numbers((line, " ".join(words).replace("(", " ").replace(")", " ").split()), 2 * count, infinite=True)
    scale = math.pi / 180 if degrees else 1.0
    pairs = [(low * scale, high * scale) for low, high in zip(numbers[::2], numbers[1::2], strict=True)]
    return tuple(None if math.isinf(low) and math.isinf(high) else (low, high) for low, high in pairs)


def _numbers(row: _Row, count: int, *, infinite: bool = False) -> list[float]:
    """Return the first `count` words of a row as numbers."""
    line, words = row
    if len(words) < count:
        raise FormatError("numbers are missing", at=f"line {line}", wanted=str(count), got=str(len(words)))
    numbers = []
    for word in words[:count]:
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if math.isnan(number) or (abs(number) > LARGEST and not (infinite and math.isinf(number))):
            raise FormatError("a number cannot be used", at=f"line {line}", wanted="a finite number", got=word[:40])
        numbers.append(number)
    return numbers


def _stated_unit(text: bytes) -> float | None:
    try:
        unit = float(text)
    except ValueError:
        return None
    return unit if 1e-6 <= unit <= 1e6 else None


def _hierarchy(rows: list[_Row], bones: dict[str, Bone]) -> dict[str, str]:
    parents: dict[str, str] = {}
    for line, words in rows:
        if len(words) == 1 and words[0].lower() in ("begin", "end"):
            continue
        for name in words:
            if name not in bones:
                raise FormatError("the hierarchy names an unknown bone", at=f"line {line}", got=name)
        for child in words[1:]:
            if child in parents or child == "root":
                raise FormatError("a bone has two parents", at=f"line {line}", got=child)
            parents[child] = words[0]
    return parents


def _parents_first(bones: dict[str, Bone], parents: dict[str, str]) -> list[str]:
    """Return the bones from the root outwards, limb after limb; a bone that is never reached hangs in a cycle."""
    children: dict[str, list[str]] = {}
    for child, parent in parents.items():
        children.setdefault(parent, []).append(child)
    order, waiting = [], ["root"]
    while waiting:
        name = waiting.pop()
        order.append(name)
        waiting.extend(reversed(children.get(name, [])))
    if len(order) < len(bones):
        reached = set(order)
        lost = next(name for name in bones if name not in reached)
        raise FormatError(
            "a bone does not hang from the root",
            at=f"line {bones[lost].line}",
            got=lost,
            hint="Its parents in :hierarchy are missing or form a cycle",
        )
    return order
