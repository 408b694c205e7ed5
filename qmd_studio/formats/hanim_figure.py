"""The H-Anim figure in a scene: its tree of joints, its segments and sites, and how its space becomes metres.

A joint's centre is absolute in the humanoid's space, and at rest every joint's frame is parallel to it (ISO/IEC
19774-1). Joints inside HAnimPose, and those listed in `joints`, are not the tree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_view import View, applied, compose, kind_of, label, raw_numbers, stretch_matrix, vector
from qmd_studio.formats.hanim_view import transform_matrix as matrix_of
from qmd_studio.formats.scene_graph import Node
from qmd_studio.motion.skeleton import MAX_LEVEL

MAX_JOINTS = 2_000
MAX_SITES = 5_000
"""Figures of more joints or sites are refused; the standard has 146 joints and some hundred sites."""
UNITS = (("metre", 1.0), ("centimetre", 0.01), ("inch", 0.0254), ("unit of 0.0225 m", 0.0225), ("millimetre", 0.001))
_ORIGIN = (0.0, 0.0, 0.0)
_PLAUSIBLE_M = (0.3, 3.0)
_USUAL_M = 1.7
_ROBOT_FIELDS = frozenset({"jointId", "jointAxis", "jointType"})


@dataclass(slots=True)
class Figure:
    """A humanoid's joints, parents before children: nodes, parent numbers, names, centres (J, 3) in its own units.

    `space` (4, 4) takes the humanoid's space to metres. `segments` are (joint number, node); `sites` (joint number,
    name, position in own units). `stretch` (J, 4, 4) is what the joints' scales do to what they carry, where any has.
    `limits` are (3, 2) radians about x, y and z, where a joint has llimit and ulimit that can be kept.
    `frame` is the rotation (3, 3) of the humanoid's space, the nearest one where that is sheared.
    """

    humanoid: Node
    space: FloatArray = field(default_factory=lambda: np.eye(4))
    joints: list[Node] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    centres: list[FloatArray] = field(default_factory=list)
    limits: list[FloatArray | None] = field(default_factory=list)
    segments: list[tuple[int, Node]] = field(default_factory=list)
    sites: list[tuple[int, str, FloatArray]] = field(default_factory=list)
    stretch: FloatArray | None = None
    frame: FloatArray = field(default_factory=lambda: np.eye(3))

    def in_metres(self, points: FloatArray) -> FloatArray:
        """Return `points` (..., 3) of the humanoid's space in metres."""
        return applied(self.space, points)


def find_figure(view: View, metres_per_unit: float | None) -> Figure:
    """Return the first humanoid that has joints; raises `FormatError` where there is none."""
    humanoids = view.every("HAnimHumanoid")
    robots = False
    for humanoid in humanoids:
        figure = Figure(humanoid)
        _collect(view, figure)
        if any(_ROBOT_FIELDS & {name for name, _ in joint.fields} for joint in figure.joints):
            robots = True
            continue
        if figure.joints:
            if len(humanoids) > 1:
                view.warnings.append(f"the file has {len(humanoids)} humanoids; the first with joints is opened")
            _stretch(view, figure)
            _set_space(view, figure, metres_per_unit)
            _check_list(view, figure)
            return figure
    if robots:
        message, got = "the scene holds a robot, not an H-Anim figure", "joints with jointId or jointAxis (OpenHRP)"
    else:
        message, got = "the scene holds no figure", "a humanoid without joints" if humanoids else "no humanoid"
    raise FormatError(message, wanted="HAnimHumanoid with HAnimJoint in its skeleton", got=got)


def level_of(figure: Figure, joint: int, named: dict[str, int]) -> int:
    """Return the paper's level of a joint: that of its name, else its depth in the tree."""
    depth, parent = 1, figure.parents[joint]
    if parent < 0:
        return 1
    while parent >= 0:
        depth, parent = depth + 1, figure.parents[parent]
    return max(2, named.get(figure.names[joint], min(depth, MAX_LEVEL)))


def _collect(view: View, figure: Figure) -> None:
    seen: set[int] = set()
    top = [(place, child) for place, child in view.children(figure.humanoid) if place in _TREE]
    listed = [(place, child) for place, child in view.children(figure.humanoid) if place == "joints"]
    if not any(kind_of(child) == "HAnimJoint" for _, child in top) and listed:
        inner = {id(c) for _, joint in listed for _, c in view.children(joint)}
        top = [(place, child) for place, child in listed if id(child) not in inner]
        view.warn(figure.humanoid, "it has no skeleton; the tree is taken from its list of joints")
    waiting: list[tuple[int, Node]] = []
    for _, child in reversed(top):
        waiting.append((-1, child))
    while waiting:
        parent, node = waiting.pop()
        kind = kind_of(node)
        if kind in ("Group", "Transform", "StaticGroup") and parent < 0:
            if kind == "Transform" and not np.allclose(matrix_of(node), np.eye(4)):
                view.warn(node, "a Transform around the skeleton is not H-Anim; it is taken for none")
            waiting.extend((parent, child) for _, child in reversed(list(view.children(node))))
        if kind != "HAnimJoint":
            continue
        if id(node) in seen:
            view.warn(node, "it stands in the skeleton twice; the first counts")
            continue
        seen.add(id(node))
        number = _add_joint(view, figure, node, parent)
        waiting.extend((number, child) for place, child in reversed(list(view.children(node))) if place != "joints")


_TREE = ("skeleton", "humanoidBody", "children")


def _add_joint(view: View, figure: Figure, node: Node, parent: int) -> int:
    number = len(figure.joints)
    if number >= MAX_JOINTS:
        raise FormatError("the figure has too many joints", wanted=f"at most {MAX_JOINTS}")
    name = label(node) or f"joint {number}"
    if name in figure.names:
        view.warn(node, "another joint has this name; this one is numbered")
        name = f"{name} #{number}"
    figure.joints.append(node)
    figure.parents.append(parent)
    figure.names.append(name)
    figure.centres.append(vector(node, "center", _ORIGIN))
    figure.limits.append(_limits(view, node))
    for _, child in view.children(node):
        kind = kind_of(child)
        if kind == "HAnimSegment":
            figure.segments.append((number, child))
            for _, inner in view.children(child):
                if kind_of(inner) == "HAnimSite":
                    _add_site(figure, inner, number)
        elif kind == "HAnimSite":
            _add_site(figure, child, number)
    return number


def _limits(view: View, node: Node) -> FloatArray | None:
    """Return llimit and ulimit as (3, 2) radians, None where there are none or they do not fit the joint's axes."""
    if node.get("llimit") is None and node.get("ulimit") is None:
        return None
    low, high = raw_numbers(node, "llimit"), raw_numbers(node, "ulimit")
    if not low.any() and not high.any():  # none, or the zeros that some programs write for none
        return None
    turned = vector(node, "limitOrientation", (0.0, 0.0, 1.0, 0.0))[3] != 0
    if turned or len(low) != 3 or len(high) != 3 or not (low <= high).all() or not np.isfinite([low, high]).all():
        reason = "it has a limitOrientation" if turned else "three numbers each are wanted, none above its partner"
        view.warn(node, f"its llimit and ulimit are left out: {reason}")
        return None
    return np.stack([low, high], axis=1)


def _add_site(figure: Figure, site: Node, joint: int) -> None:
    if len(figure.sites) >= MAX_SITES:
        raise FormatError("the figure has too many sites", wanted=f"at most {MAX_SITES}")
    name = label(site) or f"site {len(figure.sites)}"
    figure.sites.append((joint, name, applied(matrix_of(site), vector(site, "center", _ORIGIN))))


def _stretch(view: View, figure: Figure) -> None:
    """Take the joints' scales into the rest figure.

    That is exact at rest, and turned too for what follows one joint that is scaled the same along all axes.
    """
    linear = [stretch_matrix(node) for node in figure.joints]
    if all(np.array_equal(matrix, np.eye(3)) for matrix in linear):
        return
    chain = np.tile(np.eye(4), (len(linear), 1, 1))
    for j, parent in enumerate(figure.parents):
        own = compose(np.zeros(3), linear[j], figure.centres[j])
        outer = chain[parent] if parent >= 0 else np.eye(4)
        chain[j] = outer @ own
        if not np.allclose(linear[j], linear[j][0, 0] * np.eye(3), rtol=1e-6):
            view.warn(figure.joints[j], "its scale differs along the axes; it is shown right at rest, nearly so turned")
    view.warn(
        figure.humanoid, "joints are scaled; skin that several of them share is shown right at rest, nearly so turned"
    )
    centres = figure.centres
    figure.centres = [
        applied(chain[p] if p >= 0 else np.eye(4), c) for p, c in zip(figure.parents, centres, strict=True)
    ]
    figure.sites = [(joint, name, applied(chain[joint], place)) for joint, name, place in figure.sites]
    figure.stretch = chain


def _set_space(view: View, figure: Figure, metres_per_unit: float | None) -> None:
    own = matrix_of(figure.humanoid)
    linear = own[:3, :3]
    size = abs(float(np.linalg.det(linear))) ** (1 / 3)
    if not size > 1e-12:
        view.warn(figure.humanoid, "its scale leaves nothing to see; it is taken as 1")
        own = np.eye(4)
    elif not np.allclose(linear @ linear.T, size**2 * np.eye(3), atol=1e-6 * size**2):
        view.warn(figure.humanoid, "its scale differs along the axes; turned limbs will look a little different")
    declared = [
        float(factor) for category, _, factor in view.scene.units if category == "length" and _is_number(factor)
    ]
    unit = metres_per_unit or (declared[0] if declared and declared[0] > 0 else None)
    points = applied(own, np.array([*figure.centres, *(place for _, _, place in figure.sites)]))
    height = float(np.ptp(points, axis=0).max())
    if unit is None:
        unit = 1.0
        if len(points) > 2 and height > 0 and not _PLAUSIBLE_M[0] <= height <= _PLAUSIBLE_M[1]:
            name, unit = min(UNITS, key=lambda named: abs(math.log(height * named[1] / _USUAL_M)))
            view.notes.append(
                f"length unit guessed from the stature: {name} (the figure is {height * unit:.2f} m tall); "
                "set the length unit if that is not meant"
            )
    figure.space = np.diag([unit, unit, unit, 1.0]) @ own
    u, _, v = np.linalg.svd(figure.space[:3, :3])
    if not np.allclose(u @ v, np.eye(3), atol=1e-12):
        figure.frame = u @ v


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _check_list(view: View, figure: Figure) -> None:
    """Say what the list of joints leaves out, or holds beside the skeleton: other players skin by it."""
    listed = {id(child) for place, child in view.children(figure.humanoid) if place == "joints"}
    own = {id(node) for node in figure.joints}
    if not listed:
        view.warn(figure.humanoid, "it lists no joints; the list is taken from its skeleton")
    elif own - listed:
        view.warn(figure.humanoid, f"its list leaves out {len(own - listed)} joints; all of the skeleton are used")
    if listed - own:
        view.warn(figure.humanoid, f"its list has {len(listed - own)} joints outside the skeleton; they are left out")
