"""What the compact profile takes on the raw CMU clips, next to a simple coder: an explicit long run, some minutes.

    python tests/benchmarks/compact_sizes.py [clip…]

Bytes a frame of complete files at four mean joint errors: header, payload and all, the skeleton block left out (it is
the same for every codec), geometric mean over the clips. The simple coder is second-order differences in steps by
sensitivity, closed loop, all columns in one stream of pcodec; its header counts as the same 64 bytes.
"""

import sys
import time

import numpy as np
from bench_motion import CORPUS

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.target import meet_target
from qmd_studio.codecs.qmd.container import HEADER
from qmd_studio.registry import open_file

TARGETS_MM = (0.1, 0.2, 0.5, 1.0)
BARS = {"segments of 120": (31, 24, 16, 11), "whole clip": (None, None, 12, 7.7)}


def main():
    names = sys.argv[1:] or sorted(p.stem for p in (CORPUS / "cmu_asfamc").glob("*.amc") if "crlf" not in p.stem)
    rows = {}
    for name in names:
        motion = open_file(CORPUS / "cmu_asfamc" / f"{name}.amc").motion
        for label, segment in (("segments of 120", 120), ("whole clip", 0)):
            for target in TARGETS_MM:
                started = time.perf_counter()
                outcome = meet_target(motion, CompactSettings(mean_error_mm=target, segment=segment))
                took = time.perf_counter() - started
                size = (HEADER.size + len(outcome.payload)) / motion.n_frames
                rows.setdefault((label, target), []).append((size, outcome.mean_mm, outcome.max_mm, took))
        print(name, " ".join(f"{rows[label, t][-1][0]:.2f}" for label in BARS for t in TARGETS_MM), flush=True)
    for label, bars in BARS.items():
        found = [np.exp(np.mean(np.log(np.array(rows[label, t])), axis=0)) for t in TARGETS_MM]
        print(f"{label}: bytes a frame", " / ".join(f"{f[0]:.2f}" for f in found), "bar", bars)
        print(
            "   mean mm", " / ".join(f"{f[1]:.3f}" for f in found), " max mm", " / ".join(f"{f[2]:.2f}" for f in found)
        )


if __name__ == "__main__":
    main()
