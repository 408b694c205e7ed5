"""Acclaim skeletons (ASF): from parsed bones to the studio's joints, and the format that opens one alone.

A bone turns about its near end by G = G_parent C M C⁻¹, where C comes from its `axis` and M from its degrees of freedom
(Rz Ry Rx for the order XYZ). In the studio's model a bone is the joint at its near end, whose frame is G C.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf_parse import Asf, Bone, parse_asf
from qmd_studio.formats.asf_write import INCH_M, write_asf
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
    parents = tuple(number[asf.parents[name]] if name in asf.parents else -1 for name in asf.bones)
    columns = _columns(asf, column_bones or asf.listed, dict(zip(asf.bones, depths(parents), strict=True)), unit)
    by_joint: dict[int, dict[int, int]] = {}
    for index, column in enumerate(columns):
        if column.kind is ColumnKind.ROTATION:
            by_joint.setdefault(column.joint, {})[column.axis] = index
    joints: list[Joint] = []
    sites: list[EndSite] = []
    far_node = {"root": 0}
    for name, bone in asf.bones.items():
        parent = asf.bones[asf.parents[name]] if name in asf.parents else None
        if parent is not None:
            far_node.setdefault(parent.name, number[name])
        turns = by_joint.get(number[name], {})
        joints.append(
            Joint(
                name=name,
                parent=parents[number[name]],
                offset=_near_end(bone, parent, unit),
                product=tuple(
                    turns["xyz".index(letter)] for letter in reversed(bone.order) if "xyz".index(letter) in turns
                ),
                orientation=_matrix(bone.frame if parent is None else parent.frame.T @ bone.frame),
            )
        )
    for name, bone in asf.bones.items():
        if name not in far_node:
            far_node[name] = len(joints) + len(sites)
            sites.append(EndSite(f"{name} end", number[name], _vector(bone.frame.T @ bone.vector * unit)))
    skeleton = Skeleton(
        name=asf.name,
        kind=SkeletonKind.ASF,
        joints=tuple(joints),
        end_sites=tuple(sites),
        columns=tuple(columns),
        points=tuple(far_node[name] for name in asf.bones),
        metres_per_unit=unit,
    )
    return skeleton, notes


def _near_end(bone: Bone, parent: Bone | None, unit: float) -> Vector3:
    if parent is None:
        return _vector(bone.vector * unit)
    if parent.name == "root":
        return (0.0, 0.0, 0.0)  # the root has no length: its bones start where it stands
    return _vector(parent.frame.T @ parent.vector * unit)


def _columns(asf: Asf, column_bones: Sequence[str], depth: dict[str, int], unit: float) -> list[Column]:
    number = {name: index for index, name in enumerate(asf.bones)}
    columns = []
    for name in column_bones:
        bone = asf.bones[name]
        for dof, limits in zip(bone.dofs, bone.limits, strict=True):
            moves = dof[0] == "t"
            columns.append(
                Column(
                    name=f"{name} {dof}",
                    joint=number[name],
                    kind=ColumnKind.TRANSLATION if moves else ColumnKind.ROTATION,
                    axis="xyz".index(dof[1]),
                    level=min(depth[name], MAX_LEVEL),
                    limits=(limits[0] * unit, limits[1] * unit) if moves and limits else limits,
                )
            )
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
    return write_asf(motion.skeleton)


FORMAT = Format("asf", "Acclaim skeleton", (".asf",), _sniff, read_asf, _write)
