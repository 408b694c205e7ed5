"""Anatomical limits on an H-Anim body of free joints, as most files hold: the body animation parameters' own.

A joint's turn is taken apart in the order of its parameters, and each angle is held against that parameter's limits. A
joint that stands for several of the standard, as one vertebra for five, may turn as far as they do together. An axis
about which no parameter turns is free: nothing is known about it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.motion.as_euler import euler_zyx
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.hanim_names import canonical_joint
from qmd_studio.motion.rotation import euler_matrix
from qmd_studio.motion.skeleton import IDENTITY, ColumnKind, Skeleton

_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class LimitedJoint:
    """A joint, its columns z, y, x, its parameters' axes, leftmost first, and limits (3,) of angles about them."""

    joint: int
    product: tuple[int, ...]
    axes: tuple[int, int, int]
    low: FloatArray
    high: FloatArray

    @property
    def n_limited(self) -> int:
        """How many of the three angles have limits."""
        return int(np.isfinite(self.low).sum())


def limited_joints(skeleton: Skeleton) -> tuple[LimitedJoint, ...]:
    """Return the joints with H-Anim's names that turn freely, none where the skeleton has limits of its own."""
    if any(column.limits is not None for column in skeleton.columns):
        return ()
    standard = bap_skeleton()
    number = {canonical_joint(joint.name): k for k, joint in enumerate(standard.joints)}
    stands_for = _stands_for(standard, {number.get(canonical_joint(joint.name), -1) for joint in skeleton.joints})
    found = []
    for j, joint in enumerate(skeleton.joints):
        own = number.get(canonical_joint(joint.name))
        if own is None or joint.parent < 0 or joint.orientation != IDENTITY or not _is_free(skeleton, joint.product):
            continue
        listed = [standard.columns[c].axis for c in standard.joints[own].product]
        order = [*listed, *(axis for axis in (2, 1, 0) if axis not in listed)]
        axes = (order[0], order[1], order[2])
        low, high = _sums(standard, stands_for[own], axes)
        if np.isfinite(low).any():
            found.append(LimitedJoint(j, joint.product, axes, low, high))
    return tuple(found)


def beyond_limits(limited: LimitedJoint, X: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Return which of a joint's three angles (n_frames, 3) lie outside, and X's columns (n_frames, 3) brought back."""
    turns = euler_matrix(X[:, list(limited.product)], "zyx")
    angles = _nearest_way(turns, limited)
    outside = (angles < limited.low - _ROUNDING) | (angles > limited.high + _ROUNDING)
    frames = outside.any(axis=1)
    if not frames.any():
        return outside, X[:, list(limited.product)]
    order = "".join("xyz"[axis] for axis in limited.axes)
    turns[frames] = euler_matrix(np.clip(angles[frames], limited.low, limited.high), order)
    return outside, euler_zyx(turns)


def _stands_for(standard: Skeleton, present: set[int]) -> list[list[int]]:
    """Return for each joint itself and those below it that are missing, down to joints that are there.

    A neck that is missing whole counts with the head, which alone then turns.
    """
    leads_on = [joint in present for joint in range(len(standard.joints))]
    for joint in range(len(standard.joints) - 1, 0, -1):
        parent = standard.joints[joint].parent
        leads_on[parent] = leads_on[parent] or leads_on[joint]
    owner = list(range(len(standard.joints)))
    result: list[list[int]] = [[joint] for joint in owner]
    for joint, row in enumerate(standard.joints):
        if joint not in present and row.parent >= 0 and leads_on[joint]:
            owner[joint] = owner[row.parent]
            result[owner[joint]].append(joint)
    head = next(k for k, joint in enumerate(standard.joints) if joint.name == "skullbase")
    neck = [k for k, joint in enumerate(standard.joints) if joint.name.startswith("vc")]
    if head in present and not present.intersection(neck):
        result = [[k for k in joints if k not in neck] for joints in result]
        result[head] += neck
    return result


def _sums(standard: Skeleton, joints: list[int], axes: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:
    low, high = np.zeros(3), np.zeros(3)
    known = np.zeros(3, dtype=np.bool_)
    for joint in joints:
        for column in (standard.columns[c] for c in standard.joints[joint].product):
            place = axes.index(column.axis)
            if column.limits is not None:
                least, most = sorted(column.sign * limit for limit in column.limits)
                low[place], high[place], known[place] = low[place] + least, high[place] + most, True
    return np.where(known, low, -np.inf), np.where(known, high, np.inf)


def _is_free(skeleton: Skeleton, product: tuple[int, ...]) -> bool:
    columns = [skeleton.columns[c] for c in product]
    plain = all(c.kind is ColumnKind.ROTATION and c.sign == 1 for c in columns)
    return plain and [c.axis for c in columns] == [2, 1, 0]


def _nearest_way(turns: FloatArray, limited: LimitedJoint) -> FloatArray:
    """Return angles (n_frames, 3) about the joint's axes: of the two triples the one that lies less far outside.

    With axes i, j, k and e = 1 where they run round as x y z do, R[i, k] = e sin(b) and so on round the matrix.
    """
    i, j, k = limited.axes
    even = 1.0 if (j - i) % 3 == 1 else -1.0
    middle = np.arcsin(np.clip(even * turns[:, i, k], -1.0, 1.0))
    locked = np.hypot(turns[:, i, i], turns[:, i, j]) < _ROUNDING
    straight = np.arctan2(even * turns[:, k, j], turns[:, j, j])
    first = np.where(locked, straight, np.arctan2(-even * turns[:, j, k], turns[:, k, k]))
    last = np.where(locked, 0.0, np.arctan2(-even * turns[:, i, j], turns[:, i, i]))
    bounded = np.isfinite(limited.low)
    centre = np.where(bounded, (np.where(bounded, limited.low, 0) + np.where(bounded, limited.high, 0)) / 2, 0.0)
    ways, costs = [], []
    for triple in ((first, middle, last), (first + np.pi, np.pi - middle, last + np.pi)):
        angles = np.stack(triple, axis=1)
        angles = angles - 2 * np.pi * np.round((angles - centre) / (2 * np.pi))
        outside = np.maximum(limited.low - angles, 0) + np.maximum(angles - limited.high, 0)
        ways.append(angles)
        outside = np.where(bounded, outside, np.abs(angles))  # a free axis does not take up what the others must not
        costs.append(outside.sum(axis=1) + 1e-6 * np.abs(angles).sum(axis=1))
    return np.where((costs[1] < costs[0])[:, None], ways[1], ways[0])
