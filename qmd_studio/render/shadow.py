"""The soft shadow on the ground: what the bones of a body hide of the sky, worked out from capsules on a small map."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.render.scene import Actor

_SIZE = 72
_MAX_BONES = 28
_WIDTH_NEAR, _WIDTH_PER_M = 0.028, 0.13
_LEAN = np.array([0.06, -0.12])  # the shadow's shift along x and z for each metre of height, away from the key light


@dataclass(frozen=True, slots=True, eq=False)
class ShadowMap:
    """How dark the ground is, `darkness` (rows along z, columns along x) 0 to 1, over a window of it.

    `window` is the corner's x and z and one over width and depth, metres.
    """

    darkness: Float32Array
    window: tuple[float, float, float, float]


def shadow_map(actors: Iterable[Actor], ground_y: float) -> ShadowMap | None:
    """Return the soft shadow that the opaque `actors` lay on the ground at `ground_y`, or None where none does."""
    ends = [_bones(actor, ground_y) for actor in actors if not actor.ghost and actor.alpha >= 1.0]
    if not ends:
        return None
    start, end, scale = (np.concatenate([e[k] for e in ends]) for k in range(3))
    fallen = np.concatenate([e[:, [0, 2]] + _LEAN * np.maximum(e[:, 1:2], 0.0) for e in (start, end)])
    heights = np.concatenate([start[:, 1], end[:, 1]])
    margin = 2.3 * (_WIDTH_NEAR * scale.max() + _WIDTH_PER_M * max(float(heights.max()), 0.0))
    low, high = fallen.min(axis=0) - margin, fallen.max(axis=0) + margin
    size = np.maximum(high - low, 0.1)
    if not np.isfinite(size).all():
        return None
    x = low[0] + (np.arange(_SIZE) + 0.5) / _SIZE * size[0]
    z = low[1] + (np.arange(_SIZE) + 0.5) / _SIZE * size[1]
    light = np.ones((_SIZE, _SIZE))
    for a, b, s in zip(start, end, scale, strict=True):
        light *= 1.0 - _darkness(x[None, :], z[:, None], (a, b), s)
    edge = _ramp(_SIZE)[None, :] * _ramp(_SIZE)[:, None]
    window = (float(low[0]), float(low[1]), float(1 / size[0]), float(1 / size[1]))
    return ShadowMap(((1.0 - light) * edge).astype(np.float32), window)


def _bones(actor: Actor, ground_y: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The longest bones: their ends with heights above the ground, and the length that widths are shares of."""
    joints = actor.body.skeleton.joints
    at = actor.joint_positions() - (0.0, ground_y, 0.0)
    parents = np.array([max(j.parent, 0) for j in joints])
    lengths = np.linalg.norm(at - at[parents], axis=1)
    longest = np.argsort(-lengths, kind="stable")[:_MAX_BONES]
    stature = np.full(len(longest), max(float(np.linalg.norm(np.ptp(actor.body.bind[:, :3, 3], axis=0))), 0.05))
    return at[parents[longest]], at[longest], stature


def _darkness(x: FloatArray, z: FloatArray, bone: tuple[FloatArray, FloatArray], stature: float) -> FloatArray:
    """What one bone hides: near the ground a small dark blot, high above it a wide faint one."""
    (a, b) = (end[[0, 2]] + _LEAN * max(end[1], 0.0) for end in bone)
    along = b - a
    length2 = float(along @ along)
    length3 = float((bone[1] - bone[0]) @ (bone[1] - bone[0]))
    t = ((x - a[0]) * along[0] + (z - a[1]) * along[1]) / length2 if length2 > 1e-12 else np.zeros_like(x + z)
    t = np.clip(t, 0.0, 1.0)
    away2 = (x - a[0] - t * along[0]) ** 2 + (z - a[1] - t * along[1]) ** 2
    height = np.maximum(bone[0][1] + t * (bone[1][1] - bone[0][1]), 0.0)
    width = _WIDTH_NEAR * stature + _WIDTH_PER_M * height
    strength = 0.68 * (_WIDTH_NEAR * stature / width) * min(1.0, 8.0 * np.sqrt(length3) / stature)
    return np.asarray(strength * np.exp(-away2 / (width * width)))


def _ramp(n: int) -> FloatArray:
    return np.clip(np.minimum(np.arange(n), np.arange(n)[::-1]) / 6.0, 0.0, 1.0)
