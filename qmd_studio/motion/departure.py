"""How far decodings of one motion stray from it: a search asks that thousands of times.

What decodings share, because they keep the same first columns exact, is computed once; of each decoding only the joints
that can stray are. The measures are those of `motion/metrics.py`. Importing this module imports numba.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from qmd_studio.arrays import BoolArray, Float32Array, IntArray
from qmd_studio.motion.departure_kernels import departure_kernel, pose_blocks
from qmd_studio.motion.fast_kinematics import Plan, plan_of, point_positions_32
from qmd_studio.motion.kinematic_kernels import BLOCK
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import Skeleton

_MOST_KNOWN = 1 << 24
"""Values of known poses that are kept, 64 MB; a motion that would need more is computed whole every time."""


@dataclass(frozen=True, slots=True)
class Distance:
    """Three of the measures of `MotionError`: DEF in ASF length units, the mean and the largest distance in mm."""

    def_: float
    mean_mm: float
    max_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What the first columns alone decide: joints that are `turned` and `placed` by them, targets that may stray yet.

    `squares` (n_frames,), `total` and `largest` (squared metres, metres, metres) sum up the other targets.
    """

    turned: BoolArray
    placed: BoolArray
    strays: BoolArray
    squares: Float32Array
    total: float
    largest: float


class Departure:
    """Measures decodings of one motion that all have the same first columns.

    `original` and `leading` are (n_columns, n_frames) float32 radians and metres: the motion, and what every decoding
    holds in those of its first columns that it keeps exact. It may be used from several threads.
    """

    def __init__(self, skeleton: Skeleton, original: Float32Array, leading: Float32Array) -> None:
        self._plan = plan_of(skeleton, "points", np.dtype(np.float32))
        self._arguments = self._plan.arguments()
        self._original = point_positions_32(skeleton, original)
        self._leading = point_positions_32(skeleton, leading)
        self._last_column, self._last_place = _last_columns(self._plan)
        n_joints, n_frames = len(self._plan.parent), original.shape[1]
        n_blocks = -(-n_frames // BLOCK)
        self._keeps = 12 * n_joints * BLOCK * n_blocks <= _MOST_KNOWN
        shape = (n_blocks if self._keeps else 0, n_joints)
        self._poses = (np.zeros((*shape, 9, BLOCK), np.float32), np.zeros((*shape, 3, BLOCK), np.float32))
        pose_blocks(leading, *self._poses, self._arguments)
        self._known = lru_cache(maxsize=256)(self._make_known)

    def measured(self, decoded: Float32Array, n_leading: int) -> Distance:
        """Measure `decoded` (n_columns, n_frames) radians and metres, whose first `n_leading` columns are the known."""
        known = self._known(n_leading)
        n_points, n_frames = len(self._plan.target_joint), decoded.shape[1]
        norm, total, largest = departure_kernel(
            decoded,
            self._original,
            self._poses,
            known.turned,
            known.placed,
            known.strays,
            known.squares,
            self._arguments,
        )
        return Distance(
            def_=norm / ASF_UNIT_M,
            mean_mm=1000 * (known.total + total) / (n_points * n_frames),
            max_mm=1000 * max(known.largest, largest),
        )

    def _make_known(self, n_leading: int) -> _Known:
        turned = (self._last_column < n_leading) & self._keeps
        placed = (self._last_place < n_leading) & self._keeps
        joint = self._plan.target_joint
        strays = ~np.where(self._plan.target_far, turned[joint] & placed[joint], placed[joint])
        apart = (self._leading - self._original).reshape(len(joint), 3, -1)[~strays]
        squares = (apart**2).sum(axis=1)
        distance = np.sqrt(squares)
        return _Known(
            turned,
            placed,
            strays,
            squares.sum(axis=0),
            float(distance.sum(dtype=np.float64)),
            float(distance.max(initial=0)),
        )


def _last_columns(plan: Plan) -> tuple[IntArray, IntArray]:
    """Return for each visited joint the last column (-1: none) that its rotation, and that its position depends on."""
    turned = np.full(len(plan.parent), -1, dtype=np.int64)
    placed = turned.copy()
    for j, parent in enumerate(plan.parent):
        turns = plan.turn_column[plan.turn_start[j] : plan.turn_start[j + 1]]
        moves = plan.move_column[plan.move_start[j] : plan.move_start[j + 1]]
        above, near = (turned[parent], placed[parent]) if parent >= 0 else (-1, -1)
        turned[j] = max(above, turns.max(initial=-1))
        placed[j] = max(above, near, moves.max(initial=-1))
    return turned, placed
