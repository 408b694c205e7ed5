"""What retargeting knows before any frame: each target joint's source, its turn at rest and its degrees of freedom."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.body_parts import BodyParts, parts_of
from qmd_studio.motion.joint_map import JointMap
from qmd_studio.motion.kinematics import Chain, chain_of, node_positions, rest_values
from qmd_studio.motion.part_frames import TRUNK, LocalFrames
from qmd_studio.motion.skeleton import Column, Skeleton

_UNLIMITED = 1e12


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """Which source joints are read and what they turn; S of them, J target joints.

    `joints` (S,) source joints and `frames` (S, 3, 3) from their parts to themselves. Target joint j aims at part
    `source[j]`, -1 for none; where `share[j]` < 1 it is that share of the way from part `base[j]` to it.
    `frame_inverse` (J, 3, 3) goes from the target joint to its part.
    """

    joints: IntArray
    frames: FloatArray
    source: IntArray
    base: IntArray
    share: FloatArray
    frame_inverse: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Freedom:
    """The rotation columns of J joints, three at most each, in the order in which they multiply.

    `axes`, `sign`, `column`, `low` and `high` (J, 3): limits are of the angles about the bare axes, ±1e12 where there
    are none. For two axes the third of `axes` is the turn that is given up, and `lead` (J, 3) the unit vector whose way
    is kept; it is zero for other joints. Joint j with `hinge_child[j]` >= 0 is
    rolled about its `bone` (J, 3) so that the lone `hinge` (J, 3) below it reaches: `child_bone` is the lower bone at
    rest in j's frame, `lower_bone` in its own.
    """

    n_axes: IntArray
    axes: IntArray
    sign: IntArray
    column: IntArray
    lead: FloatArray
    low: FloatArray
    high: FloatArray
    hinge_child: IntArray
    hinge: FloatArray
    bone: FloatArray
    child_bone: FloatArray
    lower_bone: FloatArray


def drive_of(
    joint_map: JointMap, skeletons: tuple[Skeleton, Skeleton], frames: tuple[LocalFrames, LocalFrames]
) -> Drive:
    """Return the drive for (source, target)."""
    target = skeletons[1]
    number = [{joint.name: k for k, joint in reversed(list(enumerate(s.joints)))} for s in skeletons]
    kinds = [parts_of(skeleton).part_of() for skeleton in skeletons]
    n_joints = len(target.joints)
    read: dict[tuple[int, bool], int] = {}
    of_part, base, share = np.full(n_joints, -1), np.full(n_joints, -1), np.ones(n_joints)
    frame_inverse = np.tile(np.eye(3), (n_joints, 1, 1))
    rest = rest_rotations(chain_of(target))
    for name, targets in joint_map.pairs:
        joint, ends = number[0][name], [number[1][t] for t in targets]
        for end in ends:
            as_part = _comparable(kinds[0].get(joint), kinds[1].get(end))
            of_part[end] = read.setdefault((joint, as_part), len(read))
            frame_inverse[end] = (frames[1].frame_in[end] if as_part else frames[1].body_in[end]).T
            share[end] = _share(target, end, ends)
    _complete(of_part, frame_inverse, (target, rest), joint_map.columns)
    for end in np.flatnonzero(share < 1.0).tolist():
        base[end] = _base(target, end, of_part)
    parts = [frames[0].frame_in[j] if as_part else frames[0].body_in[j] for j, as_part in read]
    joints = np.array([joint for joint, _ in read], dtype=np.int64)
    return Drive(
        joints, np.array(parts).reshape(-1, 3, 3), of_part.astype(np.int64), base.astype(np.int64), share, frame_inverse
    )


def freedom_of(skeleton: Skeleton, driven: IntArray, allowed: tuple[str, ...] = ()) -> Freedom:
    """Return the degrees of freedom of `skeleton`; `driven` (J,) tells by numbers from 0 up which joints aim.

    Where `allowed` names columns, the others are none.
    """
    n_joints = len(skeleton.joints)
    axes, sign, of_column = (np.zeros((n_joints, 3), dtype=np.int64) for _ in range(3))
    lead = np.zeros((n_joints, 3))
    low, high = np.full((n_joints, 3), -_UNLIMITED), np.full((n_joints, 3), _UNLIMITED)
    n_axes = np.zeros(n_joints, dtype=np.int64)
    bones = _bones(skeleton)
    for j, joint in enumerate(skeleton.joints):
        turns = _independent(skeleton, joint.product, allowed)
        n_axes[j] = len(turns)
        for a, index in enumerate(turns):
            column = skeleton.columns[index]
            axes[j, a], sign[j, a], of_column[j, a] = column.axis, column.sign, index
            low[j, a], high[j, a] = _angle_limits(column)
        if len(turns) == 2:
            axes[j, 2] = _given_up(skeleton, j, axes[j], (bones[j], driven))
            lead[j] = bones[j] if axes[j, 2] == axes[j, 0] else np.eye(3)[axes[j, 2]]
    hinge, bone, child_bone, lower_bone = (np.zeros((n_joints, 3)) for _ in range(4))
    hinge_child = np.full(n_joints, -1)
    for child, joint in enumerate(skeleton.joints):
        upper = joint.parent
        if n_axes[child] != 1 or upper < 0 or n_axes[upper] != 3 or driven[child] < 0 or driven[upper] < 0:
            continue
        if _is_limb(skeleton, child) and np.any(bones[child]) and np.any(joint.offset):
            turn = np.array(joint.orientation)
            hinge_child[upper] = child
            hinge[upper] = turn[:, axes[child, 0]]
            bone[upper] = np.array(joint.offset) / np.linalg.norm(joint.offset)
            child_bone[upper], lower_bone[upper] = turn @ bones[child], bones[child]
    return Freedom(
        n_axes=n_axes,
        axes=axes,
        sign=sign,
        column=of_column,
        lead=lead,
        low=low,
        high=high,
        hinge_child=hinge_child.astype(np.int64),
        hinge=hinge,
        bone=bone,
        child_bone=child_bone,
        lower_bone=lower_bone,
    )


def rest_rotations(chain: Chain) -> FloatArray:
    """Return world rotations (J, 3, 3) of the rest pose."""
    rest = chain.orientation.copy()
    for joint, parent in enumerate(chain.parent):
        if parent >= 0:
            rest[joint] = rest[parent] @ rest[joint]
    return rest


def leg_length(parts: BodyParts, nodes: FloatArray) -> float:
    """Return the length of hip to knee to ankle, the mean of both sides, in metres; 0 where there are no legs."""
    lengths = []
    for side in ("l_", "r_"):
        path = [parts.named[side + p] for p in ("hip", "knee", "ankle") if side + p in parts.named]
        if len(path) > 1:
            lengths.append(float(np.linalg.norm(np.diff(nodes[path], axis=0), axis=1).sum()))
    return float(np.mean(lengths)) if lengths else 0.0


def size_of(skeleton: Skeleton) -> float:
    """Return a length to compare bodies without legs by: from the root to the farthest node at rest, metres."""
    nodes = node_positions(skeleton, rest_values(skeleton)[None])[0]
    return float(np.linalg.norm(nodes - nodes[parts_of(skeleton).root], axis=1).max())


def _comparable(ours: str | None, theirs: str | None) -> bool:
    """Whether two parts' own frames mean the same: a trunk's turn is not a limb's."""
    if ours is None or theirs is None:
        return False
    trunk = [re.sub("^[lr]_", "", part) in TRUNK for part in (ours, theirs)]
    return trunk[0] == trunk[1]


def _share(target: Skeleton, joint: int, ends: list[int]) -> float:
    """How much of the source's turn has been done at `joint`: its place among the ends above and below it."""
    above = sum(end in _ancestors(target, joint) for end in ends)
    below = max(sum(e in ends for e in _ancestors(target, end)) for end in ends if joint in _ancestors(target, end))
    return above / below


def _ancestors(skeleton: Skeleton, joint: int) -> list[int]:
    path = [joint]
    while skeleton.joints[path[-1]].parent >= 0:
        path.append(skeleton.joints[path[-1]].parent)
    return path


def _base(target: Skeleton, joint: int, of_part: IntArray) -> int:
    """The part that the first joint above which aims at another one aims at, -1 for none."""
    others = (of_part[j] for j in _ancestors(target, joint)[1:] if of_part[j] >= 0 and of_part[j] != of_part[joint])
    return int(next(others, -1))


def _complete(
    of_part: IntArray, frame_inverse: FloatArray, body: tuple[Skeleton, FloatArray], allowed: tuple[str, ...]
) -> None:
    """Let joints that have no source take on what the joint above them cannot hold: the subtalar the foot's roll."""
    target, rest = body
    n_turns = [len(_independent(target, joint.product, allowed)) for joint in target.joints]
    held = np.array(n_turns)
    kinds = parts_of(target).part_of()
    for joint, above in enumerate(j.parent for j in target.joints):
        if of_part[joint] >= 0 or above < 0 or of_part[above] < 0 or not n_turns[joint] or held[above] >= 3:
            continue
        part = kinds.get(joint, "")
        if held[above] and part[2:] in ("acromion", "subtalar", "midtarsal", "forearm_twist", "wrist"):
            of_part[joint] = of_part[above]
            local = frame_inverse[above] @ rest[above].T @ rest[joint]
            frame_inverse[joint] = local
            held[joint] = held[above] + n_turns[joint]


def _independent(skeleton: Skeleton, product: tuple[int, ...], allowed: tuple[str, ...]) -> list[int]:
    """The first three allowed rotation columns of which no two that follow each other have one axis."""
    turns: list[int] = []
    for index in product:
        if allowed and skeleton.columns[index].name not in allowed:
            continue
        if not turns or skeleton.columns[turns[-1]].axis != skeleton.columns[index].axis:
            turns.append(index)
    return turns[:3]


def _angle_limits(column: Column) -> tuple[float, float]:
    if column.limits is None:
        return -_UNLIMITED, _UNLIMITED
    low, high = sorted(column.sign * limit for limit in column.limits)
    return low, high


def _bones(skeleton: Skeleton) -> FloatArray:
    """Unit vectors (J, 3) from each joint to its first child or measured end site away from it; 0 for none."""
    bones = np.zeros((len(skeleton.joints), 3))
    measured, n_joints = set(skeleton.points), len(skeleton.joints)
    ends = [(site.joint, site.offset) for k, site in enumerate(skeleton.end_sites) if n_joints + k in measured]
    for parent, offset in (*ends[::-1], *((joint.parent, joint.offset) for joint in skeleton.joints[::-1])):
        length = float(np.linalg.norm(offset))
        if parent >= 0 and length > 1e-9:
            bones[parent] = np.array(offset) / length
    parts = parts_of(skeleton).named
    nodes = node_positions(skeleton, rest_values(skeleton)[None])[0]
    rest = rest_rotations(chain_of(skeleton))
    for side in ("l_", "r_"):
        for part in ("clavicle", "acromion"):  # what they carry is the shoulder, whatever stands between
            if side + part in parts and side + "shoulder" in parts:
                joint = parts[side + part]
                way = rest[joint].T @ (nodes[parts[side + "shoulder"]] - nodes[joint])
                bones[joint] = way / max(float(np.linalg.norm(way)), 1e-9)
    return bones


def _given_up(skeleton: Skeleton, joint: int, axes: IntArray, more: tuple[FloatArray, IntArray]) -> int:
    """The axis of the turn that a joint of two axes leaves to the joints below: the next one's own, or the bone's."""
    bone, driven = more
    missing = 3 - int(axes[0]) - int(axes[1])
    for child, below in enumerate(skeleton.joints):
        if below.parent == joint and driven[child] == driven[joint] >= 0 and len(below.product) == 1:
            return missing if skeleton.columns[below.product[0]].axis == missing else int(axes[0])
    along = int(np.argmax(np.abs(bone)))
    return missing if along == axes[1] or not np.any(bone) else along


def _is_limb(skeleton: Skeleton, joint: int) -> bool:
    return parts_of(skeleton).part_of().get(joint, "")[2:] in ("elbow", "knee")
