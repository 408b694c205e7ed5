"""The H-Anim figure in an X3D scene: its tree of joints as a skeleton, and the pose that the file stands in.

HAnim (ISO/IEC 19774-1): a joint's centre is absolute in the humanoid's space, and at rest every joint's frame is
parallel to it. Joints inside HAnimPose, and those listed in `joints`, are not the tree.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from xml.etree.ElementTree import Element

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.x3d_scene import Scene, axis_angle_matrix, transform_matrix, vector
from qmd_studio.motion.as_euler import euler_zyx
from qmd_studio.motion.hanim import table_rows
from qmd_studio.motion.skeleton import (
    MAX_LEVEL,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Skeleton,
    SkeletonKind,
    Vector3,
    depths,
)

_NO_TURN = (0.0, 0.0, 1.0, 0.0)
_ORIGIN = (0.0, 0.0, 0.0)


@dataclass(slots=True)
class Figure:
    """A humanoid's joints, parents before children: elements, parent numbers, names, centres in metres.

    `space` (4, 4) takes the humanoid's space to metres. `segments` are (joint number, HAnimSegment), `tips` end sites.
    """

    humanoid: Element
    space: FloatArray
    elements: list[Element] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    centres: list[FloatArray] = field(default_factory=list)
    segments: list[tuple[int, Element]] = field(default_factory=list)
    tips: list[tuple[int, str, FloatArray]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def find_figure(scene: Scene, metres_per_unit: float | None) -> Figure:
    """Return the first humanoid that has joints; raises `FormatError` where there is none."""
    humanoids = list(scene.root.iter("HAnimHumanoid"))
    for humanoid in humanoids:
        if humanoid.get("USE") is not None:
            continue
        figure = Figure(humanoid, np.diag([*[metres_per_unit or 1.0] * 3, 1.0]) @ transform_matrix(humanoid))
        _collect(scene, figure)
        if figure.elements:
            if len(humanoids) > 1:
                figure.warnings.append(f"the file has {len(humanoids)} humanoids; the first with joints is opened")
            return figure
    got = "a humanoid without joints" if humanoids else "no humanoid"
    raise FormatError("the scene holds no figure", wanted="HAnimHumanoid with HAnimJoint in its skeleton", got=got)


def skeleton_of(figure: Figure) -> Skeleton:
    """Return the figure's skeleton: x, y and z turns in each joint, and the root's moves first of all.

    Columns are ordered by the paper's levels as the body animation parameters are; a joint of another name takes its
    depth in the tree as its level.
    """
    depth = depths(tuple(figure.parents))
    levels = [_levels_by_name().get(name, min(depth[i], MAX_LEVEL)) for i, name in enumerate(figure.names)]
    levels = [1 if figure.parents[i] < 0 else max(level, 2) for i, level in enumerate(levels)]
    columns: list[Column] = []
    products: list[tuple[int, ...]] = [()] * len(levels)
    offsets = [_offset(figure, index) for index in range(len(levels))]
    for index in sorted(range(len(levels)), key=lambda joint: levels[joint]):
        name, level = figure.names[index], levels[index]
        if figure.parents[index] < 0:
            columns += [
                Column(f"{name} t{'xyz'[axis]}", index, ColumnKind.TRANSLATION, axis, rest=offsets[index][axis])
                for axis in range(3)
            ]
        first = len(columns)
        columns += [
            Column(f"{name} r{'xyz'[axis]}", index, ColumnKind.ROTATION, axis, level=level) for axis in range(3)
        ]
        products[index] = (first + 2, first + 1, first)
    sites = tuple(EndSite(name, joint, _vector(tip - figure.centres[joint])) for joint, name, tip in figure.tips)
    return Skeleton(
        name=figure.humanoid.get("name") or figure.humanoid.get("DEF") or "humanoid",
        kind=SkeletonKind.HANIM,
        joints=tuple(Joint(name, figure.parents[i], offsets[i], products[i]) for i, name in enumerate(figure.names)),
        end_sites=sites,
        columns=tuple(columns),
        points=tuple(range(len(figure.names) + len(sites))),
    )


def pose_of(figure: Figure, skeleton: Skeleton) -> FloatArray:
    """Return the pose (1, n_columns) that the joints' rotations and the root's translation put the figure in."""
    X = np.zeros((1, skeleton.n_columns))
    for index, element in enumerate(figure.elements):
        turn = axis_angle_matrix(vector(element, "rotation", _NO_TURN))
        X[0, list(skeleton.joints[index].product)] = euler_zyx(turn[None])[0]
    for number, column in enumerate(skeleton.columns):
        if column.kind is ColumnKind.TRANSLATION:
            moved = figure.space[:3, :3] @ vector(figure.elements[column.joint], "translation", _ORIGIN)
            X[0, number] = column.rest + moved[column.axis]
    return X


def _collect(scene: Scene, figure: Figure) -> None:
    seen: set[int] = set()
    waiting: list[tuple[int, Element, str | None]]
    waiting = [(-1, child, place) for child, place in scene.children(figure.humanoid)][::-1]
    while waiting:
        parent, element, place = waiting.pop()
        if element.tag != "HAnimJoint" or place == "joints":
            continue
        if id(element) in seen:
            figure.warnings.append(f"the joint {element.get('name')!r} stands in the skeleton twice; the first counts")
            continue
        seen.add(id(element))
        number = _add_joint(scene, figure, element, parent)
        waiting.extend((number, child, "children") for child, _ in reversed(list(scene.children(element))))


def _add_joint(scene: Scene, figure: Figure, element: Element, parent: int) -> int:
    number = len(figure.elements)
    name = element.get("name") or element.get("DEF") or f"joint {number}"
    figure.elements.append(element)
    figure.parents.append(parent)
    figure.names.append(name)
    figure.centres.append(_in_space(figure, vector(element, "center", _ORIGIN)))
    for child, _ in scene.children(element):
        if child.tag == "HAnimSegment":
            figure.segments.append((number, child))
            _collect_tips(scene, figure, child, number)
    if parent >= 0 and vector(element, "translation", _ORIGIN).any():
        figure.warnings.append(f"the joint {name!r} is moved from its place, which is not shown")
    return number


def _collect_tips(scene: Scene, figure: Figure, segment: Element, joint: int) -> None:
    for child, _ in scene.children(segment):
        name = child.get("name") or ""
        if child.tag == "HAnimSite" and name.endswith("_tip"):
            figure.tips.append((joint, name, _in_space(figure, vector(child, "translation", _ORIGIN))))


def _in_space(figure: Figure, position: FloatArray) -> FloatArray:
    return np.asarray(figure.space[:3, :3] @ position + figure.space[:3, 3])


def _offset(figure: Figure, joint: int) -> Vector3:
    parent = figure.parents[joint]
    return _vector(figure.centres[joint] - (figure.centres[parent] if parent >= 0 else 0.0))


def _vector(values: FloatArray) -> Vector3:
    return (float(values[0]), float(values[1]), float(values[2]))


@lru_cache(maxsize=1)
def _levels_by_name() -> dict[str, int]:
    return {row["joint"]: int(row["level"]) for row in table_rows("bap_levels.csv")}
