"""A skeleton as plain JSON values, for files that carry their skeleton along."""

from __future__ import annotations

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

_Part = TypeVar("_Part")


def skeleton_to_json(skeleton: Skeleton) -> dict[str, Any]:
    """Return a skeleton as JSON values: metres and radians; what has its default value is left out."""
    return {
        "name": skeleton.name,
        "kind": str(skeleton.kind),
        "metres_per_unit": skeleton.metres_per_unit,
        "joints": [_joint_to_json(joint) for joint in skeleton.joints],
        "end_sites": [{"name": s.name, "joint": s.joint, "offset": list(s.offset)} for s in skeleton.end_sites],
        "columns": [_column_to_json(column) for column in skeleton.columns],
        "points": list(skeleton.points),
    }


def skeleton_from_json(values: Any) -> Skeleton:
    """Return the skeleton that JSON values describe.

    Raises `FormatError` for values that are missing, of the wrong type or out of range, and for parts that do not fit.
    """
    values = _mapping(values, "skeleton")
    return Skeleton(
        name=_text(values, "name"),
        kind=_one_of(SkeletonKind, values, "kind"),
        joints=_parts(values, "joints", _joint_from_json),
        end_sites=_parts(values, "end_sites", _end_site_from_json),
        columns=_parts(values, "columns", _column_from_json),
        points=_integers(values, "points"),
        metres_per_unit=_positive(values, "metres_per_unit"),
    )


def _joint_to_json(joint: Joint) -> dict[str, Any]:
    result: dict[str, Any] = {"name": joint.name, "parent": joint.parent, "offset": list(joint.offset)}
    if joint.product:
        result["product"] = list(joint.product)
    if joint.orientation != IDENTITY:
        result["orientation"] = [list(row) for row in joint.orientation]
    return result


def _column_to_json(column: Column) -> dict[str, Any]:
    result: dict[str, Any] = {
        "name": column.name,
        "joint": column.joint,
        "kind": str(column.kind),
        "axis": column.axis,
        "level": column.level,
    }
    if column.sign != 1:
        result["sign"] = column.sign
    if column.rest:
        result["rest"] = column.rest
    if column.limits is not None:
        result["limits"] = list(column.limits)
    if column.bap_id is not None:
        result["bap_id"] = column.bap_id
    return result


def _joint_from_json(values: dict[str, Any]) -> Joint:
    return Joint(
        name=_text(values, "name"),
        parent=_integer(values, "parent"),
        offset=_vector(values.get("offset"), "offset"),
        product=_integers(values, "product") if "product" in values else (),
        orientation=_matrix(values["orientation"]) if "orientation" in values else IDENTITY,
    )


def _end_site_from_json(values: dict[str, Any]) -> EndSite:
    return EndSite(_text(values, "name"), _integer(values, "joint"), _vector(values.get("offset"), "offset"))


def _column_from_json(values: dict[str, Any]) -> Column:
    level = _integer(values, "level")
    if not 1 <= level <= MAX_LEVEL:
        raise _wrong("level", f"1 to {MAX_LEVEL}", level)
    limits = _numbers(values["limits"], 2, "limits") if "limits" in values else None
    return Column(
        name=_text(values, "name"),
        joint=_integer(values, "joint"),
        kind=_one_of(ColumnKind, values, "kind"),
        axis=_integer(values, "axis"),
        sign=_integer(values, "sign") if "sign" in values else 1,
        level=level,
        rest=_number(values["rest"], "rest") if "rest" in values else 0.0,
        limits=None if limits is None else (limits[0], limits[1]),
        bap_id=_integer(values, "bap_id") if "bap_id" in values else None,
    )


def _parts(values: dict[str, Any], key: str, read: Callable[[dict[str, Any]], _Part]) -> tuple[_Part, ...]:
    return tuple(read(_mapping(part, key)) for part in _list(values.get(key), key))


def _mapping(value: Any, what: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise _wrong(what, "an object", value)
    return value


def _list(value: Any, what: str) -> list[Any]:
    if not isinstance(value, list):
        raise _wrong(what, "a list", value)
    return value


def _text(values: dict[str, Any], key: str) -> str:
    value = values.get(key)
    if not isinstance(value, str):
        raise _wrong(key, "text", value)
    return value


def _one_of(kind: Callable[[str], _Part], values: dict[str, Any], key: str) -> _Part:
    try:
        return kind(_text(values, key))
    except ValueError as problem:
        raise _wrong(key, "a known kind", values[key]) from problem


def _integer(values: dict[str, Any], key: str) -> int:
    return _as_integer(values.get(key), key)


def _integers(values: dict[str, Any], key: str) -> tuple[int, ...]:
    return tuple(_as_integer(value, key) for value in _list(values.get(key), key))


def _as_integer(value: Any, what: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not -(2**31) <= value < 2**31:
        raise _wrong(what, "an integer", value)
    return value


def _number(value: Any, what: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise _wrong(what, "a number", value)
    return float(value)


def _positive(values: dict[str, Any], key: str) -> float:
    number = _number(values.get(key), key)
    if number <= 0:
        raise _wrong(key, "above 0", number)
    return number


def _numbers(value: Any, count: int, what: str) -> tuple[float, ...]:
    numbers = tuple(_number(part, what) for part in _list(value, what))
    if len(numbers) != count:
        raise _wrong(what, f"{count} numbers", len(numbers))
    return numbers


def _vector(value: Any, what: str) -> Vector3:
    x, y, z = _numbers(value, 3, what)
    return (x, y, z)


def _matrix(value: Any) -> Matrix3:
    rows = [_vector(row, "orientation") for row in _list(value, "orientation")]
    if len(rows) != 3:
        raise _wrong("orientation", "3 rows", len(rows))
    return (rows[0], rows[1], rows[2])


def _wrong(what: str, wanted: str, got: object) -> FormatError:
    shown = str(got)[:60]
    return FormatError(f"the skeleton's {what} is not what it should be", wanted=wanted, got=shown)
