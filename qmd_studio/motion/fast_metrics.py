"""The measures of `motion/metrics.py` from positions that the float32 kinematics give, in one compiled pass.

Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array
from qmd_studio.compiled import compiled
from qmd_studio.errors import FormatError
from qmd_studio.motion.metrics import MotionError, summed_up
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import Skeleton

_Rows: TypeAlias = NDArray[Any]


def measure_positions(skeleton: Skeleton, original: Float32Array, decoded: Float32Array, *, fps: float) -> MotionError:
    """Measure positions against positions, both (3 * n_points, n_frames) metres from `point_positions_32`.

    The result is that of `metrics.measure` in single precision. Its `distance_mm` (n_frames, n_points) is a view whose
    frames lie together. Raises `FormatError` where the shapes differ or are not those of the skeleton's points.
    """
    wanted = (3 * len(skeleton.points), original.shape[-1])
    if original.shape != wanted or decoded.shape != wanted or 0 in wanted:
        got = f"{original.shape} and {decoded.shape}"
        raise FormatError("the positions cannot be compared", wanted=f"{wanted}, none of them 0", got=got)
    distance = np.empty((len(skeleton.points), wanted[1]), dtype=np.float32)
    norms, velocity, acceleration = _measure_kernel(original, decoded, distance)
    return summed_up(
        distance.T,
        skeleton,
        def_=norms / ASF_UNIT_M,
        velocity_mm_s=1000 * velocity * fps,
        acceleration_mm_s2=1000 * acceleration * fps**2,
    )


@compiled(fastmath=True)
def _measure_kernel(original: _Rows, decoded: _Rows, distance: _Rows) -> tuple[float, float, float]:
    """Fill `distance` (n_points, n_frames) in mm; return the means of a frame's norm, of speed and of its change."""
    n_points, n_frames = distance.shape
    squares = np.zeros(n_frames, np.float32)
    error = np.empty((3, n_frames), np.float32)
    velocity, acceleration = 0.0, 0.0
    for point in range(n_points):
        for a in range(3):
            row, theirs, ours = error[a], decoded[3 * point + a], original[3 * point + a]
            for t in range(n_frames):
                row[t] = theirs[t] - ours[t]
        x, y, z = error[0], error[1], error[2]
        away = distance[point]
        for t in range(n_frames):
            square = x[t] * x[t] + y[t] * y[t] + z[t] * z[t]
            squares[t] += square
            away[t] = np.float32(1000) * np.sqrt(square)
        velocity += _speed(x, y, z)
        acceleration += _change_of_speed(x, y, z)
    norms = np.float64(0)
    for t in range(n_frames):
        norms += np.sqrt(squares[t])
    return (
        norms / n_frames,
        velocity / (n_points * max(n_frames - 1, 1)),
        acceleration / (n_points * max(n_frames - 2, 1)),
    )


@compiled(fastmath=True)
def _speed(x: _Rows, y: _Rows, z: _Rows) -> float:
    total = np.float32(0)
    for t in range(1, len(x)):
        a, b, c = x[t] - x[t - 1], y[t] - y[t - 1], z[t] - z[t - 1]
        total += np.sqrt(a * a + b * b + c * c)
    return float(total)


@compiled(fastmath=True)
def _change_of_speed(x: _Rows, y: _Rows, z: _Rows) -> float:
    total, two = np.float32(0), np.float32(2)
    for t in range(2, len(x)):
        a = x[t] - two * x[t - 1] + x[t - 2]
        b = y[t] - two * y[t - 1] + y[t - 2]
        c = z[t] - two * z[t - 1] + z[t - 2]
        total += np.sqrt(a * a + b * b + c * c)
    return float(total)
