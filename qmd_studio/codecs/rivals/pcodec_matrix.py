"""A matrix of numbers through pcodec, column by column, with as little around them as pcodec allows.

The bytes: the number type as one character ("h" int16, "i" int32, "f" float32), the rows as uint32, pcodec's header,
then for each column its metadata and its one page. pcodec finds the order of differences that suits a column itself.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

_LEVEL = 8
_HEAD = struct.Struct("<cI")
_TYPES: dict[bytes, tuple[type[np.generic], str]] = {
    b"h": (np.int16, "i16"),
    b"i": (np.int32, "i32"),
    b"f": (np.float32, "f32"),
}
_PAGE_MULTIPLE = 256
_MOST_META = 1 << 14
"""More than the tables of one column ever take at this level: pcodec wants bytes of its own, and copies cost time."""


def pack_matrix(matrix: NDArray[np.int32] | NDArray[np.float32]) -> bytes:
    """Return (n_frames, n_columns) int32 or float32 numbers packed; small integers as int16, which take less."""
    from pcodec import ChunkConfig, PagingSpec, wrapped  # loaded where it is needed

    kind = _kind(matrix)
    columns = np.ascontiguousarray(matrix.T.astype(_TYPES[kind][0]))
    settings = ChunkConfig(compression_level=_LEVEL, paging_spec=PagingSpec.exact_page_sizes([len(matrix)]))
    compressor = wrapped.FileCompressor()
    parts = [_HEAD.pack(kind, len(matrix)), compressor.write_header()]
    for column in columns:
        chunk = compressor.chunk_compressor(column, settings)
        parts += [chunk.write_meta(), chunk.write_page(0)]
    return b"".join(parts)


def unpack_matrix(data: bytes, n_columns: int) -> NDArray[Any]:
    """Return the numbers (n_frames, n_columns) that `pack_matrix` was given, int16, int32 or float32."""
    from pcodec import wrapped

    kind, n_frames = _HEAD.unpack_from(data)
    dtype, name = _TYPES[kind]
    decompressor, read = wrapped.FileDecompressor.new(data[_HEAD.size :])
    at = _HEAD.size + read
    columns = np.empty((n_columns, -(-n_frames // _PAGE_MULTIPLE) * _PAGE_MULTIPLE), dtype)
    most = 2 * dtype().itemsize * n_frames + _MOST_META
    for column in columns:
        chunk, read = decompressor.chunk_decompressor(data[at : at + _MOST_META], name)
        at += read
        _, read = chunk.read_page_into(data[at : at + most], n_frames, column)
        at += read
    return np.ascontiguousarray(columns[:, :n_frames].T)


def _kind(matrix: NDArray[Any]) -> bytes:
    if matrix.dtype == np.float32:
        return b"f"
    small = np.iinfo(np.int16)
    return b"h" if small.min <= matrix.min() and matrix.max() <= small.max else b"i"
