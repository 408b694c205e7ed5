"""One slider tick the straightforward way, in NumPy: the reference that the fast path is measured against."""

import numpy as np

from qmd_studio.motion.kinematics import point_positions
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import ColumnKind


def scales(skeleton):
    return np.array([ASF_UNIT_M if c.kind is ColumnKind.TRANSLATION else 1.0 for c in skeleton.columns])


def plain_tick(motion, original_positions, *, fdf, bits):
    """Return DEF, mean, p99 and maximum in millimetres of the closed-loop encoder, one segment, from scratch.

    `original_positions` (n_frames, n_points, 3) are given: they do not change while a slider is dragged.
    """
    matrix = (motion.X / scales(motion.skeleton)).astype(np.float32)
    table = companded(np.diff(matrix, axis=0)[:, fdf:].ravel(), 2**bits)
    middles = (table[1:] + table[:-1]) / 2
    decoded = np.empty_like(matrix)
    decoded[0] = matrix[0]
    for row in range(len(matrix) - 1):
        step = matrix[row + 1] - decoded[row]
        step[fdf:] = table[np.searchsorted(middles, step[fdf:])]
        decoded[row + 1] = decoded[row] + step
    positions = point_positions(motion.skeleton, decoded * scales(motion.skeleton))
    distance = np.linalg.norm(positions - original_positions, axis=-1)
    def_ = np.sqrt((distance**2).sum(axis=1)).mean() / ASF_UNIT_M
    return def_, distance.mean() * 1e3, np.percentile(distance, 99) * 1e3, distance.max() * 1e3


def companded(values, n_levels):
    """Levels of a density that is the root of the values' own, 2 % of them spread evenly."""
    ordered = np.sort(values)
    edges = np.unique(np.quantile(ordered, np.linspace(0, 1, 4 * n_levels + 1)))
    shares = np.diff(np.searchsorted(ordered, edges)).clip(1)
    widths = np.diff(edges)
    heights = np.concatenate([[0], np.cumsum(np.sqrt(shares * widths))])
    heights = 0.98 * heights / heights[-1] + 0.02 * (edges - edges[0]) / (edges[-1] - edges[0])
    return np.interp(np.linspace(0, 1, n_levels), heights, edges).astype(np.float32)
