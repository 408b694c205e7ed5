"""Forward kinematics of 2,251 × 62 × 31, compiled against plain NumPy, and one measure and one pose beside it."""

from bench_motion import alternate, bench_motion

from qmd_studio.motion import fast_kinematics as fast
from qmd_studio.motion import kinematics as plain
from qmd_studio.motion.fast_metrics import measure_positions
from qmd_studio.motion.metrics import measure


def main():
    motion = bench_motion()
    skeleton, X = motion.skeleton, motion.X
    Xt = fast.columns_first(X)
    decoded = motion.with_values(X + 1e-3)
    ours, theirs = (
        fast.point_positions_32(skeleton, Xt),
        fast.point_positions_32(skeleton, fast.columns_first(decoded.X)),
    )

    def numpy_points():
        return plain.point_positions(skeleton, X)

    row("forward kinematics, float32", lambda: fast.point_positions_32(skeleton, Xt), numpy_points, "at most 0.333")
    row("forward kinematics, float64", lambda: fast.point_positions_64(skeleton, X), numpy_points, "")
    row(
        "all joints' matrices, float64",
        lambda: fast.world_from_joint_fast(skeleton, X),
        lambda: plain.world_from_joint(skeleton, X),
        "",
    )
    row(
        "all joints' matrices of one frame",
        lambda: fast.world_from_joint_fast(skeleton, X[:1]),
        lambda: plain.world_from_joint(skeleton, X[:1]),
        "",
    )
    row(
        "measuring, positions given against motions given",
        lambda: measure_positions(skeleton, ours, theirs, fps=motion.fps),
        lambda: measure(motion, decoded),
        "",
    )


def row(title, compiled, reference, bar):
    ours_ms, reference_ms = alternate(compiled, reference)
    print(f"{title} | {ours_ms:.3f} ms | NumPy: {reference_ms:.3f} ms | {ours_ms / reference_ms:.3f} | {bar}")


if __name__ == "__main__":
    main()
