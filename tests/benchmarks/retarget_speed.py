"""Retargeting of CMU 01_01 (2,751 frames) to the BAP body, and of one frame as a window does while it plays."""

import statistics
import time

import bench_motion

from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.fast_kinematics import world_from_joint_fast
from qmd_studio.motion.retarget import retargeting
from qmd_studio.registry import open_file

FRAME_MS = 1000 / 60


def main():
    path = bench_motion.CORPUS / "cmu_asfamc" / "01_01.amc"
    motion = open_file(path).motion if path.exists() else bench_motion.bench_motion()
    skeleton, frames = motion.skeleton, motion.n_frames
    started = time.perf_counter()
    way = retargeting(skeleton, bap_skeleton())
    made_ms = 1e3 * (time.perf_counter() - started)
    result = median_ms(lambda: way.motion(motion), 7)
    length_ms = 1e3 * frames / motion.fps
    print(f"retargeting {frames} frames to 186 parameters | {result:.0f} ms | its length: {length_ms:.0f} ms "
          f"| {result / length_ms:.4f} | ")  # fmt: skip
    world = world_from_joint_fast(skeleton, motion.X)
    poses = median_ms(lambda: way.pose(world), 7)
    print(f"poses of {frames} frames, without values | {poses:.0f} ms | its length: {length_ms:.0f} ms "
          f"| {poses / length_ms:.4f} | ")  # fmt: skip
    one = median_ms(lambda: way.pose(world_from_joint_fast(skeleton, motion.X[1000:1001])), 301)
    print(f"one frame, from values to the body's matrices | {one:.3f} ms | a frame at 60 a second: {FRAME_MS:.1f} ms "
          f"| {one / FRAME_MS:.4f} | at most 0.2")  # fmt: skip
    print(f"making the retargeting | {made_ms:.0f} ms | | | ")


def median_ms(do, rounds):
    do()
    times = []
    for _ in range(rounds):
        started = time.perf_counter()
        do()
        times.append(1e3 * (time.perf_counter() - started))
    return statistics.median(times)


if __name__ == "__main__":
    main()
