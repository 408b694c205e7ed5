"""Which joints each point of a skin follows, and how much: skinCoordIndex and skinCoordWeight of the joints.

What the weights of a point leave below 1 stays at rest with the figure: v' = v + sum of w (M v - v).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.formats.hanim_figure import Figure
from qmd_studio.formats.hanim_view import View, integers, numbers

_ROUNDING = 1e-4
MAX_INFLUENCES = 16
"""So many joints a point may follow; real skins have up to 10."""


@dataclass(frozen=True, slots=True, eq=False)
class Binding:
    """Joints (n, K) and weights (n, K) that sum to 1, strongest first; joint number J is the figure itself."""

    joints: IntArray
    weights: FloatArray


def skin_binding(view: View, figure: Figure, n_points: int) -> Binding:
    """Return what each of the skin's points follows; what is wrong with the weights is a warning."""
    point, joint, weight = _strongest(view, figure, *_entries(view, figure, n_points))
    joints, weights = _rows(point, joint, weight, n_points)
    total = weights.sum(axis=1)
    over = int((total > 1 + _ROUNDING).sum())
    if over:
        view.warn(figure.humanoid, f"the weights of {over} points of the skin sum to more than 1; they are scaled to 1")
        weights /= np.where(total > 1 + _ROUNDING, total, 1.0)[:, None]
    rest = np.where(total < 1 - _ROUNDING, 1 - total, 0.0)
    loose = int((total == 0).sum())
    if loose:
        view.warn(figure.humanoid, f"{loose} points of the skin follow no joint; they stay at rest with the figure")
    partly = int(np.count_nonzero(rest)) - loose
    if partly:
        view.warn(
            figure.humanoid, f"the weights of {partly} points of the skin sum to less than 1; the rest stays still"
        )
    if loose or partly:
        joints, weights = _with_rest(joints, weights, rest, len(figure.joints))
    return Binding(joints, weights)


def _strongest(
    view: View, figure: Figure, point: IntArray, joint: IntArray, weight: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the entries, sorted by point, without the weakest of points that follow too many joints."""
    counts = np.bincount(point)
    crowded = int((counts > MAX_INFLUENCES).sum())
    if not crowded:
        return point, joint, weight
    view.warn(
        figure.humanoid, f"{crowded} points of the skin follow over {MAX_INFLUENCES} joints; the strongest are kept"
    )
    order = np.lexsort((-weight, point))
    point, joint, weight = point[order], joint[order], weight[order]
    kept = np.arange(len(point)) - np.repeat(np.cumsum(counts) - counts, counts) < MAX_INFLUENCES
    before = np.bincount(point, weight)
    point, joint, weight = point[kept], joint[kept], weight[kept]
    after = np.maximum(np.bincount(point, weight, minlength=len(before)), 1e-30)
    return point, joint, weight * (before / after)[point]


def _rows(point: IntArray, joint: IntArray, weight: FloatArray, n_points: int) -> tuple[IntArray, FloatArray]:
    """Return joints and weights (n_points, K) of entries sorted by point, strongest first, then 0."""
    counts = np.bincount(point, minlength=n_points)
    rank = np.arange(len(point)) - np.repeat(np.cumsum(counts) - counts, counts)
    width = max(1, int(counts.max(initial=0)))
    joints, weights = np.zeros((n_points, width), dtype=np.int64), np.zeros((n_points, width))
    joints[point, rank], weights[point, rank] = joint, weight
    strongest = np.argsort(-weights, axis=1, kind="stable")
    return np.take_along_axis(joints, strongest, 1), np.take_along_axis(weights, strongest, 1)


def _with_rest(joints: IntArray, weights: FloatArray, rest: FloatArray, figure: int) -> tuple[IntArray, FloatArray]:
    """Let the figure itself, as joint number `figure`, have what the weights leave, after the joints of each point."""
    width = int(((weights > 0).sum(axis=1) + (rest > 0)).max())
    more = max(0, width - joints.shape[1])
    joints, weights = np.pad(joints, ((0, 0), (0, more))), np.pad(weights, ((0, 0), (0, more)))
    still = np.flatnonzero(rest)
    place = (weights[still] > 0).sum(axis=1)
    joints[still, place], weights[still, place] = figure, rest[still]
    return joints, weights


def rigid_binding(joint: int, n_points: int) -> Binding:
    """Return the binding of points that follow one joint."""
    return Binding(np.full((n_points, 1), joint, dtype=np.int64), np.ones((n_points, 1)))


def _entries(view: View, figure: Figure, n_points: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Return (point, joint, weight) of all usable entries, by point, each pair once; a missing weight is 1."""
    points, joints, weights = [], [], []
    for number, node in enumerate(figure.joints):
        index, given = integers(node, "skinCoordIndex"), numbers(node, "skinCoordWeight")
        if len(given) != len(index) and len(given):
            view.warn(node, f"it has {len(index)} skinCoordIndex and {len(given)} skinCoordWeight; what lacks is 1")
        given = given[: len(index)]
        points.append(index)
        joints.append(np.full(len(index), number, dtype=np.int64))
        weights.append(np.concatenate([given, np.ones(len(index) - len(given))]))
        outside = int(((index < 0) | (index >= n_points)).sum())
        if outside:
            view.warn(
                node, f"{outside} skinCoordIndex are not among the {n_points} points of the skin; they are left out"
            )
        if (given < 0).any():
            view.warn(node, "it has weights below 0; they are left out")
    point, joint, weight = np.concatenate(points), np.concatenate(joints), np.concatenate(weights)
    good = (point >= 0) & (point < n_points) & (weight > 0)
    order = np.argsort(point[good], kind="stable")
    point, joint, weight = point[good][order], joint[good][order], weight[good][order]
    if not ((point[1:] == point[:-1]) & (joint[1:] == joint[:-1])).any():
        return point, joint, weight
    pair, inverse = np.unique(point * len(figure.joints) + joint, return_inverse=True)
    summed: FloatArray = np.bincount(inverse, weight, minlength=len(pair)).astype(np.float64)
    return pair // len(figure.joints), pair % len(figure.joints), summed
