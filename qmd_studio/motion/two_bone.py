"""Two bones and a swivel: the closed-form way to put a wrist or an ankle in its place, for one arm or leg of one pose.

The middle joint (elbow, knee) bends about the one of its axes that changes the reach; its bend follows from the law of
cosines. The near joint (shoulder, hip) then turns the whole limb onto the line to the target, and about that line by
the swivel. No search, no limits: `solve_pose` of `motion/ik.py` is for the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import EditError
from qmd_studio.motion.fast_kinematics import world_from_joint_fast
from qmd_studio.motion.kinematics import chain_of
from qmd_studio.motion.rotation import axis_rotation
from qmd_studio.motion.skeleton import Skeleton

_NOTHING_M = 1e-9


@dataclass(frozen=True, slots=True)
class Limb:
    """Joint numbers of a limb: `near` turns about three axes, `middle` follows it and bends, `end` hangs from that."""

    near: int
    middle: int
    end: int


@dataclass(frozen=True, slots=True, eq=False)
class LimbSolution:
    """A pose (n_columns,) whose limb's end is `metres` away from its target; `within_limits` of its own columns."""

    pose: FloatArray
    metres: float
    within_limits: bool


def limb_of(skeleton: Skeleton, end: int) -> Limb:
    """Return the limb that ends in joint `end`: its parent bends, its parent's parent has three axes.

    Raises `EditError` where the joints above are not like that.
    """
    middle = skeleton.joints[end].parent if 0 <= end < len(skeleton.joints) else -1
    near = skeleton.joints[middle].parent if middle >= 0 else -1
    turns = skeleton.joints[near].product if near >= 0 else ()
    axes = {skeleton.columns[column].axis for column in turns}
    if len(turns) != 3 or len(axes) != 3 or not skeleton.joints[middle].product:
        raise EditError(
            "this is not the end of a limb", at=f"joint {end}", wanted="a joint below one that bends and one of 3 axes"
        )
    return Limb(near, middle, end)


def swivel_of(skeleton: Skeleton, pose: FloatArray, limb: Limb) -> float:
    """Return the angle in radians of the middle joint about the line from near to end; see `solve_limb`."""
    world = world_from_joint_fast(skeleton, np.asarray(pose, dtype=np.float64)[np.newaxis])[0]
    near, middle, end = (world[joint, :3, 3] for joint in (limb.near, limb.middle, limb.end))
    frame = _line_frame(end - near)
    across = frame.T @ (middle - near)
    return math.atan2(across[1], across[0])


def solve_limb(
    skeleton: Skeleton, pose: FloatArray, limb: Limb, target: FloatArray, *, swivel: float | None = None
) -> LimbSolution:
    """Return `pose` (n_columns,) with the limb's end at `target` (3,) metres, or as near to it as its bones reach.

    `swivel` turns the middle joint about the line from near joint to target, in radians: 0 towards the world's +z as
    far as that is across the line (towards +x where the line runs along z), growing by the right-hand rule. None keeps
    it as it is. Of the two ways to bend the one nearer to `pose` within its limits is taken. Raises `EditError` for a
    target that is not finite.
    """
    target = np.asarray(target, dtype=np.float64)
    if target.shape != (3,) or not np.isfinite(target).all():
        raise EditError("a target is no place", wanted="three finite metres", got=str(target))
    result = np.array(pose, dtype=np.float64)
    world = world_from_joint_fast(skeleton, result[np.newaxis])[0]
    if swivel is None:
        swivel = swivel_of(skeleton, result, limb)
    away = target - world[limb.near, :3, 3]
    column, angle = _bend(skeleton, result, limb, reach=float(np.linalg.norm(away)))
    result[column] = angle
    _turn_near(skeleton, result, limb, world=world, away=away, swivel=swivel)
    end = world_from_joint_fast(skeleton, result[np.newaxis])[0, limb.end, :3, 3]
    own = (column, *skeleton.joints[limb.near].product)
    return LimbSolution(result, float(np.linalg.norm(end - target)), all(_within(skeleton, c, result[c]) for c in own))


def _bend(skeleton: Skeleton, pose: FloatArray, limb: Limb, *, reach: float) -> tuple[int, float]:
    """Return the column that bends the limb and the angle at which its end is `reach` away from its near joint.

    With the upper bone u and the lower v seen from the hinge h, |u + R(h, a) v|² is p + q cos a + s sin a.
    """
    joint = skeleton.joints[limb.middle]
    offset = _offset(skeleton, pose, limb.end)
    best, frames = joint.product[0], (np.eye(3), np.eye(3))
    across = -1.0
    for place, column in enumerate(joint.product):
        before = np.array(joint.orientation) @ _turns(skeleton, pose, joint.product[:place])
        after = _turns(skeleton, pose, joint.product[place + 1 :])
        swing = float(np.linalg.norm(np.cross(np.eye(3)[skeleton.columns[column].axis], after @ offset)))
        if swing > across + _NOTHING_M:
            across, best, frames = swing, column, (before, after)
    hinge = np.eye(3)[skeleton.columns[best].axis] * skeleton.columns[best].sign
    u = frames[0].T @ _offset(skeleton, pose, limb.middle)
    v = frames[1] @ offset
    along = hinge * (hinge @ v)
    q, s = 2 * u @ (v - along), 2 * u @ np.cross(hinge, v)
    p = u @ u + v @ v + 2 * u @ along
    size = math.hypot(q, s)
    if size < _NOTHING_M**2:
        return best, float(pose[best])
    opening = math.acos(min(1.0, max(-1.0, (reach * reach - p) / size)))
    ways = [_nearest(math.atan2(s, q) + sign * opening, pose[best]) for sign in (1, -1)]
    return best, min(ways, key=lambda way: (not _within(skeleton, best, way), abs(way - pose[best])))


def _turn_near(
    skeleton: Skeleton, pose: FloatArray, limb: Limb, *, world: FloatArray, away: FloatArray, swivel: float
) -> None:
    """Set the near joint's three columns so that the bent limb lies along `away` with the middle at `swivel`."""
    near, middle = skeleton.joints[limb.near], skeleton.joints[limb.middle]
    upper = _offset(skeleton, pose, limb.middle)
    turn = np.array(middle.orientation) @ _turns(skeleton, pose, middle.product)
    whole = upper + turn @ _offset(skeleton, pose, limb.end)
    if np.linalg.norm(away) < _NOTHING_M or np.linalg.norm(whole) < _NOTHING_M:
        return
    aim = _line_frame(away)
    aim = aim @ axis_rotation(2, np.array(swivel))
    present = _plane_frame(whole, upper)
    outer = world[near.parent, :3, :3] if near.parent >= 0 else np.eye(3)
    wanted = np.array(near.orientation).T @ outer.T @ aim @ present.T
    angles = _three_angles(skeleton, near.product, wanted, pose)
    pose[list(near.product)] = angles


def _three_angles(skeleton: Skeleton, product: tuple[int, ...], turn: FloatArray, pose: FloatArray) -> FloatArray:
    """Return the angles (3,) whose product is `turn` (3, 3), of the two triples that within limits, else the nearer.

    With axes i, j, k and e = 1 where they run round as x y z do, R[i, k] = e sin(b) and so on round the matrix.
    """
    columns = [skeleton.columns[column] for column in product]
    i, j, k = (column.axis for column in columns)
    even = 1.0 if (j - i) % 3 == 1 else -1.0
    middle = math.asin(min(1.0, max(-1.0, even * turn[i, k])))
    if math.hypot(turn[i, i], turn[i, j]) > 1e-9:
        first = math.atan2(-even * turn[j, k], turn[k, k])
        last = math.atan2(-even * turn[i, j], turn[i, i])
    else:  # locked: the first and last axis coincide, and the last keeps its angle
        last = columns[2].sign * float(pose[product[2]])
        rest = turn @ axis_rotation(k, np.array(-last)) @ axis_rotation(j, np.array(-middle))
        first = math.atan2(even * rest[k, j], rest[j, j])
    ways = []
    for triple in ((first, middle, last), (first + math.pi, math.pi - middle, last + math.pi)):
        pairs = zip(columns, triple, product, strict=True)
        ways.append([_nearest(c.sign * angle, pose[number]) for c, angle, number in pairs])
    present = pose[list(product)]

    def rank(way: list[float]) -> tuple[bool, float]:
        inside = all(_within(skeleton, number, angle) for number, angle in zip(product, way, strict=True))
        return not inside, float(np.abs(np.array(way) - present).sum())

    return np.array(min(ways, key=rank))


def _turns(skeleton: Skeleton, pose: FloatArray, product: tuple[int, ...]) -> FloatArray:
    turn = np.eye(3)
    for column in product:
        angle = skeleton.columns[column].sign * pose[column]
        turn = turn @ axis_rotation(skeleton.columns[column].axis, np.array(angle))
    return turn


def _offset(skeleton: Skeleton, pose: FloatArray, joint: int) -> FloatArray:
    """Return where `joint` hangs in its parent's frame (3,), its own moves added."""
    chain = chain_of(skeleton)
    offset = chain.offset[joint].copy()
    for k in range(chain.move_start[joint], chain.move_start[joint + 1]):
        offset[chain.move_axis[k]] += chain.move_sign[k] * pose[chain.move_column[k]]
    return np.asarray(offset)


def _line_frame(line: FloatArray) -> FloatArray:
    """Return axes (3, 3) whose third runs along `line` and whose first is the way to +z, or to +x, across it."""
    return _plane_frame(line, np.eye(3)[2])


def _plane_frame(line: FloatArray, beside: FloatArray) -> FloatArray:
    """Return axes (3, 3) whose third runs along `line` and whose first points to `beside`."""
    length = float(np.linalg.norm(line))
    third = line / length if length > _NOTHING_M else np.eye(3)[1]
    for way in (beside, np.eye(3)[2], np.eye(3)[0]):
        across = way - third * (third @ way)
        if np.linalg.norm(across) > 1e-6 * max(float(np.linalg.norm(way)), _NOTHING_M):
            first = across / np.linalg.norm(across)
            break
    return np.stack([first, np.cross(third, first), third], axis=1)


def _nearest(angle: float, present: float) -> float:
    return angle + 2 * math.pi * round((present - angle) / (2 * math.pi))


def _within(skeleton: Skeleton, column: int, angle: float) -> bool:
    limits = skeleton.columns[column].limits
    return limits is None or limits[0] - 1e-9 <= angle <= limits[1] + 1e-9
