"""Hands of a body made from bones: palm and fingers where the skeleton has them, else a closed hand with a thumb."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_loft import Axis, Profile, loft
from qmd_studio.avatar.bone_body_paint import SKIN
from qmd_studio.avatar.bone_body_plan import BodyPlan
from qmd_studio.avatar.bone_body_shapes import ShapeList, along_joints, capsule
from qmd_studio.motion.joint_names import Limb

_PALM: Profile = (
    (-0.06, 0.0240, 0.0165),
    (0.15, 0.0290, 0.0180),
    (0.55, 0.0390, 0.0170),
    (0.88, 0.0415, 0.0150),
    (1.07, 0.0395, 0.0125),
)
_PALM_HALF_M = 0.042
_HAND_M, _KNUCKLES = 0.178, 0.50
_FINGERS = ((0.78, 0.93, 0.0087), (0.27, 1.0, 0.0092), (-0.25, 0.95, 0.0088), (-0.76, 0.80, 0.0078))
"""Place across the palm from the thumb's side, length over the longest, and radius of the fingers of a closed hand."""


def add_hand(shapes: ShapeList, plan: BodyPlan, arm: Limb) -> None:
    """Add the hand of an arm, with as many fingers as its joints move."""
    thumbs, fingers = _finger_chains(plan, arm)
    if len(fingers) >= 3:
        direction, thumbward = _open_hand(shapes, plan, arm, fingers)
    else:
        direction, thumbward = _closed_hand(shapes, plan, arm, fingers)
    if thumbs:
        _add_thumb(shapes, plan, arm, thumbs[0])
    else:
        start = plan.nodes[arm.end] + plan.unit * (0.030 * direction + 0.022 * thumbward)
        middle = start + plan.unit * (0.030 * direction + 0.026 * thumbward)
        end = middle + plan.unit * (0.030 * direction + 0.008 * thumbward)
        shapes.add(capsule(start, middle, (0.0150 * plan.unit, 0.0118 * plan.unit), (8, 10)), SKIN, arm.end)
        shapes.add(capsule(middle, end, (0.0118 * plan.unit, 0.0095 * plan.unit), (8, 10)), SKIN, arm.end)


def _finger_chains(plan: BodyPlan, arm: Limb) -> tuple[list[list[int]], list[list[int]]]:
    """Chains of nodes from below the wrist to each tip: thumbs, and fingers from the thumb's side."""
    below = plan.below(arm.end)
    tips = [n for n in below if n >= len(plan.children) or not plan.children[n]]
    chains = [list(plan.chain(arm.end, tip))[1:] for tip in tips]
    chains = [c for c in chains if _length(plan, c) > 0.01 * plan.unit or len(c) > 2]
    thumbs = [c for c in chains if any(plan.is_thumb(n) for n in c)]
    fingers = [c for c in chains if c not in thumbs and sum(n < len(plan.children) for n in c) >= 2]
    hint = plan.forward if not thumbs else plan.nodes[thumbs[0][-1]] - plan.nodes[arm.end]
    fingers.sort(key=lambda c: -float(plan.nodes[_knuckle(plan, arm, c)] @ hint))
    return thumbs, fingers


def _knuckle(plan: BodyPlan, arm: Limb, chain: list[int]) -> int:
    """The first joint of a finger proper: the one nearest after 42 hundredths of the way from wrist to tip."""
    path = plan.nodes[[arm.end, *chain]]
    way = np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))
    after = [n for n, w in zip(chain[:-1], way[:-1], strict=True) if w >= 0.40 * way[-1]]
    return after[0] if after else chain[max(len(chain) - 2, 0)]


def _open_hand(shapes: ShapeList, plan: BodyPlan, arm: Limb, fingers: list[list[int]]) -> tuple[FloatArray, FloatArray]:
    wrist, unit = plan.nodes[arm.end], plan.unit
    knuckles = [_knuckle(plan, arm, chain) for chain in fingers]
    middle = plan.nodes[knuckles].mean(axis=0)
    direction = _unit(middle - wrist, _heading(plan, arm))
    spread = plan.nodes[knuckles[0]] - plan.nodes[knuckles[-1]]
    spread = spread - direction * float(spread @ direction)
    thumbward = _unit(spread, plan.forward)
    normal = np.cross(direction, thumbward)
    half = float(np.linalg.norm(spread)) / 2 + 0.0085 * unit
    wide = float(np.clip(half / (_PALM_HALF_M * unit), 0.6, 1.4))
    profile = [(t, s * wide * unit, d * unit) for t, s, d in _PALM]
    axis = Axis(wrist, wrist + direction * float((middle - wrist) @ direction), normal)
    shapes.add(loft(axis, profile, rim=0.016 * unit, rings=10, around=20, square=2.5), SKIN, arm.end)
    pitch = float(np.clip(2 * half / (len(fingers) + 0.2), 0.018 * unit, 0.0235 * unit))
    for number, (chain, knuckle) in enumerate(zip(fingers, knuckles, strict=True)):
        radius = pitch * (0.46 if number < len(fingers) - 1 else 0.40)
        _add_chain(shapes, plan, chain, (chain.index(knuckle), radius))
    return direction, thumbward


def _closed_hand(
    shapes: ShapeList, plan: BodyPlan, arm: Limb, chains: list[list[int]]
) -> tuple[FloatArray, FloatArray]:
    """A flat hand with its fingers together, carried by whatever joints the hand has along its middle."""
    wrist, unit = plan.nodes[arm.end], plan.unit
    spine = _main_chain(plan, arm, chains)
    direction = _unit(plan.nodes[spine[-1]] - wrist, _heading(plan, arm)) if spine else _heading(plan, arm)
    reach = float(np.linalg.norm(plan.nodes[spine[-1]] - wrist)) if spine else 0.0
    length = reach if 0.11 * unit < reach < 0.24 * unit else _HAND_M * unit
    thumbward = _unit(plan.forward - direction * float(plan.forward @ direction), plan.up)
    normal = np.cross(direction, thumbward)
    joints = [arm.end, *[n for n in spine if n < len(plan.children)]]
    starts = np.maximum.accumulate((plan.nodes[joints] - wrist) @ direction)
    starts[0] = -10 * unit
    palm = Axis(wrist, wrist + _KNUCKLES * length * direction, normal)
    parts = [loft(palm, _PALM, rim=0.016 * unit, rings=10, around=20, square=2.5, scale=unit)]
    for place, share, radius in _FINGERS:
        root = wrist + 0.47 * length * direction + place * 0.036 * unit * thumbward
        tip = wrist + (_KNUCKLES + (1 - _KNUCKLES) * share) * length * direction + place * 0.029 * unit * thumbward
        parts.append(
            capsule(root, tip - radius * unit * direction, (1.04 * radius * unit, 0.86 * radius * unit), (6, 8))
        )
    for shape in parts:
        place_along = (shape.vertices - wrist) @ direction
        shapes.add(shape, SKIN, along_joints(place_along, joints, starts, 0.012 * unit))
    return direction, thumbward


def _add_thumb(shapes: ShapeList, plan: BodyPlan, arm: Limb, chain: list[int]) -> None:
    unit = plan.unit
    wrist = plan.nodes[arm.end]
    first = plan.nodes[chain[min(1, len(chain) - 1)]]
    heel = wrist + 0.30 * (first - wrist)
    if chain[0] < len(plan.children):
        shapes.add(capsule(heel, first, (0.0150 * unit, 0.0130 * unit), (8, 10)), SKIN, chain[0])
    _add_chain(shapes, plan, chain, (min(1, len(chain) - 1), 0.0112 * unit))


def _add_chain(shapes: ShapeList, plan: BodyPlan, chain: list[int], start: tuple[int, float]) -> None:
    """Add a finger: thin bones up to place `start[0]` of the chain, which the palm hides, full ones from there."""
    first, radius = start
    points = [plan.nodes[n] for n in chain]
    if chain[-1] < len(plan.children) and len(chain) - first <= 3:  # the last joint has no end: give it one
        before = points[-2] if len(points) > 1 else plan.nodes[plan.parents[chain[-1]]]
        points.append(points[-1] + 0.85 * (points[-1] - before))
    n_bones = len(points) - 1
    for k in range(n_bones):
        if np.linalg.norm(points[k + 1] - points[k]) < 1e-4 * plan.unit:
            continue
        thin = 0.55 if k < first else 1.0 - 0.07 * (k - first)
        end = points[k + 1]
        if k == n_bones - 1:  # the tip's roundness lies within the bone
            back = points[k] - end
            end = end + back * min(0.5, 0.8 * radius / float(np.linalg.norm(back)))
        shapes.add(
            capsule(points[k], end, (radius * thin, radius * (thin - 0.06)), (6, 10 if k >= first else 5)),
            SKIN,
            chain[k],
        )


def _main_chain(plan: BodyPlan, arm: Limb, chains: list[list[int]]) -> list[int]:
    wrist, heading = plan.nodes[arm.end], _heading(plan, arm)
    below = [  # what lies back towards the elbow is no finger
        n
        for n in plan.below(arm.end)
        if not plan.is_thumb(n)
        and float((plan.nodes[n] - wrist) @ heading) > 0.5 * float(np.linalg.norm(plan.nodes[n] - wrist))
    ]
    if chains:
        return max(chains, key=lambda c: _length(plan, c))
    if not below:
        return []
    tip = max(below, key=lambda n: float(np.linalg.norm(plan.nodes[n] - wrist)))
    return list(plan.chain(arm.end, tip))[1:]


def _heading(plan: BodyPlan, arm: Limb) -> FloatArray:
    before = (*arm.upper, *arm.lower)[-1]
    return _unit(plan.nodes[arm.end] - plan.nodes[before], -plan.up)


def _length(plan: BodyPlan, chain: list[int]) -> float:
    return float(np.linalg.norm(np.diff(plan.nodes[chain], axis=0), axis=1).sum())


def _unit(vector: FloatArray, default: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else default
