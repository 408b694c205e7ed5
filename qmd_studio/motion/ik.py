"""Inverse kinematics by damped least squares: one pose that brings several nodes to where they shall be.

Least is the sum over effectors of (weight · miss)² plus, much fainter, pull² · (stiffness · (value - pulled to))² over
columns, within the columns' limits. So of all poses that reach the targets the one nearest to the pose before is taken,
and of targets out of reach the nearest that can be reached. Each step is that of Levenberg and Marquardt, the damping
led by how well the last step was foreseen (Nielsen 1999), with the limits kept inside the step (`motion/ik_step.py`);
where a few of them are not enough, as out of reach, the curvature of the nodes' paths is taken in, which makes it
Newton's.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray, IntArray
from qmd_studio.errors import EditError
from qmd_studio.motion.ik_step import Model, bounded_step
from qmd_studio.motion.ik_targets import Effector, Misses, Targets, bend_of, misses_of, targets_of
from qmd_studio.motion.skeleton import LARGEST, ColumnKind, Skeleton

LONGEST_STEP = 0.5
"""No column turns further than this in one step, in radians, so that a far target does not spin a joint round."""

_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-8, 1e-12, 1e6
_PROMISE_ENOUGH = 1e-11
_PROMISED_SHARE = 1e-7
"""A step that promises less than this, in square metres and as a share of half the sum, ends the search."""

_STRAIGHT_STEPS, _NEARLY_REACHED_M = 6, 1e-3
"""So many steps, and all from misses as small as this, take the paths of the nodes for straight, which costs little."""

_SPINE = re.compile(r"vl\d|vt\d+|vc\d|sacroiliac|skullbase|(lower|upper)?(back|neck)|thorax|chest\d*|spine\d*|neck\d*")


@dataclass(frozen=True, slots=True, eq=False)
class IkSettings:
    """What may move, and how readily.

    `active` (n_columns,) marks the columns that may change, all if None; opaque ones never do. With `root_free` off the
    columns of the roots stay as well. `stiffness` (n_columns,), 1 if None: how much each column holds against the pull,
    0 not at all. `pull_to` (n_columns,) is the pose that free columns are drawn to, the starting pose if None, with the
    strength `pull` in metres a radian: at 0.002 a target is missed by some hundredths of a millimetre for it. Lengths
    count as angles there.
    """

    active: BoolArray | None = None
    root_free: bool = True
    stiffness: FloatArray | None = None
    pull_to: FloatArray | None = None
    pull: float = 2e-3
    max_iterations: int = 30
    tolerance_m: float = 1e-4
    tolerance_rad: float = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class IkSolution:
    """A pose (n_columns,) radians and metres, and how well it does.

    `metres` and `radians` (n_effectors,) are what is missed of each position and orientation, 0 where none is wanted;
    `reached` says that all are within the tolerances. `cost` is half the sum that was made least.
    """

    pose: FloatArray
    metres: FloatArray
    radians: FloatArray
    reached: bool
    iterations: int
    cost: float


_DEFAULTS = IkSettings()


def solve_pose(
    skeleton: Skeleton, start: FloatArray, effectors: Sequence[Effector], settings: IkSettings = _DEFAULTS
) -> IkSolution:
    """Return the pose nearest to `start` (n_columns,) that brings the effectors where they shall be, or near that.

    Active columns end within their limits, also where `start` is not; all others keep the value they have. To follow a
    drag, give the last solution as the next start. Raises `EditError` for a target, pose or setting that cannot be
    used, and where no column may move.
    """
    targets = targets_of(skeleton, effectors)
    search = _search_of(skeleton, start, settings)
    pose, misses, iterations = _descend(targets, search, settings.max_iterations)
    reached = (misses.metres <= settings.tolerance_m).all() and (misses.radians <= settings.tolerance_rad).all()
    return IkSolution(pose, misses.metres, misses.radians, bool(reached), iterations, _cost(search, pose, misses))


def spine_stiffness(skeleton: Skeleton, factor: float) -> FloatArray:
    """Return a stiffness (n_columns,) of `factor` for joints named as of the spine or neck, of 1 for all others."""
    spine = [_SPINE.fullmatch(joint.name.rpartition(":")[2].lower()) is not None for joint in skeleton.joints]
    return np.array([factor if spine[column.joint] else 1.0 for column in skeleton.columns], dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """What the descent works on: the first pose, and of its n active columns limits, springs and where they rest."""

    pose: FloatArray
    columns: IntArray
    lowest: FloatArray
    highest: FloatArray
    spring: FloatArray
    rest: FloatArray
    turning: BoolArray


def _descend(targets: Targets, search: _Search, max_iterations: int) -> tuple[FloatArray, Misses, int]:
    pose, damping, growth = search.pose, _FIRST_DAMPING, 2.0
    misses = misses_of(targets, pose)
    cost, taken = _cost(search, pose, misses), 0
    for iteration in range(max_iterations):
        bent = taken >= _STRAIGHT_STEPS and float(np.linalg.norm(misses.residual)) > _NEARLY_REACHED_M
        model = _model(targets, search, pose, misses, bent=bent)
        step = bounded_step(model, damping)
        if step is not None:
            step = _short(search, step)
            promise = model.promise(step)
            if 0 <= promise < _PROMISE_ENOUGH + _PROMISED_SHARE * cost:
                return pose, misses, iteration
            trial = pose.copy()
            trial[search.columns] = np.clip(pose[search.columns] + step, search.lowest, search.highest)
            there = misses_of(targets, trial)
            gain = (cost - _cost(search, trial, there)) / promise if promise > 0 else -1.0
            if gain > 0:
                pose, misses, cost = trial, there, _cost(search, trial, there)
                damping = max(damping * max(1 / 3, 1 - (2 * gain - 1) ** 3), _LEAST_DAMPING)
                growth, taken = 2.0, taken + 1
                continue
        damping, growth = damping * growth, growth * 4
        if damping > _MOST_DAMPING:
            return pose, misses, iteration + 1
    return pose, misses, max_iterations


def _model(targets: Targets, search: _Search, pose: FloatArray, misses: Misses, *, bent: bool) -> Model:
    values = pose[search.columns]
    return Model(
        residual=misses.residual,
        jacobian=misses.jacobian[:, search.columns],
        pull=search.spring * (values - search.rest),
        stiffness=search.spring,
        bend=bend_of(targets, misses)[np.ix_(search.columns, search.columns)] if bent else None,
        room=(search.lowest - values, search.highest - values),
    )


def _short(search: _Search, step: FloatArray) -> FloatArray:
    furthest = float(np.abs(step[search.turning]).max(initial=0.0))
    return step if furthest <= LONGEST_STEP else step * (LONGEST_STEP / furthest)


def _cost(search: _Search, pose: FloatArray, misses: Misses) -> float:
    away = pose[search.columns] - search.rest
    return float(misses.residual @ misses.residual + search.spring @ (away * away)) / 2


def _search_of(skeleton: Skeleton, start: FloatArray, settings: IkSettings) -> _Search:
    pose = _row(skeleton, start, "the starting pose").copy()
    stiffness = _row(
        skeleton, np.ones(len(pose)) if settings.stiffness is None else settings.stiffness, "the stiffness"
    )
    pull_to = pose if settings.pull_to is None else _row(skeleton, settings.pull_to, "the pose that is pulled to")
    if (stiffness < 0).any() or not 0 <= settings.pull <= 1:
        got = f"a pull of {settings.pull:g}, stiffness from {stiffness.min():g}"
        raise EditError("the pull cannot be used", wanted="a pull of 0 to 1 and no stiffness below 0", got=got)
    columns = np.flatnonzero(_may_move(skeleton, settings))
    if not len(columns):
        raise EditError("no column may move", wanted="at least one active rotation or translation")
    limits = np.array([skeleton.columns[c].limits or (-LARGEST, LARGEST) for c in columns], dtype=np.float64)
    rest = pull_to[columns].copy()
    pose[columns] = np.clip(pose[columns], limits[:, 0], limits[:, 1])
    turning = np.array([skeleton.columns[c].kind is ColumnKind.ROTATION for c in columns], dtype=np.bool_)
    spring = (settings.pull * stiffness[columns]) ** 2
    return _Search(pose, columns, limits[:, 0], limits[:, 1], spring, rest, turning)


def _may_move(skeleton: Skeleton, settings: IkSettings) -> BoolArray:
    moves = np.array([column.kind is not ColumnKind.OPAQUE for column in skeleton.columns], dtype=np.bool_)
    if not settings.root_free:
        moves &= np.array([skeleton.joints[column.joint].parent >= 0 for column in skeleton.columns], dtype=np.bool_)
    if settings.active is not None:
        active = np.asarray(settings.active, dtype=np.bool_)
        if active.shape != moves.shape:
            raise EditError(
                "the active columns do not fit the skeleton", wanted=str(moves.shape), got=str(active.shape)
            )
        moves &= active
    return moves


def _row(skeleton: Skeleton, values: FloatArray, what: str) -> FloatArray:
    row = np.ascontiguousarray(values, dtype=np.float64)
    if row.shape != (skeleton.n_columns,):
        raise EditError(f"{what} does not fit the skeleton", wanted=f"({skeleton.n_columns},)", got=str(row.shape))
    opaque = np.array([column.kind is ColumnKind.OPAQUE for column in skeleton.columns], dtype=np.bool_)
    if not (opaque | (np.abs(row) <= LARGEST)).all():
        raise EditError(
            f"{what} holds a value that is not a number or too large", wanted=f"at most {LARGEST:g} in size"
        )
    return row
