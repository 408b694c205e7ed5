"""The skeleton of the body animation parameters in the proportions of another H-Anim body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.kinematics import node_positions, rest_values
from qmd_studio.motion.skeleton import Skeleton


def bap_skeleton_like(body: Skeleton) -> Skeleton:
    """Return `bap_skeleton()` with the joint centres of `body`, an H-Anim body at rest, where it has the joint.

    Joints that `body` lacks stand as far along between those it has as in the standard body. Its columns are the 186
    parameters, so that any BAP motion plays on it. End sites move with their joints and grow with the body.
    """
    standard = bap_skeleton()
    n_joints = len(standard.joints)
    ours = node_positions(standard, rest_values(standard)[None])[0][:n_joints]
    theirs = node_positions(body, rest_values(body)[None])[0]
    known = {joint: theirs[other] for joint, other in _same_joints(standard, body).items()}
    size = float(np.ptp(theirs[: len(body.joints)], axis=0).max() / np.ptp(ours, axis=0).max())
    centres = np.zeros_like(ours)
    parents = [joint.parent for joint in standard.joints]
    for joint in range(n_joints):
        if joint in known:
            centres[joint] = known[joint]
            continue
        above = parents[joint]
        below = _next_known(joint, parents, known)
        start, base = (centres[above], ours[above]) if above >= 0 else (np.zeros(3), np.zeros(3))
        whole = float(np.linalg.norm(ours[below] - base)) if below is not None else 0.0
        if below is not None and whole > 1e-9:
            share = float(np.linalg.norm(ours[joint] - base)) / whole
            centres[joint] = start + min(share, 1.0) * (known[below] - start)
        else:
            centres[joint] = start + size * (ours[joint] - base)
    offsets = [centres[j] - (centres[p] if p >= 0 else 0.0) for j, p in enumerate(parents)]
    return replace(
        standard,
        name=body.name or standard.name,
        joints=tuple(
            replace(joint, offset=(float(o[0]), float(o[1]), float(o[2])))
            for joint, o in zip(standard.joints, offsets, strict=True)
        ),
        end_sites=tuple(
            replace(s, offset=(s.offset[0] * size, s.offset[1] * size, s.offset[2] * size)) for s in standard.end_sites
        ),
        metres_per_unit=body.metres_per_unit,
    )


def is_hanim(skeleton: Skeleton) -> bool:
    """Tell whether a skeleton's joints have H-Anim's names, of either version."""
    return parts_of(skeleton).naming.startswith("hanim")


def _same_joints(standard: Skeleton, body: Skeleton) -> dict[int, int]:
    """The joint of `body` that each joint of `standard` is: vertebrae by name, all others by part."""
    ours, theirs = parts_of(standard), parts_of(body)
    same = {joint: theirs.named[part] for part, joint in ours.named.items() if part in theirs.named}
    names = {joint.name: k for k, joint in enumerate(body.joints)}
    same |= {j: names[standard.joints[j].name] for j in (*ours.spine, *ours.neck) if standard.joints[j].name in names}
    return same | {ours.root: theirs.root}


def _next_known(joint: int, parents: list[int], known: dict[int, FloatArray]) -> int | None:
    """The nearest joint below `joint` whose centre the body gives."""
    below = {joint}
    for other in range(joint + 1, len(parents)):
        if parents[other] in below:
            if other in known:
                return other
            below.add(other)
    return None
