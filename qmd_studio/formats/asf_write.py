"""Writing an Acclaim skeleton file from a skeleton of that kind."""

from __future__ import annotations

import math
from itertools import groupby, permutations

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf_parse import LARGEST, UNIT_COMMENT
from qmd_studio.motion.skeleton import Column, ColumnKind, Skeleton, SkeletonKind

INCH_M = 0.0254
_ORDERS = ["".join(order) for order in permutations("xyz")]


def write_asf(skeleton: Skeleton) -> bytes:
    """Return the bytes of an ASF that opens as this skeleton; a comment in it states the length unit outright.

    Raises `FormatError` where the skeleton is not an ASF's.
    """
    check_acclaim(skeleton)
    frames = _frames(skeleton)
    unit = skeleton.metres_per_unit
    root = skeleton.joints[0]
    dofs = " ".join(_dof(column) for column in skeleton.columns if column.joint == 0)
    lines = [
        f"# {UNIT_COMMENT} {unit!r}",
        ":version 1.10",
        f":name {' '.join(skeleton.name.split())}",
        f":units\n  mass 1.0\n  length {INCH_M / unit:.12g}\n  angle deg",
        f":root\n  order {dofs}\n  axis {_order(skeleton, 0).upper()}",
        f"  position {_numbers(np.array(root.offset) / unit)}",
        f"  orientation {_numbers(_angles(frames[0], _order(skeleton, 0)))}",
        ":bonedata",
    ]
    for index in range(1, len(skeleton.joints)):
        lines += _bone_lines(skeleton, index, frames)
    lines += [":hierarchy", "  begin"]
    for index, joint in enumerate(skeleton.joints):
        children = [child.name for child in skeleton.joints if child.parent == index]
        if children:
            lines.append(f"    {joint.name} {' '.join(children)}")
    return ("\n".join([*lines, "  end"]) + "\n").encode()


def check_acclaim(skeleton: Skeleton) -> None:
    """Raise `FormatError` where ASF and AMC cannot hold what `skeleton` is, with the first reason."""
    if skeleton.kind is not SkeletonKind.ASF:
        raise FormatError(
            "Acclaim files hold motions of ASF skeletons only",
            got=f"a skeleton of kind {skeleton.kind.value}",
            hint="It would have to be retargeted first",
        )
    names = [joint.name for joint in skeleton.joints]
    for index, joint in enumerate(skeleton.joints):
        if (joint.name == "root") != (index == 0) or (joint.parent < 0) != (index == 0) or names.count(joint.name) > 1:
            raise FormatError(
                "Acclaim wants one root, called so, and bones of different names", at=f"joint {joint.name!r}"
            )
        if not joint.name.isprintable() or len(joint.name.split()) != 1 or "#" in joint.name or " " in joint.name:
            raise FormatError("the name cannot stand in an Acclaim file", at=f"joint {joint.name!r}", wanted="one word")
    runs = [joint for joint, _ in groupby(column.joint for column in skeleton.columns)]
    for column in skeleton.columns:
        turns, moves = column.kind is ColumnKind.ROTATION, column.kind is ColumnKind.TRANSLATION
        plain = column.sign == 1 and column.rest == 0 and runs.count(column.joint) == 1
        if not plain or not (turns or (moves and column.joint == 0)):
            raise FormatError("the column cannot stand in an Acclaim file", at=f"column {column.name!r}")


def check_readable(values: FloatArray) -> None:
    """Raise `FormatError` where `values`, in file units and degrees, are larger than readers of Acclaim files take."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest > LARGEST:
        wanted, got = f"at most {LARGEST:g}, in degrees and units of the file", f"{largest:g}"
        raise FormatError("a number is too large for an Acclaim file", wanted=wanted, got=got)


def _frames(skeleton: Skeleton) -> list[FloatArray]:
    """Return each joint's rest frame in the world (3, 3): the ASF's C."""
    frames: list[FloatArray] = []
    for joint in skeleton.joints:
        own = np.array(joint.orientation)
        frames.append(frames[joint.parent] @ own if joint.parent >= 0 else own)
    return frames


def _bone_lines(skeleton: Skeleton, index: int, frames: list[FloatArray]) -> list[str]:
    joint = skeleton.joints[index]
    order = _order(skeleton, index)
    vector = frames[index] @ _far_end(skeleton, index) / skeleton.metres_per_unit
    length = float(np.linalg.norm(vector))
    direction = vector / length if length > 0 else np.array([1.0, 0.0, 0.0])
    lines = [
        "  begin",
        f"    id {index}",
        f"    name {joint.name}",
        f"    direction {_numbers(direction)}",
        f"    length {_numbers(np.array([length]))}",
        f"    axis {_numbers(_angles(frames[index], order))} {order.upper()}",
    ]
    columns = [column for column in skeleton.columns if column.joint == index]
    if columns:
        lines.append(f"    dof {' '.join(_dof(column) for column in columns)}")
        lines += [f"    {'limits' if k == 0 else '      '} ({_limits(c)})" for k, c in enumerate(columns)]
    return [*lines, "  end"]


def _far_end(skeleton: Skeleton, index: int) -> FloatArray:
    """Return the one far end (3,) of a bone in its own frame, metres: where its children, or its end site, are."""
    ends = [j.offset for j in skeleton.joints if j.parent == index]
    ends += [s.offset for s in skeleton.end_sites if s.joint == index]
    if not ends or np.ptp(np.array(ends), axis=0).max() > 1e-9:
        raise FormatError("a bone has not one far end", at=f"joint {skeleton.joints[index].name}", got=str(len(ends)))
    return np.array(ends[0])


def _dof(column: Column) -> str:
    return ("t" if column.kind is ColumnKind.TRANSLATION else "r") + "xyz"[column.axis]


def _limits(column: Column) -> str:
    low, high = column.limits or (-math.inf, math.inf)
    check_readable(np.array([limit for limit in np.degrees([low, high]) if math.isfinite(limit)]))
    return f"{math.degrees(low):.12g} {math.degrees(high):.12g}"


def _order(skeleton: Skeleton, index: int) -> str:
    """Return the first order of axes, x y z if that will do, in which the joint's own rotations are applied."""
    applied = "".join("xyz"[skeleton.columns[k].axis] for k in reversed(skeleton.joints[index].product))
    return next(order for order in _ORDERS if "".join(letter for letter in order if letter in applied) == applied)


def _angles(matrix: FloatArray, order: str) -> FloatArray:
    """Return the angles (3,) in degrees about x, y, z that, applied in `order`, give `matrix`."""
    i, j, k = ("xyz".index(letter) for letter in order)  # matrix = R_k R_j R_i
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    angles = np.zeros(3)
    flat = math.hypot(matrix[i, i], matrix[j, i])
    angles[j] = math.atan2(-sign * matrix[k, i], flat)
    if flat > 1e-9:
        angles[i] = math.atan2(sign * matrix[k, j], matrix[k, k])
        angles[k] = math.atan2(sign * matrix[j, i], matrix[i, i])
    else:  # the first and the last axis coincide: let the first do all the turning
        angles[i] = math.atan2(-sign * matrix[j, k], matrix[j, j])
    return np.degrees(angles)


def _numbers(values: FloatArray) -> str:
    check_readable(values)
    return " ".join(f"{round(value, 12) + 0.0:.15g}" for value in values.tolist())
