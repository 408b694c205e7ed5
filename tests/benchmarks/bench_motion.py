"""The motion of the codec's benchmarks, and how two ways to do one thing are timed against each other."""

import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

CORPUS = Path(os.environ.get("QMD_CORPUS") or ROOT.parent / "shared" / "corpus")
N_FRAMES = 2251
"""The paper's longest motion, "sword play"."""


def bench_motion():
    """Return 2,251 frames of 62 columns on 31 points: the end of 60_01 run backward to fill up, or a generated walk."""
    from qmd_studio.registry import open_file
    from tests.generated_motion import walker

    path = CORPUS / "cmu_asfamc" / "60_01.amc"
    if not path.exists():
        print(f"no {path}: a generated walk stands in")
        return walker(N_FRAMES)
    motion = open_file(path).motion
    missing = N_FRAMES - motion.n_frames
    return motion.with_values(np.concatenate([motion.X, motion.X[-2 : -2 - missing : -1]]))


def alternate(first, second, rounds=31):
    """Return the median milliseconds of both, run in turns so that a busy moment hits both alike."""
    took = ([], [])
    for do in (first, second):
        do()
    for _ in range(rounds):
        for times, do in zip(took, (first, second), strict=True):
            started = time.perf_counter()
            do()
            times.append(1e3 * (time.perf_counter() - started))
    return tuple(statistics.median(times) for times in took)
