"""What the compact profile takes on the raw CMU clips, next to a simple coder: an explicit long run, some minutes.

    python tests/benchmarks/compact_sizes.py [clip…]

Bytes a frame of complete files at four mean joint errors: header, payload and all, the skeleton block left out (it is
the same for every codec), geometric mean over the clips. The simple coder is second-order differences in steps by
sensitivity, all columns in one stream of pcodec; its header counts as the same 64 bytes.
"""

import sys
import time

import numpy as np
from bench_motion import CORPUS
from pcodec import ChunkConfig, standalone

from qmd_studio.codecs.compact.attempt import Meter
from qmd_studio.codecs.compact.sensitivity import sensitivities, step_codes
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.synthesis import step_sizes
from qmd_studio.codecs.compact.target import meet_target
from qmd_studio.codecs.qmd.container import HEADER
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.registry import open_file

TARGETS_MM = (0.1, 0.2, 0.5, 1.0)
BARS = {"segments of 120": (31, 24, 16, 11), "whole clip": (None, None, 12, 7.7)}
SIMPLE = "second order, pcodec, whole clip"


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
        for target in TARGETS_MM:
            rows.setdefault((SIMPLE, target), []).append(simple(motion, target))
        print(name, " ".join(f"{rows[label, t][-1][0]:.2f}" for label in BARS for t in TARGETS_MM), flush=True)
    for label, bars in (BARS | {SIMPLE: (41, 33, 25, 20)}).items():
        found = [np.exp(np.mean(np.log(np.array(rows[label, t])), axis=0)) for t in TARGETS_MM]
        print(f"{label}: bytes a frame", " / ".join(f"{f[0]:.2f}" for f in found), "bar", bars)
        print(
            "   mean mm", " / ".join(f"{f[1]:.3f}" for f in found), " max mm", " / ".join(f"{f[2]:.2f}" for f in found)
        )


def simple(motion, target):
    """Return size a frame, mean and largest mm, seconds, of second-order differences through pcodec."""
    started = time.perf_counter()
    matrix = codec_matrix(motion).astype(np.float64)
    every = [H for part in sensitivities(motion, segment=0, block=30) for H in part.blocks]
    minded = np.sqrt(np.diag(np.mean(every, axis=0)))
    steps = 1 / np.maximum(minded, np.percentile(minded, 8))
    meter, fineness, best = Meter(motion), 2 * target / 56.44, None
    for _ in range(8):
        codes = step_codes(fineness * steps, np.abs(matrix).max(axis=0))
        size = step_sizes(codes).astype(np.float64)
        whole = np.rint(matrix / size).astype(np.int64)
        distances = meter.distances_mm((whole * size).astype(np.float32))
        error = distances.mean()
        if error <= target and (best is None or fineness > best[0]):
            best = fineness, whole, error, distances.max()
        if best and best[2] > 0.985 * target:
            break
        fineness *= 0.995 * target / error
    second = np.diff(whole := best[1], n=2, axis=0) if len(whole) > 2 else whole
    settings = ChunkConfig(compression_level=8)
    stream = standalone.simple_compress(np.ascontiguousarray(second.T.ravel().astype(np.int32)), settings)
    n_bytes = HEADER.size + 12 + whole.shape[1] + 4 * whole[:2].size + len(stream)
    return n_bytes / len(whole), best[2], best[3], time.perf_counter() - started


if __name__ == "__main__":
    main()
