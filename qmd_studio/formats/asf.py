"""Acclaim skeletons (ASF): from parsed bones to the studio's joints, and the format that opens one alone.

A bone turns about its near end by G = G_parent C M C⁻¹, where C comes from its `axis` and M from its degrees of freedom
(Rz Ry Rx for the order XYZ). In the studio's model a bone is the joint at its near end, whose frame is G C.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from itertools import count

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf_parse import Asf, Bone, parse_asf
from qmd_studio.formats.asf_write import INCH_M, check_acclaim, write_asf
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import (
    MAX_LEVEL,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Matrix3,
    Skeleton,
    SkeletonKind,
    Vector3,
    depths,
)

REST_FPS = 120.0
"""The frame rate of a skeleton's one frame at rest."""

_Columns = dict[str, list[tuple[int, Column]]]
_PLAUSIBLE_STATURE_M = (0.9, 2.6)
_HEAD = re.compile(rb"\s*:(version|name|units|documentation|root|bonedata|hierarchy)\b", re.IGNORECASE)


def skeleton_of(
    asf: Asf, column_bones: Sequence[str] | None = None, *, metres_per_unit: float | None = None
) -> tuple[Skeleton, tuple[str, ...]]:
    """Return the skeleton, its columns in the order of `column_bones` (default: the file's), and notes for the user.

    The measured points are the root and the far end of every bone: the joint of its first child, or its end site.
    """
    unit, notes = _length_unit(asf, metres_per_unit)
    number = {name: index for index, name in enumerate(asf.bones)}
    parents = [number[asf.parents[name]] if name in asf.parents else -1 for name in asf.bones]
    columns = _columns(asf, column_bones or asf.listed, depths(tuple(parents)), unit)
    first_child = {asf.parents[name]: number[name] for name in reversed(asf.bones) if name in asf.parents}
    leaves = [name for name in asf.bones if name not in first_child and name != "root"]
    far_end = {"root": 0, **{name: len(number) + index for index, name in enumerate(leaves)}}
    skeleton = Skeleton(
        name=asf.name,
        kind=SkeletonKind.ASF,
        joints=tuple(_joint(asf, name, parents[number[name]], columns, unit) for name in asf.bones),
        end_sites=tuple(EndSite(f"{name} end", number[name], _far_end(asf.bones[name], unit)) for name in leaves),
        columns=tuple(column for group in columns.values() for _, column in group),
        points=tuple(far_end[name] if name in far_end else first_child[name] for name in asf.bones),
        metres_per_unit=unit,
    )
    return skeleton, notes


def _joint(asf: Asf, name: str, parent: int, columns: _Columns, unit: float) -> Joint:
    """Return the joint at the near end of a bone, which turns in the bone's own frame."""
    bone = asf.bones[name]
    turns = {"xyz"[c.axis]: index for index, c in columns.get(name, []) if c.kind is ColumnKind.ROTATION}
    product = tuple(turns[letter] for letter in reversed(bone.order) if letter in turns)
    if parent < 0:
        return Joint(name, parent, _vector(bone.vector * unit), product, _matrix(bone.frame))
    inner = asf.bones[asf.parents[name]]
    # the root has no length: its bones start where it stands
    offset = (0.0, 0.0, 0.0) if inner.name == "root" else _far_end(inner, unit)
    return Joint(name, parent, offset, product, _matrix(inner.frame.T @ bone.frame))


def _far_end(bone: Bone, unit: float) -> Vector3:
    return _vector(bone.frame.T @ bone.vector * unit)


def _columns(asf: Asf, column_bones: Sequence[str], depth: tuple[int, ...], unit: float) -> _Columns:
    """Return each bone's columns with their places in the motion matrix."""
    number = {name: index for index, name in enumerate(asf.bones)}
    places = count()
    columns: _Columns = {}
    for name in column_bones:
        bone = asf.bones[name]
        for dof, limits in zip(bone.dofs, bone.limits, strict=True):
            moves = dof[0] == "t"
            column = Column(
                name=f"{name} {dof}",
                joint=number[name],
                kind=ColumnKind.TRANSLATION if moves else ColumnKind.ROTATION,
                axis="xyz".index(dof[1]),
                level=min(depth[number[name]], MAX_LEVEL),
                limits=(limits[0] * unit, limits[1] * unit) if moves and limits else limits,
            )
            columns.setdefault(name, []).append((next(places), column))
    return columns


def _length_unit(asf: Asf, given: float | None) -> tuple[float, tuple[str, ...]]:
    """Return metres per file unit: given, stated in the file, by the ASF rule, or the usual unit that fits a person."""
    if given is not None and not 1e-6 <= given <= 1e6:
        raise FormatError("the length unit cannot be used", wanted="metres per unit of the file", got=f"{given:g}")
    for stated in (given, asf.metres_per_unit):
        if stated is not None:
            return stated, ()
    by_rule = ASF_UNIT_M if math.isclose(asf.unit_length, 0.45) else INCH_M / asf.unit_length
    stature = _stature(asf)
    low, high = _PLAUSIBLE_STATURE_M
    if low <= stature * by_rule <= high:
        return by_rule, ()
    for unit, name in ((1.0, "metre"), (0.01, "centimetre"), (INCH_M, "inch"), (0.001, "millimetre")):
        if low <= stature * unit <= high:
            note = (
                f"Length unit taken as the {name}: the figure is then {stature * unit:.2f} m across, "
                f"where `length {asf.unit_length:g}` would make it {stature * by_rule:.3g} m"
            )
            return unit, (note,)
    return by_rule, (f"By its length unit the figure is {stature * by_rule:.3g} m across, unlike a person",)


def _stature(asf: Asf) -> float:
    """Return the largest extent of the rest pose in file units: height, or arm span, which is about the same."""
    far: dict[str, FloatArray] = {}
    for name, bone in asf.bones.items():
        far[name] = far[asf.parents[name]] + bone.vector if name in asf.parents else np.zeros(3)
    return float(np.ptp(np.array(list(far.values())), axis=0).max())


def _vector(values: FloatArray) -> Vector3:
    x, y, z = (float(value) for value in values)
    return (x, y, z)


def _matrix(values: FloatArray) -> Matrix3:
    return (_vector(values[0]), _vector(values[1]), _vector(values[2]))


def read_asf(data: bytes, options: ReadOptions) -> Loaded:
    """Read an ASF alone: its skeleton, and one frame of it at rest."""
    skeleton, notes = skeleton_of(parse_asf(data), metres_per_unit=options.metres_per_unit)
    rest: FloatArray = np.zeros((1, skeleton.n_columns))
    fps = REST_FPS if options.fps is None else options.fps
    motion = Motion(skeleton, rest, fps, name=options.path.stem if options.path else "")
    return Loaded(skeleton, motion, notes=(*notes, "A skeleton alone, shown at rest"))


def _sniff(head: bytes) -> bool:
    return _HEAD.match(re.sub(rb"#[^\r\n]*", b"", head.removeprefix(b"\xef\xbb\xbf"))) is not None


def _write(motion: Motion) -> bytes:
    """Return the ASF of a motion that is a skeleton at rest; any other would lose what it is about."""
    if motion.X.any():
        check_acclaim(motion.skeleton)
        raise FormatError(
            "an .asf file holds a skeleton only, not its motion",
            wanted="a skeleton at rest",
            got=f"{motion.n_frames} frames",
            hint="Write an .amc: its .asf comes with it",
        )
    return write_asf(motion.skeleton)


FORMAT = Format("asf", "Acclaim skeleton", (".asf",), _sniff, read_asf, _write)
