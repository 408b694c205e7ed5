"""One setting tried the straightforward way, in NumPy: encode each segment, decode, forward kinematics, DEF."""

import numpy as np
from plain_tick import companded, scales

from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.motion.motion import ASF_UNIT_M

MOST_LEVELS = 6


def plain_evaluation(motion, original_positions, settings):
    """Return the DEF of `settings`; `original_positions` (n_frames, n_points, 3) are given, they never change."""
    matrix = (motion.X / scales(motion.skeleton)).astype(np.float32)
    rows_each = settings.segment or len(matrix) - 1
    decoded = matrix.copy()
    encode = paper_segment if settings.encoder is Encoder.PAPER else closed_segment
    levels = np.clip(motion.skeleton.levels, 1, MOST_LEVELS)
    for start in range(0, len(matrix) - 1, rows_each):
        rows = slice(start, min(start + rows_each, len(matrix) - 1) + 1)
        encode(matrix[rows], decoded[rows], settings, levels)
    positions = point_positions(motion.skeleton, decoded * scales(motion.skeleton))
    distance = np.linalg.norm(positions - original_positions, axis=-1)
    return np.sqrt((distance**2).sum(axis=1)).mean() / ASF_UNIT_M


def paper_segment(matrix, decoded, settings, levels):
    """Buckets of equal frequency over rounded differences, the mean of the lowest level in each, added up."""
    steps = np.diff(matrix, axis=0)
    values = steps[:, settings.fdf :].ravel()
    if values.size:
        level = np.broadcast_to(levels[settings.fdf :], steps[:, settings.fdf :].shape).ravel()
        _, number, counts = np.unique(np.rint(values * 1e4), return_inverse=True, return_counts=True)
        middle = np.cumsum(counts) - (counts + 1) / 2
        bucket = np.minimum(middle * 2**settings.bits // len(values), 2**settings.bits - 1).astype(int)[number]
        lowest = np.full(2**settings.bits, 99)
        np.minimum.at(lowest, bucket, level)
        kept = level == lowest[bucket]
        total = np.bincount(bucket[kept], values[kept], 2**settings.bits)
        table = total / np.maximum(np.bincount(bucket[kept], minlength=2**settings.bits), 1)
        steps[:, settings.fdf :] = table[bucket].reshape(len(steps), -1)
    decoded[1:] = np.cumsum(np.concatenate([decoded[:1], steps]), axis=0)[1:]


def closed_segment(matrix, decoded, settings, _levels):
    """The closed loop over companded levels, row after row."""
    values = np.diff(matrix, axis=0)[:, settings.fdf :].ravel()
    table = companded(values, 2**settings.bits) if values.size else np.zeros(2)
    middles = (table[1:] + table[:-1]) / 2
    for row in range(len(matrix) - 1):
        step = matrix[row + 1] - decoded[row]
        step[settings.fdf :] = table[np.searchsorted(middles, step[settings.fdf :])]
        decoded[row + 1] = decoded[row] + step
