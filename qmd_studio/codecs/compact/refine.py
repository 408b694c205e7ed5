"""Second thoughts of the compact encoder, compiled: single coefficients changed by what they do frame by frame.

`choices` decides with one matrix for a whole block. Where joints turn fast that matrix fits no frame of it well. Here
the sum over the frames of eᵀHe, each with its own H, is lowered exactly: a change of one coefficient by x moves it by
2 x Σ s·(He) + x² Σ s²·H, s being that frequency's sine. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.codecs.compact.model import LARGEST, ROW_0, cell_of, context_of, expected_coefficient, learn, price

_SWEEPS = 4


@njit(cache=True, nogil=True)
def refine_rows(rows, error, matrices, weights, step, rate, cells, bits, known):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201, PLR0913
    """Change the integers `rows` (L - 1, m) of a block in place, and let `cells` learn them.

    `error` (L - 1, m) is how far off the frames between the keys are, `matrices` (k, m, m) are those of every
    L / k-th frame, `weights` (L - 1,) how much each frame counts. The rest is as in `choose_rows`.
    """
    n, m = rows.shape
    sines = _unit_sines(n)
    slopes, bends = np.empty((n, m)), np.zeros((n, m))
    which = np.empty(n, np.int64)
    for t in range(n):
        which[t] = min((t + 1) * len(matrices) // (n + 1), len(matrices) - 1)
        slopes[t] = weights[t] * (matrices[which[t]] @ error[t])
    for t in range(n):
        for f in range(n):
            s2 = weights[t] * sines[f, t] * sines[f, t]
            for j in range(m):
                bends[f, j] += s2 * matrices[which[t], j, j]
    before, sizes, had, key_step = known
    sizes[:] = 0
    for f in range(n):
        for j in range(m):
            sizes[f + 2, j + 2] = abs(rows[f, j])
    for _ in range(_SWEEPS):
        changed = False
        for f in range(n):
            for j in range(m):
                slope = 0.0
                for t in range(n):
                    slope += sines[f, t] * slopes[t, j]
                expected = expected_coefficient(sizes, before, had, abs(key_step[j]), f, j)
                at = cell_of(ROW_0 + min(f, 2), context_of(expected))
                best = _best(rows[f, j], slope, bends[f, j], step[j], rate, cells, bits, at)
                if best == rows[f, j]:
                    continue
                move = (best - rows[f, j]) * step[j]
                rows[f, j] = best
                sizes[f + 2, j + 2] = abs(best)
                changed = True
                for t in range(n):
                    x = move * sines[f, t] * weights[t]
                    for b in range(m):
                        slopes[t, b] += matrices[which[t], j, b] * x
        if not changed:
            break
    _learn_rows(rows, sizes, cells, known)


@njit(cache=True, nogil=True)
def _best(now, slope, bend, step, rate, cells, bits, at):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Return the integer among this one, its neighbours and 0 that costs least."""
    best, least, paid = now, -1e-15, -1.0
    for k in (max(now - 1, -LARGEST), min(now + 1, LARGEST), 0):
        move = (k - now) * step
        gain = (2 * slope + bend * move) * move
        if k == now or (gain >= 0 and abs(k) > abs(now)):
            continue
        if paid < 0:
            paid = price(cells, at, bits, now)
        gain += rate * (price(cells, at, bits, k) - paid)
        if gain < least:
            least, best = gain, k
    return best


@njit(cache=True, nogil=True)
def _learn_rows(rows, sizes, cells, known):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    before, _, had, key_step = known
    used = len(rows)
    while used > 0 and not rows[used - 1].any():
        used -= 1
    for f in range(used):
        for j in range(rows.shape[1]):
            expected = expected_coefficient(sizes, before, had, abs(key_step[j]), f, j)
            learn(cells, cell_of(ROW_0 + min(f, 2), context_of(expected)), rows[f, j])


@njit(cache=True, nogil=True)
def _unit_sines(n: int) -> FloatArray:
    """Return (n, n) the sines of a block with n frames between its keys, each frequency of length one."""
    sines = np.empty((n, n))
    for f in range(n):
        for t in range(n):
            sines[f, t] = np.sqrt(2 / (n + 1)) * np.sin(np.pi * (f + 1) * (t + 1) / (n + 1))
    return sines


@njit(cache=True, nogil=True)
def error_between(rows: IntArray, coefficients: FloatArray, step: FloatArray) -> FloatArray:
    """Return (L - 1, m) how far off the frames between two keys are that `rows` stand for."""
    n, m = rows.shape
    sines, error = _unit_sines(n), np.zeros((n, m))
    for f in range(n):
        for j in range(m):
            off = rows[f, j] * step[j] - coefficients[f, j]
            for t in range(n):
                error[t, j] += sines[f, t] * off
    return error
