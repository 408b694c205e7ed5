"""Poses to look at an avatar in: hand shapes of sign language, and the trunk and limbs near their limits.

Angles are degrees of body animation parameters. A name without its side is meant for both sides; one that turns about
the body's long or deep axis is given for the left, and the right mirrors it.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.bap import Bap, bap_table

Pose = dict[str, float]

_FINGERS = ("index", "middle", "ring", "pinky")
_CURLED, _STRAIGHT = (-88.0, -98.0, -62.0), (0.0, 0.0, 0.0)
_TOGETHER = (4.0, 1.0, -1.6, -5.0)
_APART = (-13.0, -3.0, 7.0, 17.0)
_ALIGNED = (3.0, 1.0, -1.0, -3.0)


def _hand(fingers, thumb: tuple[float, ...], spread: tuple[float, ...] = _ALIGNED) -> Pose:
    """Return a hand shape: three flexions of each finger, the thumb's (root flexion, pivot, roll, middle, end)."""
    pose = {}
    for finger, angles, pivot in zip(_FINGERS, fingers, spread, strict=True):
        pose |= {f"{finger}{i + 1}_flexion": angle for i, angle in enumerate(angles)}
        pose[f"{finger}1_pivot"] = pivot
    names = ("thumb1_flexion", "thumb1_pivot", "thumb1_twisting", "thumb2_flexion", "thumb3_flexion")
    return pose | dict(zip(names, thumb, strict=True))


HANDS: dict[str, Pose] = {
    "rest": {},
    "A: fist, thumb beside": _hand([_CURLED] * 4, (-40, -18, -15, -36, -10)),
    "S: fist, thumb across": _hand([_CURLED] * 4, (-21, -66, -20, -50, -68)),
    "T: thumb under index": _hand([(-66, -90, -50), *[_CURLED] * 3], (-33, -63, -19, -48, -45)),
    "B: flat, thumb across palm": _hand([_STRAIGHT] * 4, (-50, 12, -20, -50, -78), _TOGETHER),
    "flat, thumb along": _hand([_STRAIGHT] * 4, (-25, 2, -4, -50, -20), _TOGETHER),
    "5: fingers spread": _hand([_STRAIGHT] * 4, (-18, 6, 0, 0, 0), _APART),
    "O": _hand([(-52, -58, -32), (-54, -60, -34), (-56, -62, -34), (-58, -62, -34)], (-9, -69, -20, -48, -52)),
    "C": _hand([(-24, -46, -28)] * 4, (-10, -62, -20, -30, -25)),
    "V": _hand([_STRAIGHT, _STRAIGHT, _CURLED, _CURLED], (-24, -68, -20, -50, -70), (-11, 9, 0, -4)),
    "L": _hand([_STRAIGHT, *[_CURLED] * 3], (0, 4, 0, 5, 8)),
    "Y": _hand([_CURLED] * 3 + [_STRAIGHT], (-12, 8, 0, 5, 8), (3, 1, 0, 16)),
}
"""Hand shapes by the letter of American Sign Language's alphabet, or by what they look like."""

_ARMS_CROSSED = {
    "shoulder_flexion": 25.0, "shoulder_abduct": 50.0, "shoulder_twisting": 62.0, "elbow_flexion": 100.0,
}  # fmt: skip
BODIES: dict[str, Pose] = {
    "rest": {},
    "arms out": {"shoulder_abduct": 90.0},
    "arms half out": {"shoulder_abduct": 45.0},
    "arms forward": {"shoulder_flexion": 90.0},
    "arms overhead": {
        "shoulder_abduct": 150.0, "acromioclavicular_abduct": 15.0, "sternoclavicular_abduct": 15.0,
    },
    "arms back": {"shoulder_flexion": -55.0},
    "arms crossed": _ARMS_CROSSED,
    "hand to mouth": {
        "l_shoulder_flexion": 25.0, "l_shoulder_abduct": 35.0, "l_shoulder_twisting": 40.0, "l_elbow_flexion": 140.0,
    },
    "sitting": {"hip_flexion": 90.0, "knee_flexion": -90.0},
    "striding": {
        "l_hip_flexion": 38.0, "l_knee_flexion": -18.0, "l_ankle_flexion": 10.0,
        "r_hip_flexion": -24.0, "r_knee_flexion": -30.0, "r_ankle_flexion": 5.0, "r_metatarsal_flexion": 30.0,
        "l_shoulder_flexion": -25.0, "r_shoulder_flexion": 28.0, "elbow_flexion": 25.0,
    },
    "crouching": {"hip_flexion": 115.0, "knee_flexion": -130.0, "ankle_flexion": 20.0},
    "legs apart": {"hip_abduct": 40.0},
}  # fmt: skip
"""Poses of the whole body."""


def angles_of(pose: Pose) -> dict[str, list[tuple[Bap, float]]]:
    """Return the parameters and their radians, by joint, in the order in which they turn it.

    Raises `ValueError` for a name that no parameter has and for an angle outside its anatomical limits.
    """
    known = {parameter.name: parameter for parameter in bap_table() if parameter.limits}
    result: dict[str, list[tuple[Bap, float]]] = {}
    for name, degrees in pose.items():
        for full, mirrored in ((name, False),) if name in known else ((f"l_{name}", False), (f"r_{name}", True)):
            if full not in known:
                raise ValueError(f"no limited body animation parameter is called {full}")
            parameter = known[full]
            angle = np.radians(degrees)
            if mirrored and parameter.sign * known["l_" + full[2:]].sign * (1 if parameter.axis == 0 else -1) < 0:
                angle = -angle
            if not parameter.limits[0] - 1e-9 <= angle <= parameter.limits[1] + 1e-9:
                raise ValueError(f"{full} cannot be {np.degrees(angle):.0f} degrees")
            result.setdefault(parameter.joint, []).append((parameter, angle))
    return {joint: sorted(turns, key=lambda turn: turn[0].applied) for joint, turns in result.items()}


def world_of(body: Body, pose: Pose) -> np.ndarray:
    """Return world_from_joint (n_joints, 4, 4) of a body in a pose, its root where it is at rest."""
    angles = angles_of(pose)
    world = np.tile(np.eye(4), (len(body.skeleton.joints), 1, 1))
    for number, joint in enumerate(body.skeleton.joints):
        turn = np.eye(4)
        turn[:3, 3] = joint.offset
        for parameter, angle in angles.get(joint.name, []):
            axis = np.eye(3)[parameter.axis] * parameter.sign
            turn[:3, :3] = Rotation.from_rotvec(axis * angle).as_matrix() @ turn[:3, :3]
        world[number] = turn if joint.parent < 0 else world[joint.parent] @ turn
    return world
