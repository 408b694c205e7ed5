"""Forward kinematics in NumPy: every frame at once, joint after joint. The fast path in numba is checked against it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.rotation import axis_rotation
from qmd_studio.motion.skeleton import ColumnKind, Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A skeleton as flat arrays, for kernels; J joints, S end sites, M columns.

    `parent` (J,), `orientation` (J, 3, 3) and `offset` (J, 3) metres, the columns' rest values already taken off.
    Turns in the order in which they multiply: joint j has rows `turn_start[j]:turn_start[j + 1]` of `turn_column`,
    `turn_axis`, `turn_sign`; moves likewise. `site_joint` (S,), `site_offset` (S, 3), `points` (P,) node numbers.
    """

    parent: IntArray
    orientation: FloatArray
    offset: FloatArray
    turn_start: IntArray
    turn_column: IntArray
    turn_axis: IntArray
    turn_sign: FloatArray
    move_start: IntArray
    move_column: IntArray
    move_axis: IntArray
    move_sign: FloatArray
    site_joint: IntArray
    site_offset: FloatArray
    points: IntArray


@lru_cache(maxsize=64)
def chain_of(skeleton: Skeleton) -> Chain:
    """Return the flat arrays of `skeleton`, made once."""
    joints, columns = skeleton.joints, skeleton.columns
    offset = np.array([joint.offset for joint in joints], dtype=np.float64)
    moves: list[list[int]] = [[] for _ in joints]
    for index, column in enumerate(columns):
        if column.kind is ColumnKind.TRANSLATION:
            moves[column.joint].append(index)
            offset[column.joint, column.axis] -= column.sign * column.rest
    turn = [index for joint in joints for index in joint.product]
    move = [index for group in moves for index in group]
    return Chain(
        parent=np.array([joint.parent for joint in joints], dtype=np.int64),
        orientation=np.array([joint.orientation for joint in joints], dtype=np.float64),
        offset=offset,
        turn_start=_starts([len(joint.product) for joint in joints]),
        turn_column=np.array(turn, dtype=np.int64),
        turn_axis=np.array([columns[i].axis for i in turn], dtype=np.int64),
        turn_sign=np.array([columns[i].sign for i in turn], dtype=np.float64),
        move_start=_starts([len(group) for group in moves]),
        move_column=np.array(move, dtype=np.int64),
        move_axis=np.array([columns[i].axis for i in move], dtype=np.int64),
        move_sign=np.array([columns[i].sign for i in move], dtype=np.float64),
        site_joint=np.array([site.joint for site in skeleton.end_sites], dtype=np.int64),
        site_offset=np.array([site.offset for site in skeleton.end_sites], dtype=np.float64).reshape(-1, 3),
        points=np.array(skeleton.points, dtype=np.int64),
    )


def world_from_joint(skeleton: Skeleton, X: FloatArray) -> FloatArray:
    """Return the pose of every joint in every frame as matrices (n_frames, n_joints, 4, 4), metres.

    `X` is (n_frames, n_columns) in radians and metres.
    """
    chain = chain_of(skeleton)
    X = np.asarray(X, dtype=np.float64)
    world = np.zeros((len(X), len(skeleton.joints), 4, 4))
    world[:, :, 3, 3] = 1.0
    for joint, parent in enumerate(chain.parent):
        rotation = np.broadcast_to(chain.orientation[joint], (len(X), 3, 3))
        for k in range(chain.turn_start[joint], chain.turn_start[joint + 1]):
            angle = chain.turn_sign[k] * X[:, chain.turn_column[k]]
            rotation = rotation @ axis_rotation(int(chain.turn_axis[k]), angle)
        offset = np.broadcast_to(chain.offset[joint], (len(X), 3)).copy()
        for k in range(chain.move_start[joint], chain.move_start[joint + 1]):
            offset[:, chain.move_axis[k]] += chain.move_sign[k] * X[:, chain.move_column[k]]
        if parent < 0:
            world[:, joint, :3, :3], world[:, joint, :3, 3] = rotation, offset
        else:
            outer = world[:, parent, :3, :3]
            world[:, joint, :3, :3] = outer @ rotation
            world[:, joint, :3, 3] = world[:, parent, :3, 3] + np.einsum("fij,fj->fi", outer, offset)
    return world


def node_positions(skeleton: Skeleton, X: FloatArray) -> FloatArray:
    """Return the positions of all nodes, joints then end sites, (n_frames, n_nodes, 3) in metres."""
    chain = chain_of(skeleton)
    world = world_from_joint(skeleton, X)
    frames = world[:, chain.site_joint]
    sites = np.einsum("fsij,sj->fsi", frames[..., :3, :3], chain.site_offset) + frames[..., :3, 3]
    return np.concatenate([world[:, :, :3, 3], sites], axis=1)


def point_positions(skeleton: Skeleton, X: FloatArray) -> FloatArray:
    """Return the positions of the measured points, (n_frames, n_points, 3) in metres."""
    return node_positions(skeleton, X)[:, chain_of(skeleton).points]


def rest_values(skeleton: Skeleton) -> FloatArray:
    """Return the row (n_columns,) that leaves every joint at rest."""
    return np.array([column.rest for column in skeleton.columns], dtype=np.float64)


def _starts(counts: list[int]) -> IntArray:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
