"""The ten lines that any codec has to beat: each column in equal steps over its range, differenced, through pcodec.

At 4,096 levels it is the usual "12-bit" curve. The bytes: the least value and the step of each column as float32, then
the whole numbers, which pcodec differences itself: it finds the order that suits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.rivals.pcodec_matrix import pack_matrix, unpack_matrix


def encode(matrix: Float32Array, bits: float) -> bytes:
    """Return (n_frames, n_columns) float32 values in 2^`bits` levels a column; `bits` need not be whole."""
    least, step = _steps(matrix, bits)
    return least.tobytes() + step.tobytes() + pack_matrix(_numbers(matrix, least, step))


def decode(data: bytes, n_columns: int) -> Float32Array:
    """Return the matrix (n_frames, n_columns) float32 that `encode` wrote."""
    least, step = np.frombuffer(data, "<f4", 2 * n_columns).reshape(2, -1)
    return _values(unpack_matrix(data[8 * n_columns :], n_columns), least, step)


def rounded(matrix: Float32Array, bits: float) -> Float32Array:
    """Return what `decode` makes of `encode`, without the bytes."""
    least, step = _steps(matrix, bits)
    return _values(_numbers(matrix, least, step), least, step)


def _steps(matrix: Float32Array, bits: float) -> tuple[Float32Array, Float32Array]:
    """Return (n_columns,) each column's least value and its step, 1 where it is constant."""
    least = matrix.min(axis=0)
    step = (matrix.max(axis=0).astype(np.float64) - least) / (2.0**bits - 1)
    return least.astype("<f4"), np.where(step > 0, step, 1.0).astype("<f4")


def _numbers(matrix: Float32Array, least: Float32Array, step: Float32Array) -> NDArray[np.int32]:
    return np.rint((matrix.astype(np.float64) - least) / step).astype(np.int32)


def _values(numbers: NDArray[np.int32], least: Float32Array, step: Float32Array) -> Float32Array:
    return (least + numbers * step.astype(np.float64)).astype(np.float32)
