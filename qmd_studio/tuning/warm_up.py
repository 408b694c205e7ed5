"""Compile what the studio compiles, once after an install, so that nobody waits for it at the first slider.

Run as `python -m qmd_studio.tuning.warm_up`. Numba keeps the machine code beside the package or in the user's cache.
"""

from __future__ import annotations

import numpy as np

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.fast_kinematics import world_from_joint_fast
from qmd_studio.motion.kinematics import rest_values
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.retarget import retargeting
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings
from qmd_studio.tuning.lab_session import LabSession


def warm_up(n_frames: int = 400) -> None:
    """Encode, decode and measure a small motion with every profile and encoder of the lab, and put it on a body."""
    skeleton = bap_skeleton()
    steps = np.random.default_rng(0).normal(scale=1e-3, size=(n_frames, skeleton.n_columns))
    motion = Motion(skeleton, rest_values(skeleton) + np.cumsum(steps, axis=0), 30.0)
    world_from_joint_fast(skeleton, motion.X[:1])
    retargeting(skeleton, skeleton.scaled(0.7)).motion(motion)
    session = LabSession(motion)
    codings = [QmdSettings(encoder=encoder) for encoder in (Encoder.PAPER, Encoder.PLAIN, Encoder.CLOSED)]
    each: list[EncodeSettings] = [*map(EncodeSettings, codings), EncodeSettings(COMPACT_DEFAULT)]
    for settings in each:  # the bounded encoder has no code of its own that is compiled
        for draft in (True, False):
            report = session.evaluate(settings, draft=draft)
            _ = report.played, report.budget  # made when asked for


if __name__ == "__main__":
    warm_up()
