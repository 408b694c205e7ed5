"""A motion at another number of frames a second."""

from __future__ import annotations

import numpy as np

from qmd_studio.motion.in_between import in_between
from qmd_studio.motion.motion import Motion, check_frame_rate


def resampled(motion: Motion, fps: float) -> Motion:
    """Return `motion` at `fps` frames a second: what it is at those moments, columns going straight in between.

    The first frame stays; the last is the last that lies within the motion. Raises `FormatError` for a rate that
    nothing plays.
    """
    check_frame_rate(fps)
    n_frames = int(np.floor((motion.n_frames - 1) * fps / motion.fps + 1e-9)) + 1
    at = np.arange(n_frames) * motion.fps / fps
    before = np.minimum(at.astype(np.int64), motion.n_frames - 1)
    after = np.minimum(before + 1, motion.n_frames - 1)
    rows = [
        in_between(motion.skeleton, motion.X[a], motion.X[b], float(share))
        for a, b, share in zip(before, after, at - before, strict=True)
    ]
    return Motion(motion.skeleton, np.array(rows), fps, name=motion.name)
