"""The two loops that run once for every value: the closed loop of the encoder and the decoder's sums.

Importing this module imports numba; it is imported where a loop is about to run. Both kernels add in float32, row after
row, in the same order, without fused operations: what the encoder sees is bit for bit what a decoder will have.
"""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd.payload import IndexArray
from qmd_studio.compiled import compiled

_BLOCK = 64
"""Rows that are turned into columns at a time: few enough to stay in the nearest cache."""


@compiled()
def closed_loop(
    matrix: Float32Array,
    table: Float32Array,
    middles: Float32Array,
    pose: Float32Array,
    exact: Float32Array,
    indices: IndexArray,
    decoded: Float32Array,
) -> None:
    """Choose, row after row, the indices nearest to what the decoder still lacks.

    `matrix` (rows + 1, m) are the poses, `table` (2^b,) ascends, `middles` (2^b,) lie between its neighbours with
    infinity at the end, `pose` (m,) is where the decoder stands and is moved on. `exact` (rows, FDF), `indices` (rows,
    m - FDF) and `decoded` (m, rows) are filled in.
    """
    n_rows, fdf = exact.shape
    n_indexed = indices.shape[1]
    wanted = np.empty(n_indexed, np.float32)
    position = np.empty(n_indexed, np.uint32)
    block = np.empty((_BLOCK, fdf + n_indexed), np.float32)
    for row in range(n_rows):
        for j in range(fdf):
            step = matrix[row + 1, j] - pose[j]
            exact[row, j] = step
            pose[j] += step
        for j in range(n_indexed):
            wanted[j] = matrix[row + 1, fdf + j] - pose[fdf + j]
            position[j] = 0
        # All columns take the same step of their binary search at once, so that the compiler can do many in one go.
        half = np.uint32(len(table) // 2)
        while half > 0:
            for j in range(n_indexed):
                low = position[j]
                high = np.uint32(low + half)
                position[j] = high if middles[np.uint64(high) - np.uint64(1)] < wanted[j] else low
            half = np.uint32(half >> np.uint32(1))
        for j in range(n_indexed):
            index = position[j]
            indices[row, j] = index
            pose[fdf + j] += table[np.uint64(index)]
        at = row % _BLOCK
        block[at] = pose
        if at == _BLOCK - 1 or row == n_rows - 1:
            for j in range(len(pose)):
                for back in range(at + 1):
                    decoded[j, row - at + back] = block[back, j]


@compiled()
def accumulate(
    table: Float32Array, pose: Float32Array, exact: Float32Array, indices: IndexArray, decoded: Float32Array
) -> None:
    """Decode a segment: each pose is the last one plus exact differences and table entries.

    `pose` (m,) is where the segment starts; `decoded` (rows, m) is filled in.
    """
    n_rows, fdf = exact.shape
    before = pose
    for row in range(n_rows):
        for j in range(fdf):
            decoded[row, j] = before[j] + exact[row, j]
        for j in range(indices.shape[1]):
            decoded[row, fdf + j] = before[fdf + j] + table[np.uint64(indices[row, j])]
        before = decoded[row]
