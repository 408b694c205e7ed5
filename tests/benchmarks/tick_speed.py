"""One slider tick, from settings to DEF: the tuning session against the plain NumPy pass."""

import itertools

from bench_motion import alternate, bench_motion
from plain_tick import plain_tick

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.tuning.session import TuningSession


def main():
    motion = bench_motion()
    session = TuningSession(motion)
    positions = point_positions(motion.skeleton, motion.X)
    drag = itertools.cycle((5, 6, 7, 8))  # a slider that is dragged never asks the same thing twice running

    def ours():
        return session.evaluate(QmdSettings(fdf=next(drag))).error

    def plain():
        return plain_tick(motion, positions, fdf=next(drag), bits=8)

    error = session.evaluate(QmdSettings()).error
    def_, mean, p99, worst = plain_tick(motion, positions, fdf=6, bits=8)
    print(f"ours:  DEF {error.def_:.4f}, mean {error.mean_mm:.3f}, p99 {error.p99_mm:.3f}, max {error.max_mm:.2f} mm")
    print(f"plain: DEF {def_:.4f}, mean {mean:.3f}, p99 {p99:.3f}, max {worst:.2f} mm")
    row("slider tick, 2,251 × 62 × 31", *alternate(ours, plain), "at most 0.1")
    for title, settings in (
        ("slider tick, b 16", QmdSettings(bits=16)),
        ("slider tick, segments of 60", QmdSettings(segment=60)),
        ("slider tick, the paper's encoder", QmdSettings(encoder=Encoder.PAPER)),
    ):
        row(title, *alternate(lambda chosen=settings: session.evaluate(chosen), plain, 11), "")


def row(title, ours_ms, plain_ms, bar):
    print(f"{title} | {ours_ms:.2f} ms | plain NumPy at b 8: {plain_ms:.1f} ms | {ours_ms / plain_ms:.3f} | {bar}")


if __name__ == "__main__":
    main()
