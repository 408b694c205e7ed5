"""A skeleton as JSON and back, equal to the last bit: what CSV, NPZ and QMD files carry with a motion.

    {"name", "kind", "metres_per_unit", "points": [node, ...],
     "joints": [{"name", "parent", "offset": [x, y, z], "product": [column, ...], "orientation": [[...], ...]}, ...],
     "end_sites": [{"name", "joint", "offset"}, ...],
     "columns": [{"name", "joint", "kind", "axis", "sign", "level", "rest", "limits": [low, high], "bap_id"}, ...]}

A key that holds its default (see `qmd_studio.motion.skeleton`) is left out; lengths are metres, angles radians. A side
without a limit is null.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any, TypeVar

from qmd_studio.errors import FormatError
from qmd_studio.motion.skeleton import (
    IDENTITY,
    MAX_LEVEL,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Matrix3,
    Skeleton,
    SkeletonKind,
    Vector3,
)

MAX_JSON_BYTES = 4 << 20
"""Longer texts are refused unread: a body of a thousand columns needs a fortieth of it."""

MAX_JOINTS = 4096
"""Joints, and likewise end sites, of a figure: many times what the finest hands and faces take."""

MAX_COLUMNS = 16384

_MOST = {"joints": MAX_JOINTS, "end_sites": MAX_JOINTS, "columns": MAX_COLUMNS, "points": 2 * MAX_JOINTS}

_ORTHONORMAL = 1e-6
"""How far the products of an orientation's rows may be from those of a rotation."""

_Part = TypeVar("_Part")


def json_text(values: dict[str, Any]) -> str:
    """Return `values` as one line of compact JSON, names in their own letters."""
    return json.dumps(values, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def parse_json(text: str | bytes, *, limit: int = MAX_JSON_BYTES) -> dict[str, Any]:
    """Parse a JSON object of at most `limit` bytes, without NaN or infinity; raises `FormatError`."""
    if len(text) > limit:
        raise FormatError("the JSON text is too long", wanted=f"at most {limit} bytes", got=str(len(text)))
    try:
        parsed = json.loads(text if isinstance(text, str) else text.decode(), parse_constant=_refuse_constant)
    except RecursionError:
        raise FormatError("the JSON text is nested too deeply") from None
    except ValueError as problem:  # JSON and UTF-8 errors, and integers of thousands of digits
        raise FormatError("the JSON text cannot be read", got=str(problem)[:80]) from None
    return _object(parsed, "the JSON text")


def skeleton_to_json(skeleton: Skeleton) -> dict[str, Any]:
    """Return `skeleton` as JSON values; what has its default value is left out.

    Raises `FormatError` for one of so many parts that `skeleton_from_json` would refuse it.
    """
    for key, most in _MOST.items():
        _check_count(key, len(getattr(skeleton, key)), most)
    return {
        "name": skeleton.name,
        "kind": skeleton.kind.value,
        "metres_per_unit": skeleton.metres_per_unit,
        "joints": [_joint_to_dict(joint) for joint in skeleton.joints],
        "end_sites": [{"name": s.name, "joint": s.joint, "offset": list(s.offset)} for s in skeleton.end_sites],
        "columns": [_column_to_dict(column) for column in skeleton.columns],
        "points": list(skeleton.points),
    }


def skeleton_from_json(values: Any) -> Skeleton:
    """Return the skeleton that JSON values describe; raises `FormatError` naming the key that is wrong."""
    document = _object(values, "skeleton")
    return Skeleton(
        name=_text(document, "name", "skeleton"),
        kind=_choice(SkeletonKind, document, "kind", "skeleton"),
        joints=_parts(document, "joints", _joint),
        end_sites=_parts(document, "end_sites", _end_site),
        columns=_parts(document, "columns", _column),
        points=_points(document),
        metres_per_unit=_number(document, "metres_per_unit", "skeleton"),
    )


def _joint_to_dict(joint: Joint) -> dict[str, Any]:
    entry: dict[str, Any] = {"name": joint.name, "parent": joint.parent, "offset": list(joint.offset)}
    if joint.product:
        entry["product"] = list(joint.product)
    if joint.orientation != IDENTITY:
        entry["orientation"] = [list(row) for row in joint.orientation]
    return entry


def _column_to_dict(column: Column) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "name": column.name,
        "joint": column.joint,
        "kind": column.kind.value,
        "axis": column.axis,
        "level": column.level,
    }
    if column.sign != 1:
        entry["sign"] = column.sign
    if column.rest != 0.0:
        entry["rest"] = column.rest
    if column.limits is not None:
        entry["limits"] = [limit if math.isfinite(limit) else None for limit in column.limits]
    if column.bap_id is not None:
        entry["bap_id"] = column.bap_id
    return entry


def _joint(entry: dict[str, Any], where: str) -> Joint:
    orientation = IDENTITY
    if "orientation" in entry:
        rows = entry["orientation"]
        if not isinstance(rows, list) or len(rows) != 3:
            raise _wrong(f"{where}.orientation", "three rows of three numbers", rows)
        orientation = _matrix(rows, f"{where}.orientation")
    return Joint(
        name=_text(entry, "name", where),
        parent=_integer(entry, "parent", where),
        offset=_vector(entry.get("offset"), f"{where}.offset"),
        product=_integers(entry, "product", where) if "product" in entry else (),
        orientation=orientation,
    )


def _end_site(entry: dict[str, Any], where: str) -> EndSite:
    offset = _vector(entry.get("offset"), f"{where}.offset")
    return EndSite(_text(entry, "name", where), _integer(entry, "joint", where), offset)


def _column(entry: dict[str, Any], where: str) -> Column:
    level = _integer(entry, "level", where)
    if not 1 <= level <= MAX_LEVEL:
        raise _wrong(f"{where}.level", f"1 to {MAX_LEVEL}", level)
    limits = None
    if entry.get("limits") is not None:
        limits = _limits(entry["limits"], f"{where}.limits")
    return Column(
        name=_text(entry, "name", where),
        joint=_integer(entry, "joint", where),
        kind=_choice(ColumnKind, entry, "kind", where),
        axis=_integer(entry, "axis", where),
        sign=_integer(entry, "sign", where) if "sign" in entry else 1,
        level=level,
        rest=_number(entry, "rest", where) if "rest" in entry else 0.0,
        limits=limits,
        bap_id=_integer(entry, "bap_id", where) if entry.get("bap_id") is not None else None,
    )


def _parts(document: dict[str, Any], key: str, build: Callable[[dict[str, Any], str], _Part]) -> tuple[_Part, ...]:
    entries = document.get(key)
    if not isinstance(entries, list):
        raise _wrong(key, "a list", entries)
    _check_count(key, len(entries), _MOST[key])
    return tuple(build(_object(entry, f"{key}[{index}]"), f"{key}[{index}]") for index, entry in enumerate(entries))


def _points(document: dict[str, Any]) -> tuple[int, ...]:
    points = _integers(document, "points", "skeleton")
    _check_count("points", len(points), _MOST["points"])
    return points


def _check_count(key: str, count: int, most: int) -> None:
    if count > most:
        raise FormatError("the skeleton has too many parts", at=f"its {key}", wanted=f"at most {most}", got=str(count))


def _object(value: object, where: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise _wrong(where, "an object", value)
    return value


def _text(entry: dict[str, Any], key: str, where: str) -> str:
    value = entry.get(key)
    if not isinstance(value, str):
        raise _wrong(f"{where}.{key}", "a text", value)
    return value


def _integer(entry: dict[str, Any], key: str, where: str) -> int:
    return _as_integer(entry.get(key), f"{where}.{key}")


def _integers(entry: dict[str, Any], key: str, where: str) -> tuple[int, ...]:
    values = entry.get(key)
    if not isinstance(values, list):
        raise _wrong(f"{where}.{key}", "a list of whole numbers", values)
    return tuple(_as_integer(value, f"{where}.{key}") for value in values)


def _as_integer(value: object, where: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) > 1 << 31:
        raise _wrong(where, "a whole number", value)
    return value


def _number(entry: dict[str, Any], key: str, where: str) -> float:
    return _as_number(entry.get(key), f"{where}.{key}")


def _as_number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= 1e300:
        raise _wrong(where, "a finite number", value)
    return float(value)


def _numbers(values: object, count: int, where: str) -> tuple[float, ...]:
    if not isinstance(values, list) or len(values) != count:
        raise _wrong(where, f"{count} numbers", values)
    return tuple(_as_number(value, where) for value in values)


def _vector(values: object, where: str) -> Vector3:
    x, y, z = _numbers(values, 3, where)
    return (x, y, z)


def _limits(values: object, where: str) -> tuple[float, float]:
    if not isinstance(values, list) or len(values) != 2:
        raise _wrong(where, "two numbers, or null on a side without a limit", values)
    low, high = values
    return (
        -math.inf if low is None else _as_number(low, where),
        math.inf if high is None else _as_number(high, where),
    )


def _matrix(rows: list[object], where: str) -> Matrix3:
    first, second, third = matrix = tuple(_vector(row, where) for row in rows)
    for i, row in enumerate(matrix):
        for j, other in enumerate(matrix):
            product = sum(a * b for a, b in zip(row, other, strict=True))
            if not abs(product - (i == j)) <= _ORTHONORMAL:
                raise _wrong(where, "the three rows of a rotation", rows)
    return (first, second, third)


_Kind = TypeVar("_Kind", SkeletonKind, ColumnKind)


def _choice(kinds: type[_Kind], entry: dict[str, Any], key: str, where: str) -> _Kind:
    value = _text(entry, key, where)
    try:
        return kinds(value)
    except ValueError:
        raise _wrong(f"{where}.{key}", ", ".join(kind.value for kind in kinds), value) from None


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number")


def _wrong(where: str, wanted: str, got: object) -> FormatError:
    if isinstance(got, int) and abs(got) > 1 << 64:
        shown = "a huge number"  # its digits may be too many to print
    else:
        shown = "nothing" if got is None else repr(got)[:40] if not isinstance(got, list | dict) else type(got).__name__
    return FormatError("the skeleton's description is wrong", at=where, wanted=wanted, got=shown)
