"""What inverse kinematics is asked for: nodes and where they shall be, and how far a pose is from that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.errors import EditError
from qmd_studio.motion.fast_kinematics import world_from_joint_fast
from qmd_studio.motion.ik_kernels import node_jacobian_kernel
from qmd_studio.motion.kinematics import chain_of
from qmd_studio.motion.skeleton import LARGEST, Skeleton

PIN_WEIGHT = 100.0
"""The weight of a node that shall stay while others are pulled: it gives way a ten thousandth as far."""

_ORTHOGONAL_WITHIN = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Effector:
    """A node of the skeleton, joint or end site, and where it shall be in the world.

    `position` (3,) metres; `orientation` (3, 3) the rotation from the node's joint to the world; either may be None,
    not both. A miss costs half its square: (weight · metres)², (orientation_weight · radians)², so that
    `orientation_weight` is in metres a radian.
    """

    node: int
    position: FloatArray | None = None
    orientation: FloatArray | None = None
    weight: float = 1.0
    orientation_weight: float = 0.1


def pinned(skeleton: Skeleton, pose: FloatArray, node: int, *, turning: bool = True) -> Effector:
    """Return the effector that holds a node where `pose` (n_columns,) has it, and unless `turning` its orientation."""
    world = world_from_joint_fast(skeleton, np.asarray(pose, dtype=np.float64)[np.newaxis])[0]
    joint, offset = _joint_and_offset(skeleton, node)
    place = world[joint, :3, :3] @ offset + world[joint, :3, 3]
    held = None if turning else world[joint, :3, :3].copy()
    return Effector(node, place, held, weight=PIN_WEIGHT, orientation_weight=0.1 * PIN_WEIGHT)


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """Effectors as arrays: E nodes, each with its joint and the offset in that joint's frame, and what it shall reach.

    `placed` and `aimed` list the effectors with a position and with an orientation.
    """

    skeleton: Skeleton
    node_joint: IntArray
    node_offset: FloatArray
    placed: IntArray
    position: FloatArray
    weight: FloatArray
    aimed: IntArray
    orientation: FloatArray
    orientation_weight: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Misses:
    """How far a pose misses: `residual` (R,) weighted metres, its `jacobian` (R, M), `metres` and `radians` (E,).

    `force` (P, 3) is the gradient of half the sum by the place of each placed node, which the columns move by `moved`
    and turn by `turned` (P, 3, M).
    """

    residual: FloatArray
    jacobian: FloatArray
    force: FloatArray
    moved: FloatArray
    turned: FloatArray
    metres: FloatArray
    radians: FloatArray


def targets_of(skeleton: Skeleton, effectors: Sequence[Effector]) -> Targets:
    """Return the effectors as arrays. Raises `EditError` for a node, target or weight that cannot be."""
    if not effectors:
        raise EditError("nothing is pulled", wanted="at least one effector")
    for effector in effectors:
        _check(skeleton, effector)
    hung = [_joint_and_offset(skeleton, effector.node) for effector in effectors]
    placed = [i for i, effector in enumerate(effectors) if effector.position is not None]
    aimed = [i for i, effector in enumerate(effectors) if effector.orientation is not None]
    return Targets(
        skeleton,
        node_joint=np.array([joint for joint, _ in hung], dtype=np.int64),
        node_offset=np.array([offset for _, offset in hung], dtype=np.float64).reshape(-1, 3),
        placed=np.array(placed, dtype=np.int64),
        position=np.array([effectors[i].position for i in placed], dtype=np.float64).reshape(-1, 3),
        weight=np.array([effectors[i].weight for i in placed], dtype=np.float64),
        aimed=np.array(aimed, dtype=np.int64),
        orientation=np.array([effectors[i].orientation for i in aimed], dtype=np.float64).reshape(-1, 3, 3),
        orientation_weight=np.array([effectors[i].orientation_weight for i in aimed], dtype=np.float64),
    )


def misses_of(targets: Targets, pose: FloatArray) -> Misses:
    """Return how far `pose` (M,) radians and metres misses the targets, and how that changes with each column."""
    skeleton = targets.skeleton
    chain = chain_of(skeleton)
    world = world_from_joint_fast(skeleton, pose[np.newaxis])[0]
    frames = world[targets.node_joint]
    place = np.einsum("eij,ej->ei", frames[:, :3, :3], targets.node_offset) + frames[:, :3, 3]
    moved = np.zeros((len(place), 3, skeleton.n_columns))
    turned = np.zeros_like(moved)
    node_jacobian_kernel(
        pose,
        world,
        targets.node_joint,
        place,
        chain.parent,
        chain.orientation,
        chain.turn_start,
        chain.turn_column,
        chain.turn_axis,
        chain.turn_sign,
        chain.move_start,
        chain.move_column,
        chain.move_axis,
        chain.move_sign,
        moved,
        turned,
    )
    metres, radians = np.zeros(len(place)), np.zeros(len(place))
    off = place[targets.placed] - targets.position
    metres[targets.placed] = np.linalg.norm(off, axis=1)
    residual = (off * targets.weight[:, None]).ravel()
    jacobian = (moved[targets.placed] * targets.weight[:, None, None]).reshape(len(residual), skeleton.n_columns)
    if len(targets.aimed):
        vectors, change = _turn_vectors(frames[targets.aimed, :3, :3], targets.orientation)
        radians[targets.aimed] = np.linalg.norm(vectors, axis=1)
        turns = (change @ turned[targets.aimed]) * targets.orientation_weight[:, None, None]
        residual = np.concatenate([residual, (vectors * targets.orientation_weight[:, None]).ravel()])
        jacobian = np.concatenate([jacobian, turns.reshape(vectors.size, skeleton.n_columns)])
    force = off * targets.weight[:, None] ** 2
    return Misses(residual, jacobian, force, moved[targets.placed], turned[targets.placed], metres, radians)


def bend_of(targets: Targets, misses: Misses) -> FloatArray:
    """Return what the curved paths of the placed nodes add to JᵀJ, (M, M): the sum of force · second derivative.

    Where column i stands before column j on the way from the root, the second derivative of a node's place is the
    axis of i × what j moves. Orientations are left out.
    """
    order = _outward(targets.skeleton)
    bend = np.zeros((len(order), len(order)))
    for force, moved, turned in zip(misses.force, misses.moved[..., order], misses.turned[..., order], strict=True):
        bend += np.cross(force, turned, axisb=0) @ moved
    upper = np.triu(bend)
    back = np.argsort(order)
    return (upper + np.triu(bend, 1).T)[np.ix_(back, back)]


@lru_cache(maxsize=16)
def _outward(skeleton: Skeleton) -> IntArray:
    """Return the columns from the root outward: by joint, moves before turns, turns as they multiply."""
    place = {column: k for joint in skeleton.joints for k, column in enumerate(joint.product)}
    keys = [(column.joint, place.get(index, -1)) for index, column in enumerate(skeleton.columns)]
    return np.array(sorted(range(len(keys)), key=keys.__getitem__), dtype=np.int64)


def _turn_vectors(present: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the rotation vectors (n, 3) from wanted to present, and their rate (n, 3, 3) by the angular velocity.

    With R = exp(v), dv = (1 - [v]/2 + (1/t² - cot(t/2)/2t) [v]²) ω for the turn t = |v| (Bullo and Murray 1995).
    """
    turn = present @ np.swapaxes(wanted, 1, 2)
    skew = np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    vectors = np.array([_turn_vector(t, s) for t, s in zip(turn, skew, strict=True)]).reshape(-1, 3)
    angle = np.linalg.norm(vectors, axis=1)
    safe = np.maximum(angle, 1e-4)
    factor = np.where(angle > 1e-4, 1 / safe**2 - 1 / (2 * safe * np.tan(safe / 2)), 1 / 12)
    cross = np.zeros((len(vectors), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -vectors[:, 2], vectors[:, 1], -vectors[:, 0]
    cross -= np.swapaxes(cross, 1, 2)
    return vectors, np.eye(3) - cross / 2 + factor[:, None, None] * (cross @ cross)


def _turn_vector(turn: FloatArray, skew: FloatArray) -> FloatArray:
    """Return the rotation vector (3,) of a matrix; of half a turn the axis is found from its symmetric part."""
    sine = float(np.linalg.norm(skew)) / 2
    cosine = (float(np.trace(turn)) - 1) / 2
    angle = float(np.arctan2(sine, cosine))
    if sine > 1e-6:
        return np.asarray(skew * (angle / (2 * sine)))
    if cosine > 0:
        return np.asarray(skew / 2)
    outer = (turn + np.eye(3)) / 2
    column = outer[:, int(np.argmax(np.diagonal(outer)))]
    return np.asarray(angle * column / np.linalg.norm(column))


def _joint_and_offset(skeleton: Skeleton, node: int) -> tuple[int, FloatArray]:
    if node < len(skeleton.joints):
        return node, np.zeros(3)
    site = skeleton.end_sites[node - len(skeleton.joints)]
    return site.joint, np.array(site.offset)


def _check(skeleton: Skeleton, effector: Effector) -> None:
    if not 0 <= effector.node < skeleton.n_nodes:
        raise EditError("no such node", at=f"node {effector.node}", wanted=f"0 to {skeleton.n_nodes - 1}")
    at = f"effector {skeleton.node_names[effector.node]!r}"
    if effector.position is None and effector.orientation is None:
        raise EditError("an effector has no target", at=at, wanted="a position or an orientation")
    if effector.position is not None:
        position = np.asarray(effector.position, dtype=np.float64)
        if position.shape != (3,) or not (np.abs(position) <= LARGEST).all():
            raise EditError("a target is no place", at=at, wanted="three finite metres", got=str(effector.position))
    if effector.orientation is not None:
        turn = np.asarray(effector.orientation, dtype=np.float64)
        good = turn.shape == (3, 3) and np.isfinite(turn).all()
        if not good or not np.allclose(turn @ turn.T, np.eye(3), atol=_ORTHOGONAL_WITHIN) or np.linalg.det(turn) < 0:
            raise EditError("a target is no orientation", at=at, wanted="a rotation matrix", got=str(turn.tolist()))
    for weight in (effector.weight, effector.orientation_weight):
        if not 0 < weight < 1e6:
            raise EditError("a weight cannot be used", at=at, wanted="above 0, below 1e6", got=f"{weight:g}")
