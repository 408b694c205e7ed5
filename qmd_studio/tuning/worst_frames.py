"""Where a decoded motion is furthest from its original: error per frame, its worst moments, its outline at a width."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray, IntArray

MAX_MOMENTS = 24
"""As many worst moments as a person can walk through; the rest are no worse than these."""

_WORTH_SEEING = 0.25


def frame_errors(distance_mm: Float32Array) -> FloatArray:
    """Return the largest distance of any point in each frame, (n_frames,) mm, of `distance_mm` (n_frames, n_points)."""
    if distance_mm.shape[1] == 0:
        return np.zeros(len(distance_mm))
    return np.asarray(distance_mm.max(axis=1), dtype=np.float64)


def worst_frames(error_mm: FloatArray, *, min_gap: int, limit: int = MAX_MOMENTS) -> IntArray:
    """Return the frames where `error_mm` (n_frames,) peaks, in order of time.

    A peak is a frame no lower than its neighbours, above zero and at least a quarter of the highest. Of peaks closer
    than `min_gap` frames the higher stays; of all that stay, the `limit` highest are returned. Equal peaks are taken
    from the left.
    """
    before = np.concatenate(([-np.inf], error_mm[:-1]))
    after = np.concatenate((error_mm[1:], [-np.inf]))
    floor = max(error_mm.max() * _WORTH_SEEING, np.finfo(np.float64).tiny)
    peaks = np.flatnonzero((error_mm > before) & (error_mm >= after) & (error_mm >= floor))
    kept: list[int] = []
    for frame in peaks[np.argsort(-error_mm[peaks], kind="stable")]:
        if all(abs(int(frame) - other) >= min_gap for other in kept):
            kept.append(int(frame))
            if len(kept) == limit:
                break
    return np.array(sorted(kept), dtype=np.int64)


def next_worst(frames: IntArray, frame: int, *, backwards: bool = False) -> int | None:
    """Return the first of `frames` (ascending) after `frame`, or before it; past the end it starts again.

    None where `frames` is empty.
    """
    if len(frames) == 0:
        return None
    if backwards:
        return int(frames[int(np.searchsorted(frames, frame, side="left")) - 1])
    place = int(np.searchsorted(frames, frame, side="right"))
    return int(frames[place % len(frames)])


def outline(error_mm: FloatArray, width: int) -> FloatArray:
    """Return the highest error in each of `width` ≥ 1 equal spans of the frames, (width,) mm, so that no peak is lost.

    Where there are fewer frames than spans, a frame stands in every span that it covers.
    """
    n_frames = len(error_mm)
    edges = np.arange(width + 1) * n_frames / width
    first = np.minimum(edges[:-1].astype(np.int64), n_frames - 1)
    last = np.maximum(np.ceil(edges[1:]).astype(np.int64), first + 1)
    pairs = np.stack((first, np.minimum(last, n_frames)), axis=1).ravel()
    padded = np.append(error_mm, -np.inf)  # lets the last span end at n_frames
    return np.asarray(np.maximum.reduceat(padded, pairs)[::2], dtype=np.float64)
