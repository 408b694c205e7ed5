"""The exhaustive search of a wide grid, against a straightforward evaluation of a sample of it."""

import random
import time

from bench_motion import CORPUS
from plain_search import plain_evaluation

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.registry import open_file
from qmd_studio.tuning.encoders import PLAIN_CLOSED
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import wide_grid
from qmd_studio.tuning.search import search
from tests.generated_motion import walker

N_SAMPLE = 60
ROUNDS = 3
"""The best of these counts: others use the cores too."""

BARS = {"all": "at most 8 s; at least 50 x", "bounded": "at most 2 s; at least 50 x"}


def main():
    path = CORPUS / "cmu_asfamc" / "02_01.amc"
    motion = open_file(path).motion if path.exists() else walker(343)
    bounded = wide_grid(motion)
    for encoder in (Encoder.PAPER, PLAIN_CLOSED):
        evaluator = evaluator_for(motion, QmdSettings(encoder=encoder))
        evaluator.try_bits(6, 0, (8,))  # compiled before the clock starts
        for size, grid in (("all", bounded.unbounded()), ("bounded", bounded)):
            outcome = min((exhaustive(evaluator, grid) for _ in range(ROUNDS)), key=lambda one: one.seconds)
            plain_ms = plain_milliseconds(motion, encoder, outcome.trials)
            ours_ms = 1e3 * outcome.seconds / outcome.evaluations
            print(
                f"exhaustive search, walk, {encoder} encoder, {size}: {outcome.evaluations:,} settings | "
                f"{outcome.seconds:.2f} s, {ours_ms:.3f} ms each | plain NumPy: {plain_ms:.1f} ms each | "
                f"{plain_ms / ours_ms:.0f} x | {BARS[size]}"
            )
        found = search(evaluator, bounded)
        excess = found.best.merit / outcome.best.merit - 1
        print(
            f"search, walk, {encoder} encoder, bounded | {found.seconds:.3f} s, {found.evaluations} evaluations | "
            f"exhaustive: {outcome.evaluations:,} | {100 * excess:+.2f} % | at most + 1 %, 120 evaluations"
        )


def plain_milliseconds(motion, encoder, trials):
    """Return the mean time of a straightforward evaluation, over a sample of what was tried; check that it agrees."""
    sample = random.Random(1).sample(sorted(trials, key=lambda t: (t.paper.fdf, t.paper.bits, t.bytes)), N_SAMPLE)
    positions = point_positions(motion.skeleton, motion.X)
    started = time.perf_counter()
    errors = [plain_evaluation(motion, positions, trial.paper) for trial in sample]
    took = time.perf_counter() - started
    off = max(abs(error - trial.def_) / (trial.def_ + 1e-4) for error, trial in zip(errors, sample, strict=True))
    print(f"straightforward evaluation of {N_SAMPLE} settings differs by at most {off:.1%}")
    return 1e3 * took / N_SAMPLE


if __name__ == "__main__":
    main()
