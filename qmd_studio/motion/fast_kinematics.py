"""Forward kinematics compiled with numba: many frames at once, or single poses for players.

It computes what `motion/kinematics.py` does. The values of one column, and of one coordinate of one point, lie
together. With angles up to 20 radians the float32 path stays within a hundredth of a millimetre of the float64 one;
past that the angle itself, held in float32, grows coarse. Importing this module imports numba.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import BoolArray, Float32Array, FloatArray, IntArray
from qmd_studio.motion.kinematic_kernels import pose_kernel, position_kernel
from qmd_studio.motion.kinematics import Chain, chain_of
from qmd_studio.motion.skeleton import Skeleton

_Real: TypeAlias = NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What a kernel is told, in the precision it works in; K visited joints in the order of the skeleton, T targets.

    `parent` (K,) counts visited joints. `turns` says whether a joint's rotation is needed by anything. `aligned` and
    `joined` mark the orientations that are the identity and the offsets that are zero. Target t is the position of
    visited joint `target_joint[t]`, or, if `target_far[t]`, of `target_offset[t]` in its frame.
    """

    parent: IntArray
    turns: BoolArray
    aligned: BoolArray
    joined: BoolArray
    orientation: _Real
    offset: _Real
    turn_start: IntArray
    turn_column: IntArray
    turn_axis: IntArray
    turn_sign: _Real
    move_start: IntArray
    move_column: IntArray
    move_axis: IntArray
    move_sign: _Real
    target_joint: IntArray
    target_far: BoolArray
    target_offset: _Real

    def arguments(self) -> tuple[NDArray[Any], ...]:
        """Return all arrays in the order in which the kernels take them."""
        return tuple(getattr(self, name) for name in self.__slots__)


def columns_first(X: FloatArray) -> Float32Array:
    """Return X (n_frames, n_columns) as float32 (n_columns, n_frames), the form that the float32 path takes."""
    return np.ascontiguousarray(np.asarray(X).T, dtype=np.float32)


def node_positions_32(skeleton: Skeleton, Xt: Float32Array) -> Float32Array:
    """Return the positions of all nodes, joints then end sites, (3 * n_nodes, n_frames) metres: x, y, z of node 0, ….

    `Xt` is (n_columns, n_frames) in radians and metres.
    """
    return _positions(plan_of(skeleton, "nodes", np.dtype(np.float32)), Xt)


def point_positions_32(skeleton: Skeleton, Xt: Float32Array) -> Float32Array:
    """Return the positions of the measured points, (3 * n_points, n_frames) metres; joints beyond them cost nothing.

    `Xt` is (n_columns, n_frames) in radians and metres.
    """
    return _positions(plan_of(skeleton, "points", np.dtype(np.float32)), Xt)


def point_positions_64(skeleton: Skeleton, X: FloatArray) -> FloatArray:
    """Return the positions of the measured points, (n_frames, n_points, 3) metres, in double precision.

    `X` is (n_frames, n_columns) in radians and metres.
    """
    Xt = np.ascontiguousarray(np.asarray(X, dtype=np.float64).T)
    rows = _positions(plan_of(skeleton, "points", np.dtype(np.float64)), Xt)
    return np.ascontiguousarray(rows.T).reshape(len(X), -1, 3)


def world_from_joint_fast(skeleton: Skeleton, X: FloatArray) -> FloatArray:
    """Return the pose of every joint as matrices (n_frames, n_joints, 4, 4), metres; made for one frame at a time.

    `X` is (n_frames, n_columns) in radians and metres.
    """
    chain = chain_of(skeleton)
    world = np.empty((len(X), len(skeleton.joints), 4, 4))
    pose_kernel(
        np.ascontiguousarray(X, dtype=np.float64),
        chain.parent,
        chain.orientation,
        chain.offset,
        chain.turn_start,
        chain.turn_column,
        chain.turn_axis,
        chain.turn_sign,
        chain.move_start,
        chain.move_column,
        chain.move_axis,
        chain.move_sign,
        world,
    )
    return world


def _positions(plan: Plan, Xt: NDArray[Any]) -> NDArray[Any]:
    rows = np.ascontiguousarray(Xt, dtype=plan.offset.dtype)
    positions = np.empty((3 * len(plan.target_joint), rows.shape[1]), dtype=rows.dtype)
    position_kernel(rows, positions, *plan.arguments())
    return positions


@lru_cache(maxsize=64)
def plan_of(skeleton: Skeleton, targets: str, dtype: np.dtype[np.floating[Any]]) -> Plan:
    """Return the plan for all "nodes" or only the "points", leaving out joints that no target depends on."""
    chain = chain_of(skeleton)
    n_joints = len(chain.parent)
    nodes = np.arange(skeleton.n_nodes) if targets == "nodes" else chain.points
    far = nodes >= n_joints
    target_joint = nodes.copy()
    target_joint[far] = chain.site_joint[nodes[far] - n_joints]
    target_offset = np.zeros((len(nodes), 3))
    target_offset[far] = chain.site_offset[nodes[far] - n_joints]
    visited, turning = _needed(chain, target_joint, far)
    kept = np.flatnonzero(visited)
    number = np.cumsum(visited) - 1
    turn_rows, turn_start = _rows_of(chain.turn_start, kept)
    move_rows, move_start = _rows_of(chain.move_start, kept)
    return Plan(
        parent=np.where(chain.parent[kept] >= 0, number[chain.parent[kept]], -1),
        turns=turning[kept],
        aligned=(chain.orientation[kept] == np.eye(3)).all(axis=(1, 2)),
        joined=(chain.offset[kept] == 0).all(axis=1),
        orientation=chain.orientation[kept].astype(dtype),
        offset=chain.offset[kept].astype(dtype),
        turn_start=turn_start,
        turn_column=chain.turn_column[turn_rows],
        turn_axis=chain.turn_axis[turn_rows],
        turn_sign=chain.turn_sign[turn_rows].astype(dtype),
        move_start=move_start,
        move_column=chain.move_column[move_rows],
        move_axis=chain.move_axis[move_rows],
        move_sign=chain.move_sign[move_rows].astype(dtype),
        target_joint=number[target_joint],
        target_far=far,
        target_offset=target_offset.astype(dtype),
    )


def _needed(chain: Chain, target_joint: IntArray, far: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Return which joints' positions (J,) and which joints' rotations (J,) the targets depend on."""
    visited = np.zeros(len(chain.parent), dtype=np.bool_)
    turning = visited.copy()
    visited[target_joint] = True
    turning[target_joint[far]] = True
    for joint in range(len(chain.parent) - 1, -1, -1):
        parent = chain.parent[joint]
        if visited[joint] and parent >= 0:
            visited[parent] = turning[parent] = True
    return visited, turning


def _rows_of(start: IntArray, joints: IntArray) -> tuple[IntArray, IntArray]:
    """Return the rows that belong to `joints` in a ragged table, and where each joint's then start."""
    rows = [np.arange(start[joint], start[joint + 1]) for joint in joints]
    starts = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    return np.concatenate([np.zeros(0, dtype=np.int64), *rows]).astype(np.int64), starts
