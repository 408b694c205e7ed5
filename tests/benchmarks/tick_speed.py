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
        return session.evaluate(QmdSettings(fdf=next(drag), encoder=Encoder.PLAIN)).error

    def plain():
        return plain_tick(motion, positions, fdf=next(drag), bits=8)

    error = session.evaluate(QmdSettings(encoder=Encoder.PLAIN)).error
    def_, mean, p99, worst = plain_tick(motion, positions, fdf=6, bits=8)
    print(f"ours:  DEF {error.def_:.4f}, mean {error.mean_mm:.3f}, p99 {error.p99_mm:.3f}, max {error.max_mm:.2f} mm")
    print(f"plain: DEF {def_:.4f}, mean {mean:.3f}, p99 {p99:.3f}, max {worst:.2f} mm")
    row("slider tick, 2,251 × 62 × 31, the plain loop", *alternate(ours, plain), "at most 0.1")
    for title, settings in (
        ("slider tick, the plain loop, b 16", QmdSettings(bits=16, encoder=Encoder.PLAIN)),
        ("slider tick, the plain loop, segments of 60", QmdSettings(segment=60, encoder=Encoder.PLAIN)),
        ("slider tick, the paper's encoder", QmdSettings(encoder=Encoder.PAPER)),
    ):
        row(title, *alternate(lambda chosen=settings: session.evaluate(chosen), plain, 11), "")
    for title, draft, bar in (
        ("slider tick, the closed loop's draft, while a slider is held", True, "at most 50 ms"),
        ("the closed loop's exact choice, when it is let go", False, ""),
    ):
        row(title, *alternate(lambda draft=draft: session.evaluate(QmdSettings(), draft=draft), plain, 11), bar)


def row(title, ours_ms, plain_ms, bar):
    print(f"{title} | {ours_ms:.2f} ms | plain NumPy at b 8: {plain_ms:.1f} ms | {ours_ms / plain_ms:.3f} | {bar}")


if __name__ == "__main__":
    main()
