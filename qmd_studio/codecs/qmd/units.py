"""The border between the studio's metres and the paper's units: QMD holds radians and ASF length units.

This is the one place where a length leaves SI. A table serves all columns at once, so its entries must mean the same
in every file; the paper's motions are CMU AMCs, whose unit of length is 1/0.45 inch.
"""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import ColumnKind, Skeleton


def column_scales(skeleton: Skeleton) -> FloatArray:
    """Return (n_columns,) what one unit in a QMD file is worth inside the studio: ASF_UNIT_M for lengths, else 1."""
    return np.array([ASF_UNIT_M if c.kind is ColumnKind.TRANSLATION else 1.0 for c in skeleton.columns])


def codec_matrix(motion: Motion) -> Float32Array:
    """Return the matrix (n_frames, n_columns) that is encoded: float32 radians and ASF length units.

    Raises `CodecError` for a value whose differences float32 cannot hold (only opaque columns can come near).
    """
    values = motion.X / column_scales(motion.skeleton)
    if values.size and np.abs(values).max() > _LARGEST:
        frame, column = np.unravel_index(np.abs(values).argmax(), values.shape)
        raise CodecError(
            "a value is too large for a QMD file",
            at=f"frame {frame}, column {motion.skeleton.columns[int(column)].name}",
            wanted=f"at most {_LARGEST:g} in size",
            got=f"{values[frame, column]:g}",
        )
    return np.ascontiguousarray(values, dtype=np.float32)


_LARGEST = 1e30


def motion_matrix(decoded: Float32Array, skeleton: Skeleton) -> FloatArray:
    """Return X (n_frames, n_columns) in radians and metres for `decoded`, the same in the units of a file."""
    X = decoded.astype(np.float64)
    X *= column_scales(skeleton)
    return X
