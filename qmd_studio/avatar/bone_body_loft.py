"""Lofts: closed shapes swept along an axis through a table of cross-sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body_shapes import Shape, across, circle, tube

Profile = Sequence[tuple[float, ...]]
"""Rows (place, half width, half depth, shift to the front): places along the axis from 0 to 1, the rest in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """A straight axis from `start` to `end` (metres) whose cross-sections have their front towards `towards`."""

    start: FloatArray
    end: FloatArray
    towards: FloatArray

    @property
    def length(self) -> float:
        """The length, metres."""
        return float(np.linalg.norm(self.end - self.start))

    def frame(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return unit vectors along, to the side and to the front."""
        along = (self.end - self.start) / max(self.length, 1e-12)
        if self.length < 1e-9:
            along = np.array([0.0, 1.0, 0.0])
        return (along, *across(along, self.towards))

    def place_of(self, points: FloatArray) -> FloatArray:
        """Return how far along the axis points (n, 3) are: 0 at the start, 1 at the end."""
        return np.asarray((points - self.start) @ self.frame()[0] / max(self.length, 1e-12))


def loft(
    axis: Axis, profile: Profile, *, rim: float, rings: int, around: int = 20, square: float = 2.0, scale: float = 1.0
) -> Shape:
    """Return the shape through `profile`, its two ends rounded over `rim` metres.

    `square` is the cross-section's exponent: 2 an ellipse, more a rounded box. `scale` multiplies the profile's metres.
    """
    table = np.array([(*row, 0.0)[:4] if len(row) < 4 else row[:4] for row in profile], dtype=np.float64)
    first, last = table[0, 0], table[-1, 0]
    span = (last - first) * axis.length
    soft = min(rim, 0.5 * span) / max(axis.length, 1e-12)
    turn = np.linspace(0, np.pi / 2, 5)[1:]
    ends = soft * (1 - np.cos(turn))
    places = np.concatenate([first + ends, np.linspace(first + soft, last - soft, rings + 2)[1:-1], last - ends[::-1]])
    factor = np.concatenate([np.sin(turn), np.ones(rings), np.sin(turn[::-1])])
    values = smooth_table(table, places) * scale
    along, side, front = axis.frame()
    ring = superellipse(around, square)
    flat = ring[None, :, :1] * (values[:, 0] * factor)[:, None, None] * side
    deep = ring[None, :, 1:] * (values[:, 1] * factor)[:, None, None] * front
    centre = axis.start + (places * axis.length)[:, None] * along + values[:, 2:3] * front
    return tube(centre[:, None] + flat + deep)


def superellipse(n: int, square: float) -> FloatArray:
    """Return a rounded box's outline (n, 2) from -1 to 1; `square` 2 is a circle."""
    turn = circle(n)
    return np.asarray(np.sign(turn) * np.abs(turn) ** (2.0 / square))


def smooth_table(table: FloatArray, places: FloatArray) -> FloatArray:
    """Return rows of `table` (its first column rising) at `places`: a smooth cubic that does not overshoot."""
    x, y = table[:, 0], table[:, 1:]
    slope = np.diff(y, axis=0) / np.maximum(np.diff(x), 1e-12)[:, None]
    tangent = np.zeros_like(y)
    tangent[0], tangent[-1] = slope[0], slope[-1]
    same = slope[:-1] * slope[1:] > 0
    both = np.where(same, slope[:-1] + slope[1:], 1.0)
    tangent[1:-1] = np.where(same, 2.0 * slope[:-1] * slope[1:] / both, 0.0)
    k = np.clip(np.searchsorted(x, places, side="right") - 1, 0, len(x) - 2)
    h = np.maximum(x[k + 1] - x[k], 1e-12)[:, None]
    t = np.clip((places - x[k])[:, None] / h, 0.0, 1.0)
    bend = (1 - t) ** 2 * (1 + 2 * t) * y[k] + t**2 * (3 - 2 * t) * y[k + 1]
    return np.asarray(bend + h * (t * (1 - t) ** 2 * tangent[k] - t**2 * (1 - t) * tangent[k + 1]))
