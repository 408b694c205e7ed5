"""Where segments and key poses lie in a motion, and the numbers that bound a payload: all as integers.

The layout is written out in resources/help/qmd-compact.md; the numbers here are that page's.
"""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import IntArray

BLOCK = 20
"""The frames from one key pose to the next, as nearly as a segment divides into them."""

MAX_BLOCK = 60
"""The longest block that a file may ask for."""


def n_segments(n_frames: int, segment: int) -> int:
    """Return how many segments of `segment` frames (0: all in one) hold `n_frames`."""
    return -(-n_frames // segment) if segment else 1


def key_frames(n_frames: int, block: int) -> IntArray:
    """Return the frames (k,) of a segment of `n_frames` that are key poses: the first, the last, and some between."""
    last = n_frames - 1
    if not last:
        return np.zeros(1, dtype=np.int64)
    blocks = max(1, (2 * last + block) // (2 * block))
    return last * np.arange(blocks + 1, dtype=np.int64) // blocks
