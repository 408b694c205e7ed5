"""Motions of a few frames and columns, for golden files and damage."""

import numpy as np

from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind


def pendulum_skeleton():
    """A sliding root with one swinging arm, and a column that moves nothing."""
    return Skeleton(
        "pendulum",
        SkeletonKind.BVH,
        (Joint("root", -1, (0.0, 1.0, 0.0)), Joint("arm", 0, (0.0, 0.0, 0.0), (1,))),
        (EndSite("tip", 1, (0.0, -0.5, 0.0)),),
        (
            Column("root.tx", 0, ColumnKind.TRANSLATION, 0),
            Column("arm.rz", 1, ColumnKind.ROTATION, 2, level=2),
            Column("lamp", 0, ColumnKind.OPAQUE, 0, level=6),
        ),
        (0, 1, 2),
    )


def pendulum(n_frames=6):
    """The arm swings by eighths, the root slides by sixteenths of a metre, the lamp blinks."""
    frame = np.arange(n_frames)
    swing = np.array([0.0, 0.25, 0.5, 0.375, 0.125, -0.25])[frame % 6]
    return Motion(pendulum_skeleton(), np.stack([frame / 16, swing, frame % 2], axis=1), 30.0, "swing")
