"""The trunk of a body made from bones: pelvis, waist, ribcage and neck, and a head that shows where it looks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_loft import Axis, Profile, loft
from qmd_studio.avatar.bone_body_paint import ACCENT, EYE, SKIN
from qmd_studio.avatar.bone_body_plan import BodyPlan
from qmd_studio.avatar.bone_body_shapes import Shape, ShapeList, along_joints, ellipsoid, outward
from qmd_studio.motion.joint_names import Limb

_HIP_HALF_M, _SHOULDER_HALF_M = 0.096, 0.203
_PELVIS: Profile = (
    (-0.205, 0.026, 0.040, 0.002),
    (-0.150, 0.082, 0.078, -0.006),
    (-0.080, 0.134, 0.102, -0.012),
    (0.000, 0.160, 0.114, -0.014),
    (0.090, 0.160, 0.108, -0.010),
    (0.180, 0.151, 0.098, -0.004),
    (0.225, 0.146, 0.093, -0.001),
)
_WAIST: Profile = (
    (0.05, 0.142, 0.088, -0.006),
    (0.20, 0.137, 0.086, -0.002),
    (0.36, 0.123, 0.081, 0.002),
    (0.50, 0.127, 0.085, 0.004),
    (0.70, 0.138, 0.094, 0.006),
)
_RIBS: Profile = (
    (0.415, 0.128, 0.087, 0.004),
    (0.50, 0.137, 0.094, 0.005),
    (0.65, 0.150, 0.107, 0.008),
    (0.80, 0.163, 0.116, 0.012),
    (0.90, 0.166, 0.110, 0.007),
    (0.97, 0.158, 0.096, 0.000),
    (1.03, 0.134, 0.080, -0.006),
    (1.08, 0.096, 0.067, -0.008),
    (1.125, 0.060, 0.052, -0.006),
)
_NECK: Profile = (
    (-0.05, 0.060, 0.058, 0.0),
    (0.30, 0.051, 0.052, 0.0),
    (0.65, 0.048, 0.050, 0.0),
    (1.15, 0.050, 0.054, 0.0),
)
_HEAD_TOP_M, _HEAD_HALF_M = 0.125, np.array([0.113, 0.077, 0.093])


@dataclass(frozen=True, slots=True, eq=False)
class Trunk:
    """Where the trunk is: its axis from between the hips to between the shoulders, and widths over the usual."""

    axis: Axis
    hips: float
    shoulders: float


def trunk_of(plan: BodyPlan) -> Trunk:
    """Return where the trunk of a figure is, as far as it has hips and shoulders."""
    root = plan.nodes[plan.pelvis]
    top = plan.nodes[plan.head] if plan.head is not None else plan.nodes[plan.spine[-1]] if plan.spine else root
    low = np.mean([plan.nodes[leg.upper[0]] for leg in plan.legs], axis=0) if len(plan.legs) == 2 else root
    if len(plan.arms) == 2:
        high = np.mean([plan.nodes[arm.upper[0]] for arm in plan.arms], axis=0)
    else:
        high = low + 0.74 * (top - low)
    if np.linalg.norm(high - low) < 0.12 * plan.unit:
        high = low + 0.5 * plan.unit * plan.up
    widths = []
    for limbs, usual in ((plan.legs, _HIP_HALF_M), (plan.arms, _SHOULDER_HALF_M)):
        apart = _apart(plan, limbs) / 2 if len(limbs) == 2 else usual * plan.unit
        widths.append(float(np.clip(apart / (usual * plan.unit), 0.72, 1.3)))
    return Trunk(Axis(low, high, plan.forward), widths[0], widths[1])


def add_trunk(shapes: ShapeList, plan: BodyPlan) -> Trunk:
    """Add pelvis, waist and ribcage, carried by the joints of the spine; return where they are."""
    trunk = trunk_of(plan)
    for profile, colour, rings in ((_WAIST, ACCENT, 8), (_PELVIS, SKIN, 10), (_RIBS, SKIN, 15)):
        rim = 0.030 if profile is _PELVIS else 0.016
        sized = _sized(profile, trunk, plan.unit)
        shape = loft(trunk.axis, sized, rim=rim * plan.unit, rings=rings, around=32, square=2.35)
        if profile is _PELVIS:
            shapes.add(shape, colour, plan.pelvis)
        else:
            shapes.add(shape, colour, _spine_weights(plan, trunk, shape))
    return trunk


def add_neck_and_head(shapes: ShapeList, plan: BodyPlan, trunk: Trunk) -> None:
    """Add the neck and a head with nose, eyes and ears, looking to the front."""
    if plan.head is None:
        return
    joint = plan.nodes[plan.head]
    base = _spine_point(plan, trunk, 1.02)
    if float((joint - base) @ plan.up) > 0.02 * plan.unit:
        axis = Axis(base, joint, plan.forward)
        shape = loft(axis, _NECK, rim=0.02 * plan.unit, rings=8, around=20, scale=plan.unit)
        joints = [*plan.spine, plan.head]
        starts = np.maximum.accumulate(axis.place_of(plan.nodes[joints]))
        shapes.add(shape, ACCENT, along_joints(axis.place_of(shape.vertices), joints, starts, 0.3))
    _add_head(shapes, plan, float((joint - trunk.axis.end) @ plan.up))


def _add_head(shapes: ShapeList, plan: BodyPlan, neck: float) -> None:
    """Add the head; `neck` is how high its joint is over the shoulders."""
    assert plan.head is not None
    unit, frame = plan.unit, np.stack([plan.up, plan.left, plan.forward])
    joint = plan.nodes[plan.head]
    tips = [float((plan.nodes[n] - joint) @ plan.up) for n in plan.below(plan.head)]
    lift = float(np.clip(0.165 * unit - neck, 0.0, 0.035 * unit))  # a short neck must not swallow the chin
    top = float(np.clip(max(tips, default=_HEAD_TOP_M * unit), 0.118 * unit + lift, 0.20 * unit))
    half = _HEAD_HALF_M * unit
    centre = joint + (top - half[0]) * plan.up + 0.006 * unit * plan.forward
    ball = ellipsoid(np.zeros(3), np.eye(3), (20, 30))
    shapes.add(outward(Shape(centre + (_skull(ball.vertices) * half) @ frame, ball.faces)), SKIN, plan.head)
    for place, axes, colour in (
        ((-0.13, 0.0, 0.905), ((0.027, 0.0, 0.009), (0.0, 0.0120, 0.0), (-0.006, 0.0, 0.0185)), SKIN),
        ((0.06, 0.40, 0.845), ((0.0085, 0.0, 0.0), (0.0, 0.0125, -0.0035), (0.0, 0.002, 0.0075)), EYE),
        ((0.06, -0.40, 0.845), ((0.0085, 0.0, 0.0), (0.0, 0.0125, 0.0035), (0.0, -0.002, 0.0075)), EYE),
        ((0.00, 0.985, -0.06), ((0.027, 0.0, -0.006), (0.0, 0.008, -0.005), (0.004, 0.0, 0.015)), SKIN),
        ((0.00, -0.985, -0.06), ((0.027, 0.0, -0.006), (0.0, -0.008, -0.005), (0.004, 0.0, 0.015)), SKIN),
    ):
        middle = centre + (np.array(place) * half) @ frame
        shapes.add(ellipsoid(middle, np.array(axes) * unit @ frame, (8, 12)), colour, plan.head)


def _skull(ball: FloatArray) -> FloatArray:
    """Shape a unit ball (up, left, front) to a head: narrow jaw and chin, flat face, round back."""
    up, left, front = ball.T
    low = np.clip(-up, 0.0, 1.0)
    narrow = 1.0 - 0.20 * low**1.5
    face = np.clip(front, 0.0, 1.0)
    nape = np.clip(-front, 0.0, 1.0)
    deep = front * (1.0 - 0.08 * face**2) + 0.26 * low**2 * (1.0 - 0.2 * face) + 0.30 * nape * low
    flat = left * narrow * (1.0 - 0.10 * face**2)
    return np.stack([up + 0.05 * low * face, flat, deep - 0.03 * np.clip(up, 0, 1)], axis=1)


def _sized(profile: Profile, trunk: Trunk, unit: float) -> Profile:
    """The profile in metres of this figure: as wide as its hips below, as its shoulders above."""
    rows = []
    for place, width, depth, shift in profile:
        t = float(np.clip((place - 0.2) / 0.5, 0.0, 1.0))
        wide = (trunk.hips + (trunk.shoulders - trunk.hips) * t * t * (3 - 2 * t)) * unit
        rows.append((place, width * wide, depth * unit * (0.4 + 0.6 * wide / unit), shift * unit))
    return rows


def _spine_weights(plan: BodyPlan, trunk: Trunk, shape: Shape) -> tuple[np.ndarray, FloatArray]:
    joints, starts = _spine_starts(plan, trunk)
    return along_joints(trunk.axis.place_of(shape.vertices), joints, starts, 0.09)


def _spine_starts(plan: BodyPlan, trunk: Trunk) -> tuple[list[int], FloatArray]:
    """The joints from the pelvis to the top of the chest and where along the trunk each begins to carry it."""
    joints = [plan.pelvis] + [j for j in plan.spine if j != plan.pelvis]
    places = trunk.axis.place_of(plan.nodes[joints])
    if len(joints) > 1:
        places[1] = max(places[1], 0.24)
    if len(joints) > 2 and plan.parents[joints[1]] < 0:  # a root beside the pelvis carries the loins
        places[1] = 0.20
    if len(joints) > 1:
        places[1:] = np.maximum(places[1:], 0.20 + 1e-3 * np.arange(len(joints) - 1))
    places[0] = -10.0
    return joints, np.maximum.accumulate(places)


def _spine_point(plan: BodyPlan, trunk: Trunk, place: float) -> FloatArray:
    """Where the line of the spine passes a height of the trunk."""
    joints = [*plan.spine, *([plan.head] if plan.head is not None else [])]
    places = np.maximum.accumulate(trunk.axis.place_of(plan.nodes[joints]))
    point = np.array([np.interp(place, places, plan.nodes[joints][:, k]) for k in range(3)])
    middle = trunk.axis.start + place * (trunk.axis.end - trunk.axis.start)
    return np.asarray(0.6 * point + 0.4 * middle)


def _apart(plan: BodyPlan, limbs: tuple[Limb, ...]) -> float:
    a, b = (plan.nodes[limb.upper[0]] for limb in limbs)
    return float(np.linalg.norm(a - b))
