"""A body made from nothing but a skeleton's bones: what any motion wears until it is given a better one."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_hands import add_hand
from qmd_studio.avatar.bone_body_limbs import add_arm, add_leg
from qmd_studio.avatar.bone_body_paint import ACCENT, EXTRA, SKIN
from qmd_studio.avatar.bone_body_plan import BodyPlan, plan_body
from qmd_studio.avatar.bone_body_shapes import ShapeList, capsule, ellipsoid
from qmd_studio.avatar.bone_body_trunk import add_neck_and_head, add_trunk
from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.skeleton import Skeleton

MAX_FACES = 25_000


def bone_body(skeleton: Skeleton) -> Body:
    """Return a mannequin for `skeleton`, bound at its rest pose, or near it at one that can stand.

    A figure gets pelvis, waist, ribcage, neck, head, limbs, feet and hands, as far as their joints are found by name or
    by the shape of the tree; every bone that is none of these becomes a capsule. Lengths follow the bones, thickness
    the stature. At most `MAX_FACES` triangles but for skeletons of hundreds of joints.
    """
    plan = plan_body(skeleton)
    shapes = ShapeList()
    if plan.head is not None or plan.legs or plan.arms:
        trunk = add_trunk(shapes, plan)
        add_neck_and_head(shapes, plan, trunk)
        for leg in plan.legs:
            add_leg(shapes, plan, leg)
        for arm in plan.arms:
            add_arm(shapes, plan, arm)
            add_hand(shapes, plan, arm)
    _add_rest(shapes, plan, human=bool(shapes.parts))
    return Body(skeleton.name, skeleton, shapes.surface(), plan.bind)


def _add_rest(shapes: ShapeList, plan: BodyPlan, *, human: bool) -> None:
    """Add a capsule for each bone of each joint that carries nothing yet; a ball where there is nothing at all."""
    carrying = shapes.carriers()
    hidden = set(plan.below(plan.head)) if plan.head is not None else set()
    bones = [
        (joint, child)
        for joint, children in enumerate(plan.children)
        if joint not in carrying
        for child in children
        if np.linalg.norm(plan.nodes[child] - plan.nodes[joint]) > 1e-5 * plan.unit
    ]
    room = MAX_FACES - shapes.n_faces
    fine = len(bones) * (210 if human else 450) < room
    thickest = (0.016 if human else 0.05) * plan.unit
    for joint, child in bones:
        start, end = plan.nodes[joint], plan.nodes[child]
        parent = plan.parents[joint]
        in_chest = human and parent in plan.spine and np.linalg.norm(end - start) < 0.15 * plan.unit
        if joint in hidden or in_chest:
            middle = plan.nodes[parent] if in_chest else _inside_head(plan, (start + end) / 2)
            shapes.add(ellipsoid(middle, np.eye(3) * 0.01 * plan.unit, (2, 4)), EXTRA, joint)
            continue
        radius = min(0.16 * float(np.linalg.norm(end - start)), thickest)
        resolution = (9, 14) if fine else (6, 5)
        shapes.add(capsule(start, end, (radius, 0.75 * radius), resolution), EXTRA if human else SKIN, joint)
        if not human and fine:
            shapes.add(ellipsoid(start, np.eye(3) * 1.25 * radius, (8, 12)), ACCENT, joint)
    if not shapes.parts:
        shapes.add(ellipsoid(plan.nodes[0], np.eye(3) * 0.05 * max(plan.unit, 0.02), (10, 16)), ACCENT, 0)


def _inside_head(plan: BodyPlan, place: FloatArray) -> FloatArray:
    """Draw a place of the face (eye, jaw, tongue) into the skull, where its bone is held but not seen."""
    assert plan.head is not None
    middle = plan.nodes[plan.head] + 0.03 * plan.unit * plan.up
    away = place - middle
    return np.asarray(middle + away * min(0.3, 0.03 * plan.unit / max(float(np.linalg.norm(away)), 1e-9)))
