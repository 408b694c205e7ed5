"""A drag step of inverse kinematics, 141 columns and 5 effectors, against least_squares of SciPy on the same task."""

import time

import bench_motion  # noqa: F401 - finds the package
import numpy as np
from scipy.optimize import least_squares

from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.ik import IkSettings, solve_pose, spine_stiffness
from qmd_studio.motion.ik_targets import Effector, misses_of, pinned, targets_of
from qmd_studio.motion.kinematics import node_positions, rest_values

N_ACTIVE = 141
N_STEPS = 150
DISPLAY_FRAME_MS = 1000 / 60


def main():
    skeleton = bap_skeleton()
    node = skeleton.node_names.index
    rest = rest_values(skeleton)
    places = node_positions(skeleton, rest[None])[0]
    active = np.zeros(skeleton.n_columns, dtype=bool)
    active[:N_ACTIVE] = True
    options = IkSettings(active=active, stiffness=spine_stiffness(skeleton, 3.0))
    held = [pinned(skeleton, rest, node(name)) for name in ("l_ankle", "r_ankle", "r_wrist")]
    held.append(Effector(node("skull_tip"), places[node("skull_tip")]))
    turn = np.linspace(0, 2 * np.pi, N_STEPS)
    circle = 0.25 * np.stack([np.sin(turn), 1 - np.cos(turn), np.sin(turn)], axis=1)
    path = places[node("l_wrist")] + circle
    solve_pose(skeleton, rest, held, options)
    pose, ours, theirs, missed, iterations = rest, [], [], [], []
    for step, place in enumerate(path):
        effectors = [*held, Effector(node("l_wrist"), place)]
        started = time.perf_counter()
        solution = solve_pose(skeleton, pose, effectors, options)
        ours.append(1e3 * (time.perf_counter() - started))
        missed.append(solution.metres.max())
        iterations.append(solution.iterations)
        if step % 30 == 10:
            started = time.perf_counter()
            reference(skeleton, pose, effectors, options)
            theirs.append(1e3 * (time.perf_counter() - started))
        pose = solution.pose
    print(
        f"worst miss {1e3 * max(missed):.4f} mm, {np.mean(iterations):.1f} steps, 95 % {np.percentile(ours, 95):.2f} ms"
    )
    median, other = np.median(ours), np.median(theirs)
    title = f"inverse kinematics, a drag step, {N_ACTIVE} columns, 5 effectors"
    bar = f"at most {DISPLAY_FRAME_MS:.1f} ms"
    print(f"{title} | {median:.2f} ms | SciPy, bounds, same Jacobian: {other:.0f} ms | {median / other:.4f} | {bar}")


def reference(skeleton, start, effectors, options):
    targets = targets_of(skeleton, effectors)
    columns = np.flatnonzero(options.active)
    spring = options.pull * options.stiffness[columns]
    limits = np.array([skeleton.columns[c].limits or (-np.inf, np.inf) for c in columns])

    def at(values):
        pose = start.copy()
        pose[columns] = values
        return misses_of(targets, pose)

    return least_squares(
        lambda values: np.concatenate([at(values).residual, spring * (values - start[columns])]),
        np.clip(start[columns], limits[:, 0] + 1e-9, limits[:, 1] - 1e-9),
        jac=lambda values: np.concatenate([at(values).jacobian[:, columns], np.diag(spring)]),
        bounds=limits.T,
    )


if __name__ == "__main__":
    main()
