"""The closed loop that chooses the indices of a frame together, by what they do to the joints.

The plain closed loop keeps each column close by itself. What is seen is where the joints are, and there errors of
different columns can make up for each other. With H the sensitivity of the frame (`motion/sensitivity.py`) the stacked
error of all joints is √(eᵀ H e) for errors e of the columns: the nearest point of a lattice is wanted, and Babai's
nearest plane finds one nearly as good. H = Uᵀ U (Cholesky); the columns are chosen from the last to the first, each at
the level nearest to what it wants less what the earlier choices ask of it. Those with the coarsest effect come first,
so that the finer ones can mend what they left. The columns that are kept as numbers come last and take up the rest.

Importing this module imports numba. The decoder's sums are run in float32, as in `kernels.py`, bit for bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.codecs.qmd.payload import IndexArray
from qmd_studio.motion.sensitivity import Body, Workspace, sensitivity_at

STIFFNESS = 5e-4
"""What a column's own error counts for beside what it does to joints, squared ASF units: all that an opaque one has."""

_LEAST_PIVOT = 0.1 * STIFFNESS
"""Rounding may leave next to nothing of a pivot, or less, where columns are as good as dependent."""


_BLOCK = 64
"""Rows that are turned into columns at a time."""


class Desk(NamedTuple):
    """Memory for one run over M columns, N of them indexed."""

    H: FloatArray
    U: FloatArray
    order: IntArray
    wanted: Float32Array
    error: FloatArray
    nearest: NDArray[np.uint32]
    chosen: IntArray
    key: FloatArray
    sized: FloatArray


def desk_for(n_columns: int, fdf: int) -> Desk:
    """Return memory for `closed_loop_by_joints` over `n_columns`, the first `fdf` of them kept as numbers."""
    n_indexed = n_columns - fdf
    square = (n_columns, n_columns)
    return Desk(
        H=np.empty(square),
        U=np.empty(square),
        order=np.arange(n_columns),
        wanted=np.empty(n_indexed, np.float32),
        error=np.empty(n_columns),
        nearest=np.empty(n_indexed, np.uint32),
        chosen=np.empty(n_indexed, np.int64),
        key=np.empty(n_indexed),
        sized=np.empty(n_columns),
    )


@njit(cache=True, nogil=True)
def closed_loop_by_joints(  # noqa: PLR0913 - compiled code takes no record but of arrays
    body: Body,
    workspace: Workspace,
    desk: Desk,
    refresh: int,
    matrix: Float32Array,
    table: Float32Array,
    middles: Float32Array,
    pose: Float32Array,
    exact: Float32Array,
    indices: IndexArray,
    decoded: Float32Array,
) -> None:
    """Choose the indices of row after row; from `matrix` on the arguments are those of `kernels.closed_loop`.

    `refresh` says after how many rows H is worked out anew: 1 for the exact choice.
    """
    n_rows, fdf = exact.shape
    n_indexed = indices.shape[1]
    block = np.empty((_BLOCK, len(pose)), np.float32)
    for row in range(n_rows):
        target = matrix[row + 1]
        for j in range(n_indexed):
            desk.wanted[j] = target[fdf + j] - pose[fdf + j]
        _find_nearest(desk, middles)
        if row % refresh == 0:
            sensitivity_at(body, matrix[min(row + refresh // 2, n_rows - 1) + 1], workspace, desk.H)
            _prepare(desk, table, fdf)
        _choose(desk, table, middles, fdf)
        for j in range(fdf):
            step = np.float32(np.float64(target[j]) + desk.error[j]) - pose[j]
            exact[row, j] = step
            pose[j] += step
        for j in range(n_indexed):
            index = desk.chosen[j]
            indices[row, j] = index
            pose[fdf + j] += table[index]
        at = row % _BLOCK
        block[at] = pose
        if at == _BLOCK - 1 or row == n_rows - 1:
            for j in range(len(pose)):
                for back in range(at + 1):
                    decoded[j, row - at + back] = block[back, j]


@njit(cache=True, nogil=True)
def _find_nearest(desk: Desk, middles: Float32Array) -> None:
    """Find the level nearest to what each indexed column wants; all take a step of the search at once."""
    nearest, wanted = desk.nearest, desk.wanted
    for j in range(len(nearest)):
        nearest[j] = 0
    half = np.uint32(len(middles) // 2)
    while half > 0:
        for j in range(len(nearest)):
            high = np.uint32(nearest[j] + half)
            nearest[j] = high if middles[np.uint64(high) - np.uint64(1)] < wanted[j] else nearest[j]
        half = np.uint32(half >> np.uint32(1))


@njit(cache=True, nogil=True)
def _level(middles: Float32Array, value: np.float32) -> int:
    """Return the number of middles below `value`: the nearest level. The number of levels is a power of two."""
    low, half = np.uint64(0), np.uint64(len(middles) // 2)
    while half > 0:
        high = low + half
        low = high if middles[high - np.uint64(1)] < value else low
        half >>= np.uint64(1)
    return int(np.int64(low))


@njit(cache=True, nogil=True)
def _prepare(desk: Desk, table: Float32Array, fdf: int) -> None:
    """Fill `order` and `U` (rows in that order) with H + stiffness = Uᵀ U: exact columns, then finest to coarsest."""
    H, U, order, key = desk.H, desk.U, desk.order, desk.key
    n, n_indexed, last = len(H), len(H) - fdf, len(table) - 1
    for j in range(n):
        H[j, j] += STIFFNESS
    _factorise(H, 0, fdf)
    for j in range(fdf, n):
        _take_off(H, j, 0, fdf)
    for j in range(n_indexed):
        level = int(np.int64(desk.nearest[j]))
        spacing = np.float64(table[min(level + 1, last)]) - np.float64(table[max(level - 1, 0)])
        key[j] = spacing * np.sqrt(max(H[fdf + j, fdf + j], 0.0))
    for j in range(fdf):
        order[j] = j
    _sort(key, order, fdf)
    for a in range(n):
        from_row = H[order[a]]
        for b in range(a, n):
            U[a, b] = from_row[order[b]] if a < fdf or order[a] <= order[b] else H[order[b], order[a]]
    _factorise(U, fdf, n)


@njit(cache=True, nogil=True)
def _sort(key: FloatArray, order: IntArray, fdf: int) -> None:
    """Order the indexed columns by ascending key, by insertion: they are few, and nearly in order once sorted."""
    for a in range(fdf, len(order)):
        column, b = order[a], a
        while b > fdf and key[order[b - 1] - fdf] > key[column - fdf]:
            order[b] = order[b - 1]
            b -= 1
        order[b] = column


@njit(cache=True, nogil=True)
def _factorise(A: FloatArray, first: int, last: int) -> None:
    """Turn rows `first` to `last` - 1 of the upper triangle of A into those of its Cholesky factor, in place.

    Rows before `first` are taken to be accounted for already.
    """
    for a in range(first, last):
        _take_off(A, a, first, a)
        row = A[a, a:]
        root = np.sqrt(max(row[0], _LEAST_PIVOT))
        for b in range(len(row)):
            row[b] /= root
        row[0] = root


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _take_off(A: FloatArray, a: int, first: int, last: int) -> None:
    """Take off row `a` what rows `first` to `last` - 1 of the factor account for; four at a time is twice as fast."""
    row, k = A[a, a:], first
    while k + 4 <= last:
        p, q, r, s = A[k, a:], A[k + 1, a:], A[k + 2, a:], A[k + 3, a:]
        f, g, h, i = p[0], q[0], r[0], s[0]
        for b in range(len(row)):
            row[b] -= f * p[b] + g * q[b] + h * r[b] + i * s[b]
        k += 4
    while k < last:
        p = A[k, a:]
        f = p[0]
        for b in range(len(row)):
            row[b] -= f * p[b]
        k += 1


@njit(cache=True, nogil=True)
def _choose(desk: Desk, table: Float32Array, middles: Float32Array, fdf: int) -> None:
    """Choose a level for every indexed column and leave in `error` what the exact ones are to be moved by."""
    U, order, chosen, error, sized = desk.U, desk.order, desk.chosen, desk.error, desk.sized
    n = len(U)
    cost = 0.0
    for a in range(n - 1, fdf - 1, -1):
        asked = _dot(U[a], sized, a + 1) / U[a, a]
        j = order[a] - fdf
        wanted = np.float64(desk.wanted[j])
        level = _level(middles, np.float32(wanted - asked))
        chosen[j] = level
        sized[a] = table[level] - wanted
        cost += (U[a, a] * (sized[a] + asked)) ** 2
    if not cost <= _cost_of_nearest(desk, table, fdf):
        for a in range(fdf, n):
            j = order[a] - fdf
            chosen[j] = desk.nearest[j]
            sized[a] = np.float64(table[chosen[j]]) - desk.wanted[j]
    for a in range(fdf - 1, -1, -1):
        moved = -_dot(U[a], sized, a + 1) / U[a, a]
        sized[a] = error[a] = moved if np.isfinite(moved) else 0.0


@njit(cache=True, nogil=True)
def _cost_of_nearest(desk: Desk, table: Float32Array, fdf: int) -> float:
    U, order, error = desk.U, desk.order, desk.error
    n = len(U)
    for a in range(fdf, n):
        j = order[a] - fdf
        error[a] = np.float64(table[desk.nearest[j]]) - desk.wanted[j]
    cost = 0.0
    for a in range(fdf, n):
        cost += _dot(U[a], error, a) ** 2
    return cost


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _dot(row: FloatArray, values: FloatArray, start: int) -> float:
    total = 0.0
    for b in range(start, len(row)):
        total += row[b] * values[b]
    return total
