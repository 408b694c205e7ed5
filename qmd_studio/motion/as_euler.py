"""Any motion as one of joint channels: the same movement in frames that are parallel to the world at rest.

A joint's turn away from the rest pose, seen from the world's axes, is D = G · G_rest⁻¹, where G is its world rotation.
In a skeleton without rest orientations its local rotation is then D_parent⁻¹ · D, written as Rz · Ry · Rx. For an ASF
bone with axis C that is C · R(amc) · C⁻¹. No joint is added or left out and no direction is changed: this is the
same motion in other coordinates, not retargeting.
"""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.channels import POSITIONS, ROTATIONS_ZYX, channel_skeleton
from qmd_studio.motion.kinematics import chain_of, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.rotation import axis_rotation
from qmd_studio.motion.skeleton import EndSite, Skeleton, Vector3

_LOCKED_COSINE = 1e-9
"""Nearer to a gimbal lock than this the first angle carries no information and keeps its last value."""
_TIE = 1e-12
"""Ways to write a rotation that are nearer to each other than this many radians do not alternate by rounding."""


def as_euler(motion: Motion) -> Motion:
    """Return `motion` on a skeleton of kind BVH whose nodes, found by name, move in the same way.

    Joints come in depth-first order with channels Zrotation Yrotation Xrotation; roots and joints that move have three
    positions as well. Angles go on from frame to frame without jumps of a full or half turn. Opaque columns move
    nothing and are left out; a mask is dropped.
    """
    skeleton = motion.skeleton
    order = _depth_first(skeleton)
    rest = _rest_rotations(skeleton)
    turns = _local_turns(skeleton, motion.X, rest)
    place = {old: new for new, old in enumerate(order)}
    joints, values = [], []
    moving = set(chain_of(skeleton).move_column.tolist())
    movers = {skeleton.columns[column].joint for column in moving}
    for old in order:
        joint = skeleton.joints[old]
        frame = rest[joint.parent] if joint.parent >= 0 else np.eye(3)
        channels: tuple[str, ...] = ROTATIONS_ZYX
        if joint.parent < 0 or old in movers:
            channels = POSITIONS + ROTATIONS_ZYX
            values.append(_displaced(skeleton, motion.X, old) @ frame.T)
        values.append(euler_zyx(turns[:, old]))
        joints.append((joint.name, place.get(joint.parent, -1), _vector(frame @ joint.offset), channels))
    sites = [
        EndSite(site.name, place[site.joint], _vector(rest[site.joint] @ site.offset)) for site in skeleton.end_sites
    ]
    target = channel_skeleton(joints, sites, metres_per_unit=skeleton.metres_per_unit)
    return Motion(target, np.concatenate(values, axis=1), motion.fps, name=motion.name)


def euler_zyx(rotation: FloatArray) -> FloatArray:
    """Return angles (n_frames, 3) radians z, y, x with Rz · Ry · Rx = `rotation` (n_frames, 3, 3).

    Of the ways to write a rotation the one nearest to the frame before is taken, the first being the one nearest to 0.
    """
    z = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    locked = np.hypot(rotation[:, 1, 0], rotation[:, 0, 0]) < _LOCKED_COSINE
    z = _held(z, locked)
    inner = np.swapaxes(axis_rotation(2, z), 1, 2) @ rotation  # Ry · Rx, whatever z was taken
    y = np.arctan2(-inner[:, 2, 0], inner[:, 0, 0])
    x = np.arctan2(-inner[:, 1, 2], inner[:, 1, 1])
    return _continued(np.stack([z, y, x], axis=1))


def _held(values: FloatArray, unknown: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> FloatArray:
    """Replace the unknown values (n_frames,) by the last known ones, or 0 before the first."""
    if not unknown.any():
        return values
    last: IntArray = np.maximum.accumulate(np.where(unknown, -1, np.arange(len(values))))
    return np.where(last < 0, 0.0, values[np.maximum(last, 0)])


def _continued(principal: FloatArray) -> FloatArray:
    """Choose for each frame (n_frames, 3), one after the other, the equal triple nearest to the one before.

    The other way to write (z, y, x) is (z + 180°, 180° - y, x + 180°). Whether it is nearer to the frame before does
    not depend on how that one was written, for both then change alike: so each frame says whether to go over or to
    stay, and the way itself is the parity of all changes up to it. Equally near ones stay.
    """
    before = np.concatenate([np.zeros((1, 3)), principal[:-1]])
    staying = _distance(principal, before)
    going_over = _distance(_other_way(principal), before)
    other = np.cumsum(going_over < staying - _TIE) % 2 == 1
    chosen = np.where(other[:, None], _other_way(principal), principal)
    steps = np.diff(chosen, axis=0, prepend=0.0)
    return np.asarray(chosen - 2 * np.pi * np.cumsum(np.round(steps / (2 * np.pi)), axis=0))


def _other_way(angles: FloatArray) -> FloatArray:
    return np.stack([angles[:, 0] + np.pi, np.pi - angles[:, 1], angles[:, 2] + np.pi], axis=1)


def _distance(angles: FloatArray, before: FloatArray) -> FloatArray:
    """Return how far triples (n_frames, 3) are apart, whole turns left out."""
    away = angles - before
    return np.asarray(np.abs(away - 2 * np.pi * np.round(away / (2 * np.pi))).sum(axis=1))


def _depth_first(skeleton: Skeleton) -> list[int]:
    children: list[list[int]] = [[] for _ in skeleton.joints]
    roots: list[int] = []
    for index, joint in enumerate(skeleton.joints):
        (children[joint.parent] if joint.parent >= 0 else roots).append(index)
    order: list[int] = []
    waiting = roots[::-1]
    while waiting:
        order.append(waiting.pop())
        waiting.extend(reversed(children[order[-1]]))
    return order


def _rest_rotations(skeleton: Skeleton) -> FloatArray:
    """Return world rotations (n_joints, 3, 3) of the rest pose."""
    chain = chain_of(skeleton)
    rest = chain.orientation.copy()
    for joint, parent in enumerate(chain.parent):
        if parent >= 0:
            rest[joint] = rest[parent] @ rest[joint]
    return rest


def _local_turns(skeleton: Skeleton, X: FloatArray, rest: FloatArray) -> FloatArray:
    """Return rotations (n_frames, n_joints, 3, 3) from joint to parent in frames that are world-parallel at rest."""
    turned = world_from_joint(skeleton, X)[..., :3, :3] @ np.swapaxes(rest, 1, 2)
    local = turned.copy()
    for joint, parent in enumerate(chain_of(skeleton).parent):
        if parent >= 0:
            local[:, joint] = np.swapaxes(turned[:, parent], 1, 2) @ turned[:, joint]
    return local


def _displaced(skeleton: Skeleton, X: FloatArray, joint: int) -> FloatArray:
    """Return the offsets (n_frames, 3) of a joint in its parent's rest frame, its moves added."""
    chain = chain_of(skeleton)
    offset = np.tile(chain.offset[joint], (len(X), 1))
    for k in range(chain.move_start[joint], chain.move_start[joint + 1]):
        offset[:, chain.move_axis[k]] += chain.move_sign[k] * X[:, chain.move_column[k]]
    return offset


def _vector(values: FloatArray) -> Vector3:
    return (float(values[0]), float(values[1]), float(values[2]))
