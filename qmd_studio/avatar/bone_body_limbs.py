"""Arms, legs and feet of a body made from bones: tapered like muscle, with a ball at each joint."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_loft import Axis, Profile, loft, smooth_table, superellipse
from qmd_studio.avatar.bone_body_paint import ACCENT, SKIN
from qmd_studio.avatar.bone_body_plan import BodyPlan
from qmd_studio.avatar.bone_body_shapes import ShapeList, along_joints, capsule, ellipsoid, tube
from qmd_studio.motion.joint_names import Limb

_THIGH: Profile = (
    (-0.13, 0.066, 0.070, 0.000),
    (-0.02, 0.078, 0.084, 0.000),
    (0.14, 0.084, 0.090, 0.002),
    (0.32, 0.081, 0.088, 0.005),
    (0.60, 0.067, 0.073, 0.005),
    (0.84, 0.054, 0.057, 0.002),
    (0.955, 0.050, 0.053, 0.001),
)
_SHANK: Profile = (
    (0.035, 0.048, 0.051, 0.000),
    (0.14, 0.051, 0.056, -0.006),
    (0.30, 0.054, 0.061, -0.013),
    (0.50, 0.046, 0.052, -0.010),
    (0.75, 0.035, 0.039, -0.004),
    (0.945, 0.032, 0.035, 0.000),
)
_UPPER_ARM: Profile = (
    (-0.155, 0.040, 0.042, 0.000),
    (-0.03, 0.0555, 0.0565, 0.000),
    (0.15, 0.0535, 0.056, 0.000),
    (0.45, 0.046, 0.050, 0.003),
    (0.75, 0.040, 0.042, 0.001),
    (0.945, 0.037, 0.038, 0.000),
)
_FOREARM: Profile = (
    (0.045, 0.037, 0.038, 0.000),
    (0.18, 0.042, 0.044, 0.000),
    (0.38, 0.040, 0.042, 0.000),
    (0.70, 0.030, 0.033, 0.000),
    (0.955, 0.0235, 0.029, 0.000),
)
_USUAL_M = {"thigh": 0.4257, "shank": 0.422, "upper arm": 0.303, "forearm": 0.270}
_HIP_BALL, _KNEE_BALL, _ANKLE_BALL = 0.060, 0.0475, 0.035
_SHOULDER_BALL, _ELBOW_BALL, _WRIST_BALL = 0.0435, 0.0365, 0.0262
_SOLE: Profile = (  # along the foot from the ankle, metres: half width, height over the sole, shift inwards
    (-0.056, 0.022, 0.034, 0.0),
    (-0.044, 0.032, 0.056, 0.0),
    (-0.010, 0.034, 0.080, 0.0),
    (0.025, 0.034, 0.084, 0.001),
    (0.065, 0.038, 0.064, 0.003),
    (0.110, 0.045, 0.045, 0.004),
    (0.150, 0.046, 0.034, 0.003),
    (0.180, 0.039, 0.028, 0.002),
    (0.200, 0.026, 0.022, 0.001),
)
ANKLE_HEIGHT_M = 0.0656


def add_arm(shapes: ShapeList, plan: BodyPlan, arm: Limb) -> None:
    """Add an arm to the wrist: collar, shoulder, upper arm, elbow, forearm."""
    _add_girdle(shapes, plan, arm, radius=0.046)
    _add_parts(shapes, plan, arm, (("upper arm", _UPPER_ARM), ("forearm", _FOREARM)))
    _add_balls(shapes, plan, arm, (_SHOULDER_BALL, _ELBOW_BALL, _WRIST_BALL))


def add_leg(shapes: ShapeList, plan: BodyPlan, leg: Limb) -> None:
    """Add a leg with its foot."""
    _add_girdle(shapes, plan, leg, radius=0.042)
    _add_parts(shapes, plan, leg, (("thigh", _THIGH), ("shank", _SHANK)))
    _add_balls(shapes, plan, leg, (_HIP_BALL, _KNEE_BALL, _ANKLE_BALL))
    _add_foot(shapes, plan, leg)


def thickness(plan: BodyPlan, part: str, length: float) -> float:
    """Return how thick a limb's part is over the usual: as the stature says, less where it is short."""
    return float(plan.unit * np.clip(length / (_USUAL_M[part] * plan.unit), 0.35, 1.08) ** 0.6)


def _add_parts(shapes: ShapeList, plan: BodyPlan, limb: Limb, parts: tuple[tuple[str, Profile], ...]) -> None:
    stops = (limb.upper, limb.lower or (limb.end,)), (limb.lower, (limb.end,))
    for (name, profile), (joints, after) in zip(parts, stops, strict=True):
        if not joints:
            continue
        axis = Axis(plan.nodes[joints[0]], plan.nodes[after[0]], plan.forward)
        if axis.length < 1e-3 * plan.unit:
            continue
        thick = thickness(plan, name, axis.length)
        rim = (0.050 if profile[0][0] < -0.1 else 0.020) * thick
        shape = loft(axis, profile, rim=rim, rings=9, around=18, scale=thick)
        starts = np.maximum.accumulate(axis.place_of(plan.nodes[list(joints)]))
        shapes.add(shape, SKIN, along_joints(axis.place_of(shape.vertices), list(joints), starts, 0.15))


def _add_balls(shapes: ShapeList, plan: BodyPlan, limb: Limb, radii: tuple[float, float, float]) -> None:
    hinge = limb.lower[0] if limb.lower else None
    for joint, radius in zip((limb.upper[0], hinge, limb.end), radii, strict=True):
        if joint is not None:
            shapes.add(ellipsoid(plan.nodes[joint], np.eye(3) * radius * plan.unit, (8, 14)), ACCENT, joint)


def _add_girdle(shapes: ShapeList, plan: BodyPlan, limb: Limb, radius: float) -> None:
    """Fill from the trunk to the ball: what a collar bone or a hip bone carries."""
    path = [*limb.girdle, limb.upper[0]]
    for joint, following in pairwise(path):
        start, end = plan.nodes[joint], plan.nodes[following]
        if np.linalg.norm(end - start) > 1e-4 * plan.unit:
            width = min(radius * plan.unit, 0.9 * float(np.linalg.norm(end - start)))
            shapes.add(capsule(start, end, (0.8 * width, width), (9, 14)), SKIN, joint)


def _add_foot(shapes: ShapeList, plan: BodyPlan, leg: Limb) -> None:
    """A foot on a flat sole, pointing where its joints do, or to the front."""
    ankle, unit = plan.nodes[leg.end], plan.unit
    chain = _toe_chain(plan, leg)
    heading, upright, reach = _foot_frame(plan, leg, chain)
    side = np.cross(upright, heading) * leg.side  # outwards
    stretch = float(np.clip((reach + 0.022 * unit) / (0.200 * unit), 0.72, 1.12)) if reach > 0 else 1.0
    table = np.array(_SOLE)
    table[:, 0] = np.where(table[:, 0] > 0, table[:, 0] * stretch, table[:, 0])
    turn = np.linspace(0.25, np.pi / 2, 4)
    first, last = table[0, 0], table[-1, 0]
    ends = 0.012 * (1 - np.cos(turn))
    places = np.concatenate([first + ends, np.linspace(first + 0.016, last - 0.016, 16), last - ends[::-1]])
    factor = np.concatenate([np.sin(turn), np.ones(16), np.sin(turn[::-1])])
    width, height, shift = (smooth_table(table, places) * unit).T
    ring = superellipse(20, 2.5)
    lift = (np.maximum(ring[:, 1], -0.72) + 0.72) / 1.72
    base = ankle - ANKLE_HEIGHT_M * unit * upright
    centre = base + (places * unit)[:, None] * heading - shift[:, None] * side
    low = (1 - factor) * 0.35 * height
    rise = low[:, None] + lift[None, :] * (height - 2 * low)[:, None]
    across = ring[None, :, 0] * (width * factor)[:, None]
    shape = tube(centre[:, None] + across[..., None] * side + rise[..., None] * upright)
    joints = [leg.end, *[n for n in chain if n < len(plan.children)]]
    starts = np.maximum.accumulate((plan.nodes[joints] - ankle) @ heading)
    starts[0] = -10.0 * unit
    along = (shape.vertices - ankle) @ heading
    shapes.add(shape, SKIN, along_joints(along, joints, starts, 0.018 * unit))


def _toe_chain(plan: BodyPlan, leg: Limb) -> list[int]:
    """The nodes of the foot's longest ray, without the ankle: joints and the end of the last."""
    below = plan.below(leg.end)
    if not below:
        return []
    tip = max(below, key=lambda n: float(np.linalg.norm(plan.nodes[n] - plan.nodes[leg.end])))
    return list(plan.chain(leg.end, tip))[1:]


def _foot_frame(plan: BodyPlan, leg: Limb, chain: list[int]) -> tuple[FloatArray, FloatArray, float]:
    """Unit vectors of the foot's heading and its upright, and how far its joints reach along (0 for none)."""
    unit, up = plan.unit, plan.up
    if not chain:
        return plan.forward, up, 0.0
    toe = plan.nodes[chain[-1]] - plan.nodes[leg.end]
    level = toe - up * float(toe @ up)
    length = float(np.linalg.norm(level))
    if length < 0.045 * unit or float(level @ plan.forward) < -0.2 * length:
        return plan.forward, up, 0.0
    heading = level / length
    drop = float(toe @ up) + (ANKLE_HEIGHT_M - 0.012) * unit  # how far the toe joint is off its height over the sole
    tilt = np.arctan2(drop, length)
    if drop < -0.03 * unit:
        tilt = max(float(tilt), -0.6)
        heading, up = np.cos(tilt) * heading + np.sin(tilt) * up, np.cos(tilt) * up - np.sin(tilt) * heading
    return heading, up, float(toe @ heading)
