"""The float32 matrix kept as it is, by itself or through a general compressor.

A matrix is (n_frames, n_columns) float32 radians and ASF length units, what QMD encodes. Each decoder takes the bytes
that its encoder made, and the number of columns, which is the skeleton's.
"""

from __future__ import annotations

import importlib
import zlib
from typing import Any

import numpy as np

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.rivals.pcodec_matrix import pack_matrix, unpack_matrix

_ZIP_LEVEL = 9
_ZSTD_LEVEL = 19
_ZSTD_MODULES = ("compression.zstd", "backports.zstd")
"""Python's own from 3.14 on, and the package that is the very same module before that."""


def raw_bytes_of(matrix: Float32Array) -> bytes:
    """Return the values row after row, little-endian: the paper's "original"."""
    return matrix.astype("<f4").tobytes()


def raw_matrix(data: bytes, n_columns: int) -> Float32Array:
    """Return the matrix that `raw_bytes_of` wrote."""
    return np.frombuffer(data, "<f4").astype(np.float32).reshape(-1, n_columns)


def zip_bytes_of(matrix: Float32Array) -> bytes:
    """Return the raw bytes deflated, as a zip file holds them."""
    return zlib.compress(raw_bytes_of(matrix), _ZIP_LEVEL)


def zip_matrix(data: bytes, n_columns: int) -> Float32Array:
    """Return the matrix that `zip_bytes_of` wrote."""
    return raw_matrix(zlib.decompress(data), n_columns)


def has_zstd() -> bool:
    """Return whether this Python can do zstd; a Python built without its library cannot."""
    return _zstd() is not None


def zstd_bytes_of(matrix: Float32Array) -> bytes:
    """Return the raw bytes through zstd at its highest usual level; only where `has_zstd`."""
    zstd: Any = _zstd()
    return bytes(zstd.compress(raw_bytes_of(matrix), _ZSTD_LEVEL))


def zstd_matrix(data: bytes, n_columns: int) -> Float32Array:
    """Return the matrix that `zstd_bytes_of` wrote."""
    zstd: Any = _zstd()
    return raw_matrix(zstd.decompress(data), n_columns)


def pcodec_bytes_of(matrix: Float32Array) -> bytes:
    """Return the values through pcodec, which is made for columns of numbers."""
    return pack_matrix(matrix)


def pcodec_matrix(data: bytes, n_columns: int) -> Float32Array:
    """Return the matrix that `pcodec_bytes_of` wrote."""
    return unpack_matrix(data, n_columns).astype(np.float32, copy=False)


def _zstd() -> Any:
    for name in _ZSTD_MODULES:
        try:
            return importlib.import_module(name)
        except ImportError:
            continue
    return None
