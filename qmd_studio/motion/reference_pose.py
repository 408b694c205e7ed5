"""Which pose of a source counts as the target's rest pose: the file's own, one of its frames, or none at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.part_frames import TRUNK, is_bent, local_frames, straightness

_T_POSE_COSINE = 0.97
_OPPOSITE_COSINE = 0.93
_SAMPLES = 60
_ROLLED_COSINE = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """A reference pose: `row` (n_columns,) of the source, None for its rest; `note` says why it was chosen.

    `trunk_row` (n_columns,), where given, is the pose that the turns of the trunk, or of its parts named in
    `trunk_parts`, are counted from.
    "rest" and "frame" turn each bone of that pose onto the target's; "zero" turns none: the file's zero pose is the
    target's rest, whatever it looks like.
    """

    kind: Literal["rest", "frame", "zero"]
    row: FloatArray | None = None
    note: str = ""
    trunk_row: FloatArray | None = None
    trunk_parts: tuple[str, ...] = TRUNK


REST = Reference("rest")
ZERO = Reference("zero", note="no bone was aligned: turns were taken as they stand")


def frame_reference(motion: Motion, frame: int) -> Reference:
    """Return frame number `frame`, from 0, of `motion` as the reference; raises `FormatError` where there is none."""
    if not 0 <= frame < motion.n_frames:
        wanted = f"0 to {motion.n_frames - 1}"
        raise FormatError("the motion has no such frame to align", wanted=wanted, got=str(frame))
    return Reference("frame", motion.X[frame].copy(), f"bones were aligned in frame {frame}")


def choose_reference(motion: Motion) -> Reference:
    """Return the reference that suits `motion`: its first frame where that is a T-pose put there for it, or the rest.

    A first frame is taken where arms and legs are straight out and down as in a T-pose, and the frame after is not.
    """
    if motion.n_frames > 1 and is_t_pose(motion, 0) and not is_t_pose(motion, 1):
        chosen = frame_reference(motion, 0)
        return Reference("frame", chosen.row, "the first frame is a T-pose: bones were aligned in it")
    frames = range(0, motion.n_frames, max(1, motion.n_frames // _SAMPLES))
    bent = is_bent(motion.skeleton, rest_values(motion.skeleton))
    if bent or _shoulders_are_rolled(motion, frames):
        best = max(frames, key=lambda frame: straightness(motion.skeleton, motion.X[frame]))
        if not is_bent(motion.skeleton, motion.X[best]):
            what, parts = ("trunk", TRUNK) if bent else ("collar bones", ("clavicle", "acromion"))
            note = f"the file's rest pose is twisted: the {what} were aligned in frame {best}, limbs at rest"
            note = note.replace("trunk were", "trunk was")
            return Reference("rest", note=note, trunk_row=motion.X[best].copy(), trunk_parts=parts)
    return Reference("rest", note="bones were aligned in the file's rest pose")


def _shoulders_are_rolled(motion: Motion, frames: range) -> bool:
    """Whether collar bones are turned against the chest by more than a body could, through most of a motion."""
    parts = parts_of(motion.skeleton)
    world = world_from_joint(motion.skeleton, motion.X[frames.start : frames.stop : frames.step])[..., :3, :3]
    local = local_frames(motion.skeleton, rest_values(motion.skeleton)).frame_in
    for side in ("l_", "r_"):
        clavicle, chest = parts.named.get(side + "clavicle"), (parts.spine or (parts.root,))[-1]
        if clavicle is None or clavicle not in local or chest not in local:
            continue
        turned = np.swapaxes(world[:, chest] @ local[chest], 1, 2) @ world[:, clavicle] @ local[clavicle]
        if np.median(np.trace(turned, axis1=1, axis2=2)) < 1.0 + 2.0 * _ROLLED_COSINE:
            return True
    return False


def is_t_pose(motion: Motion, frame: int) -> bool:
    """Tell whether arms go straight out and legs straight down, each opposite or parallel to the other one."""
    named = parts_of(motion.skeleton).named
    nodes = node_positions(motion.skeleton, motion.X[frame : frame + 1])[0]
    ways = {}
    for part, names in (("arm", ("shoulder", "elbow", "wrist")), ("leg", ("hip", "knee", "ankle"))):
        for side in ("l_", "r_"):
            joints = [named[side + name] for name in names if side + name in named]
            bones = np.diff(nodes[joints], axis=0) if len(joints) == 3 else np.zeros((2, 3))
            lengths = np.linalg.norm(bones, axis=1)
            if lengths.min() < 1e-6 or bones[0] @ bones[1] < _T_POSE_COSINE * lengths.prod():
                return False
            ways[side + part] = (nodes[joints[2]] - nodes[joints[0]]) / np.linalg.norm(
                nodes[joints[2]] - nodes[joints[0]]
            )
    level = abs(ways["l_arm"] @ ways["l_leg"]) < 0.25 and abs(ways["r_arm"] @ ways["r_leg"]) < 0.25
    opposite = ways["l_arm"] @ ways["r_arm"] < -_OPPOSITE_COSINE
    return bool(level and opposite and ways["l_leg"] @ ways["r_leg"] > _T_POSE_COSINE)
