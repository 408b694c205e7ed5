"""Frames a second of one body at 1280×720 in the real viewport widget, after its quality has settled.

Run it on a screen or under xvfb-run. Every frame has a pose of its own, as in playback.
"""

import os
import statistics
import sys
import time

import bench_motion
import numpy as np

if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
    sys.exit("render_speed needs a screen: xvfb-run -a python tests/benchmarks/render_speed.py")

from PySide6.QtWidgets import QApplication

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor
from qmd_studio.ui.viewport import Viewport

SIZE = (1280, 720)
SETTLE, MEASURED = 60, 90
BAR_FPS = 15


def actors(motion, stride=4):
    body = bone_body(motion.skeleton)
    return [Actor(body, world) for world in world_from_joint(motion.skeleton, motion.X[: stride * 120 : stride])]


def default_actors():
    skeleton = bap_skeleton()
    X = np.repeat(rest_values(skeleton)[None], 120, axis=0)
    turning = [c for c, column in enumerate(skeleton.columns) if column.unit == "rad"]
    X[:, turning] = 0.05 * np.sin(np.linspace(0, 12, 120))[:, None]
    body = bone_body(skeleton)
    return [Actor(body, world) for world in world_from_joint(skeleton, X)]


def measure(application, frames):
    view = Viewport()
    view.resize(*SIZE)
    view.show()
    application.processEvents()
    times = []
    for k in range(SETTLE + MEASURED):
        started = time.perf_counter()
        view.set_actors([frames[k % len(frames)]])
        view.repaint()
        application.processEvents()
        if k >= SETTLE:
            times.append(time.perf_counter() - started)
    controller, name = view._quality, view._renderer.name
    rung = LADDER.index(controller.quality) if controller else -1
    view.close()
    return 1 / statistics.mean(times), 1 / statistics.quantiles(times, n=20)[-1], rung, name


def main():
    application = QApplication(sys.argv)
    for title, frames in (("default body", default_actors()), ("CMU body", actors(bench_motion.bench_motion()))):
        fps, slow, rung, name = measure(application, frames)
        n_faces = len(frames[0].body.surface.faces)
        detail = f"{slow:.0f} in the slowest 5 %; {n_faces} triangles; quality {rung} of {len(LADDER) - 1}; {name}"
        print(f"{title} at 1280×720 | {fps:.1f} fps | {detail} | {fps / BAR_FPS:.1f} | at least 1 of {BAR_FPS} fps")


if __name__ == "__main__":
    main()
