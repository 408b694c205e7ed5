"""The encoder's choices, compiled: which integers to send, by what they do to the joints and by what they cost.

An error e of the columns moves the joints by eᵀHe, H being the normal matrix of their Jacobian. With H = LLᵀ that is a
sum of squares, one for each column, given the errors of the columns after it. So the columns are decided from the last
to the first, each making up for what the later ones left over (Babai's nearest plane), distortion and price weighed
together. Sweeps afterwards change single integers as long as that lowers the sum. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.codecs.compact.model import LARGEST, ROW_0, cell_of, context_of, expected_coefficient, learn, price

_SWEEPS = 2
_DRAWN_IN = 0.85
"""The first guess at a neighbour that is not decided yet: a little nearer to zero than the nearest integer."""


@njit(cache=True, nogil=True)
def nearest_plane(wanted: FloatArray, step: FloatArray, lower: FloatArray) -> IntArray:
    """Return the integers (m,) whose multiples of `step` come near to `wanted`, `lower` being the root of the norm."""
    m = len(wanted)
    error, chosen = np.empty(m), np.empty(m, np.int64)
    for a in range(m - 1, -1, -1):
        pull = 0.0
        for b in range(a + 1, m):
            pull += lower[b, a] * error[b]
        chosen[a] = int(np.rint((wanted[a] - pull / lower[a, a]) / step[a]))
        error[a] = chosen[a] * step[a] - wanted[a]
    return chosen


@njit(cache=True, nogil=True)
def choose_rows(coefficients, step, lower, H, rate, cells, bits, known):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Return the integers (rows, m) for the coefficients of one block, and let `cells` learn them.

    `rate` is the price of a bit in squared ASF units. `known` are the magnitudes of the block before (padded), those of
    this block (padded, to be filled in), whether there was a block before, and the keys' step (m,).
    """
    n_rows, m = coefficients.shape
    before, sizes, had, key_step = known
    rows = np.zeros((n_rows, m), np.int64)
    error, context = np.empty(m), np.empty(m, np.int64)
    sizes[:] = 0
    for f in range(n_rows):
        kind = ROW_0 + min(f, 2)
        for j in range(m):
            sizes[f + 2, j + 2] = abs(int(np.rint(coefficients[f, j] / step[j] * _DRAWN_IN)))
        for j in range(m):
            context[j] = cell_of(kind, context_of(expected_coefficient(sizes, before, had, abs(key_step[j]), f, j)))
        _decide(coefficients[f], step, lower, rate, cells, bits, context, rows[f], error)
        _sweep(step, H, rate, cells, bits, context, rows[f], error)
        for j in range(m):
            sizes[f + 2, j + 2] = abs(rows[f, j])
        for j in range(m):
            context_then = context_of(expected_coefficient(sizes, before, had, abs(key_step[j]), f, j))
            learn(cells, cell_of(kind, context_then), rows[f, j])
    return rows


@njit(cache=True, nogil=True)
def _decide(wanted, step, lower, rate, cells, bits, context, row, error):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, PLR0913
    for a in range(len(wanted) - 1, -1, -1):
        pull = 0.0
        for b in range(a + 1, len(wanted)):
            pull += lower[b, a] * error[b]
        goal = -pull / lower[a, a]
        weight = lower[a, a] * lower[a, a]
        nearest = int(np.rint((wanted[a] + goal) / step[a]))
        nearest = min(max(nearest, -LARGEST), LARGEST)
        inner = nearest - 1 if nearest > 0 else (nearest + 1 if nearest < 0 else 0)
        best, least = 0, np.inf
        for k in (nearest, inner, 0):
            away = k * step[a] - wanted[a] - goal
            total = weight * away * away + rate * price(cells, context[a], bits, k)
            if total < least:
                least, best = total, k
        row[a] = best
        error[a] = best * step[a] - wanted[a]


@njit(cache=True, nogil=True)
def _sweep(step, H, rate, cells, bits, context, row, error):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    m = len(row)
    slope = np.zeros(m)
    for a in range(m):
        for b in range(m):
            slope[a] += H[a, b] * error[b]
    for _ in range(_SWEEPS):
        changed = False
        for j in range(m):
            now = row[j]
            paid = price(cells, context[j], bits, now)
            best, least = now, -1e-15
            for k in (max(now - 1, -LARGEST), min(now + 1, LARGEST), 0):
                move = (k - now) * step[j]
                gain = (2 * slope[j] + H[j, j] * move) * move
                gain += rate * (price(cells, context[j], bits, k) - paid)
                if gain < least:
                    least, best = gain, k
            if best != now:
                move = (best - now) * step[j]
                row[j] = best
                error[j] += move
                changed = True
                for b in range(m):
                    slope[b] += H[j, b] * move
        if not changed:
            break
