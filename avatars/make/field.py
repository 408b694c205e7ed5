"""An implicit surface: primitives joined by smooth unions, evaluated at points; negative inside, about metres.

A field is a list of steps that a small machine runs for each point over a few registers. Primitives are lofts (elliptic
sections along a line), ellipsoids and round cones; smooth joins follow the polynomial minimum with a reach `k`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from scipy.interpolate import PchipInterpolator

FAR = 1e3
N_SAMPLES = 96
_WIDTH = 40
_LOFT, _ELLIPSOID, _CONE, _JOIN, _THICKEN, _ABOVE = range(6)
UNION, CARVE = 0, 1
BODY = 0


@dataclass(slots=True)
class Field:
    """Steps (n, 40) and the tables of lofts, grown by the methods below; registers are chosen by number."""

    steps: list[np.ndarray] = field(default_factory=list)
    tables: list[np.ndarray] = field(default_factory=list)

    def ellipsoid(self, centre, radii, *, turn=None, k=0.01, register=BODY, op=UNION):
        """Join an ellipsoid; `turn` (3, 3) has its axes as columns."""
        turn = np.eye(3) if turn is None else np.asarray(turn, dtype=np.float64)
        radii = np.broadcast_to(np.asarray(radii, dtype=np.float64), 3)
        reach = np.abs(turn) @ radii
        self._add(_ELLIPSOID, op, register, k, centre - reach, centre + reach, [*centre, *radii, *turn.T.ravel()])

    def cone(self, a, b, ra, rb, *, k=0.005, register=BODY, op=UNION):
        """Join a round cone: spheres of radii `ra` at `a` and `rb` at `b`, and what lies between."""
        a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
        low, high = np.minimum(a - ra, b - rb), np.maximum(a + ra, b + rb)
        self._add(_CONE, op, register, k, low, high, [*a, *b, ra, rb])

    def loft(self, axis, knots, *, caps=(0.02, 0.02), k=0.01, register=BODY):
        """Join a loft along `axis` (0, 1, 2).

        `knots` rows are (place on the axis, two centres, two half widths), the other axes in ascending order. The ends
        are rounded off over the lengths `caps`.
        """
        knots = np.asarray(sorted(map(tuple, knots)), dtype=np.float64)
        s = np.linspace(knots[0, 0], knots[-1, 0], N_SAMPLES)
        table = PchipInterpolator(knots[:, 0], knots[:, 1:], axis=0)(s)
        for cap, away in ((caps[0], s - s[0]), (caps[1], s[-1] - s)):
            if cap > 0:
                table[:, 2:] *= np.sqrt(np.clip(1 - np.clip(1 - away / cap, 0, 1) ** 2, 1e-4, 1))[:, None]
        others = [i for i in range(3) if i != axis]
        low, high = np.zeros(3), np.zeros(3)
        low[axis], high[axis] = s[0], s[-1]
        for n, other in enumerate(others):
            low[other] = (table[:, n] - table[:, n + 2]).min()
            high[other] = (table[:, n] + table[:, n + 2]).max()
        self._add(_LOFT, UNION, register, k, low, high, [axis, *others, s[0], s[-1], len(self.tables)])
        self.tables.append(table)

    def join(self, source, *, into=BODY, k=(0.01, 0.01), axis=1, between=(0.0, 1.0)):
        """Join register `source` into another; the reach goes from k[0] to k[1] between two places on an axis."""
        self._add(_JOIN, UNION, into, 0.0, np.full(3, -FAR), np.full(3, FAR), [source, *k, axis, *between])

    def thicken(self, amount, normal, offset, width, *, register=BODY):
        """Grow a register outwards by `amount` where normal · p > offset, the step being `width` wide."""
        self._add(_THICKEN, UNION, register, 0.0, np.full(3, -FAR), np.full(3, FAR), [amount, *normal, offset, width])

    def above(self, y, *, k=0.004, register=BODY):
        """Cut away what lies under the level `y`."""
        self._add(_ABOVE, UNION, register, k, np.full(3, -FAR), np.full(3, FAR), [y])

    def _add(self, kind, op, register, k, low, high, values):
        row = np.zeros(_WIDTH)
        margin = k + 0.03
        row[:4] = kind, op, register, k
        row[4:7], row[7:10] = np.asarray(low) - margin, np.asarray(high) + margin
        row[10 : 10 + len(values)] = values
        self.steps.append(row)

    def registers(self, points: np.ndarray) -> np.ndarray:
        """Return what each of the eight registers holds at `points` (n, 3) in the end: (n, 8)."""
        tables = np.array(self.tables) if self.tables else np.zeros((1, N_SAMPLES, 4))
        return _run(np.ascontiguousarray(points, dtype=np.float64), np.array(self.steps), tables)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return the field at `points` (n, 3): (n,) negative inside."""
        return self.registers(points)[:, BODY]

    def gradient(self, points: np.ndarray, step: float = 2e-4) -> np.ndarray:
        """Return the field's gradient at `points` (n, 3): (n, 3), by central differences."""
        moves = np.concatenate([step * np.eye(3), -step * np.eye(3)])
        values = self((points[None] + moves[:, None]).reshape(-1, 3)).reshape(6, -1)
        return ((values[:3] - values[3:]) / (2 * step)).T

    def onto(self, points: np.ndarray, *, rounds: int = 4, longest: float = 0.004) -> np.ndarray:
        """Return `points` (n, 3) moved onto the surface by Newton steps of at most `longest`; x = 0 stays."""
        points = points.copy()
        middle = points[:, 0] == 0
        for _ in range(rounds):
            slope = self.gradient(points)
            slope[middle, 0] = 0
            square = np.maximum((slope**2).sum(axis=1), 0.05)
            move = -self(points)[:, None] * slope / square[:, None]
            length = np.linalg.norm(move, axis=1, keepdims=True)
            points += move * np.minimum(1, longest / np.maximum(length, 1e-12))
        return points


@njit(cache=True)
def _smooth_min(a, b, k):
    h = max(k - abs(a - b), 0.0)
    return min(a, b) - (h * h / (4 * k) if k > 0 else 0.0)


@njit(cache=True)
def _elliptic(u, v, a, b):
    q = math.sqrt((u / a) ** 2 + (v / b) ** 2)
    g = math.sqrt((u / a**2) ** 2 + (v / b**2) ** 2)
    return q * (q - 1) / g if g > 1e-9 else -min(a, b)


@njit(cache=True)
def _ellipsoid(p, r):
    x, y, z = p[0] - r[0], p[1] - r[1], p[2] - r[2]
    q = g = 0.0
    for i in range(3):
        w = x * r[6 + 3 * i] + y * r[7 + 3 * i] + z * r[8 + 3 * i]
        q += (w / r[3 + i]) ** 2
        g += (w / r[3 + i] ** 2) ** 2
    q, g = math.sqrt(q), math.sqrt(g)
    return q * (q - 1) / g if g > 1e-9 else -min(r[3], r[4], r[5])


@njit(cache=True)
def _cone(p, r):
    ax, ay, az = p[0] - r[0], p[1] - r[1], p[2] - r[2]
    bx, by, bz = r[3] - r[0], r[4] - r[1], r[5] - r[2]
    length = math.sqrt(bx * bx + by * by + bz * bz) + 1e-12
    along = (ax * bx + ay * by + az * bz) / length
    across = math.sqrt(max(ax * ax + ay * ay + az * az - along * along, 0.0))
    slope = (r[6] - r[7]) / length
    cosine = math.sqrt(max(1 - slope * slope, 1e-9))
    s = min(max(along + across * slope / cosine, 0.0), length)
    return math.sqrt(across * across + (along - s) ** 2) - (r[6] + (r[7] - r[6]) * s / length)


@njit(cache=True)
def _loft(p, r, tables):
    s, low, high = p[int(r[0])], r[3], r[4]
    inside = min(max(s, low), high)
    t = (inside - low) / (high - low) * (N_SAMPLES - 1)
    i = min(int(t), N_SAMPLES - 2)
    f = t - i
    row = (1 - f) * tables[int(r[5]), i] + f * tables[int(r[5]), i + 1]
    d = _elliptic(p[int(r[1])] - row[0], p[int(r[2])] - row[1], row[2], row[3])
    beyond = abs(s - inside)
    return d if beyond == 0 else math.sqrt(max(d, 0.0) ** 2 + beyond * beyond)


@njit(cache=True)
def _step(w):
    w = min(max(w, 0.0), 1.0)
    return w * w * (3 - 2 * w)


@njit(cache=True)
def _run(points, steps, tables):
    result = np.full((len(points), 8), FAR)
    for n in range(len(points)):
        p, out = points[n], result[n]
        for row in steps:
            kind, register = int(row[0]), int(row[2])
            if kind < _JOIN and (
                p[0] < row[4] or p[1] < row[5] or p[2] < row[6] or p[0] > row[7] or p[1] > row[8] or p[2] > row[9]
            ):
                continue
            r = row[10:]
            if kind == _JOIN:
                f = _step((p[int(r[3])] - r[4]) / (r[5] - r[4]))
                out[register] = _smooth_min(out[register], out[int(r[0])], r[1] + (r[2] - r[1]) * f)
            elif kind == _THICKEN:
                away = p[0] * r[1] + p[1] * r[2] + p[2] * r[3] - r[4]
                out[register] -= r[0] * _step(away / r[5] + 0.5)
            elif kind == _ABOVE:
                out[register] = -_smooth_min(-out[register], p[1] - r[0], row[3])
            else:
                d = _loft(p, r, tables) if kind == _LOFT else _cone(p, r) if kind == _CONE else _ellipsoid(p, r)
                if int(row[1]) == CARVE:
                    out[register] = -_smooth_min(-out[register], d, row[3])
                else:
                    out[register] = _smooth_min(out[register], d, row[3])
    return result
