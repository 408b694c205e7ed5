"""Frames a second of one body and of four at 1280×720 in the real viewport widget, after its quality has settled.

Run it on a screen or under xvfb-run. Every frame has a pose of its own, as in playback.
"""

import os
import statistics
import sys
import time
from dataclasses import dataclass, replace

import bench_motion
import numpy as np

if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
    sys.exit("render_speed needs a screen: xvfb-run -a python tests/benchmarks/render_speed.py")

from PySide6.QtCore import QPointF
from PySide6.QtWidgets import QApplication

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.dressed import dress
from qmd_studio.avatar.humanoid import Surface
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import default_body
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Look
from qmd_studio.ui.viewport import Viewport

SIZE = (1280, 720)
SETTLE, MEASURED = 60, 90
BAR_FPS, CROWD_BAR_FPS = 15, 6


def actors(motion, stride=4):
    body = bone_body(motion.skeleton)
    return [Actor(body, world) for world in world_from_joint(motion.skeleton, motion.X[: stride * 120 : stride])]


def default_actors():
    """The default avatar, its joints swaying a little."""
    skeleton = bap_skeleton()
    X = np.repeat(rest_values(skeleton)[None], 120, axis=0)
    turning = [c for c, column in enumerate(skeleton.columns) if column.unit == "rad"]
    X[:, turning] = 0.05 * np.sin(np.linspace(0, 12, 120))[:, None]
    dressed = dress(Motion(skeleton, X, 30.0), default_body())
    return [Actor(dressed.body, world) for world in dressed.poses(slice(None))]


def crowd(frames, n_bodies=4):
    """The same motion on so many bodies beside each other, each some frames behind the last."""
    scenes = []
    for k in range(len(frames)):
        row = []
        for number in range(n_bodies):
            actor = frames[(k + 9 * number) % len(frames)]
            world = actor.world_from_joint.copy()
            world[:, 0, 3] += 0.9 * (number - (n_bodies - 1) / 2)
            row.append(replace(actor, world_from_joint=world))
        scenes.append(row)
    return scenes


def dense(frames, n_faces=20_000):
    """The same bodies with so many triangles at least: the largest are cut in two, over and over."""
    body = frames[0].body
    while len(body.surface.faces) < n_faces:
        body = replace(body, surface=cut(body.surface, n_faces - len(body.surface.faces)))
    return [replace(actor, body=body) for actor in frames]


def cut(surface, n_more):
    """Cut up to `n_more` of the largest triangles through the middle of their first side."""
    corners = surface.vertices[surface.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    largest = np.argsort(-areas)[:n_more]
    a, b, c = surface.faces[largest].T
    new = len(surface.vertices) + np.arange(len(largest))
    faces = surface.faces.copy()
    faces[largest] = np.stack([new, b, c], axis=1)
    faces = np.concatenate([faces, np.stack([a, new, c], axis=1)])

    def between(values):
        return np.concatenate([values, (values[a] + values[b]) / 2])

    joints, weights = (np.concatenate([part, part[a]]) for part in (surface.joints, surface.weights))
    normals = between(surface.normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return Surface(between(surface.vertices), normals, faces, between(surface.colours), joints, weights)


def measure(application, scenes, look):
    view = Viewport()
    view.set_look(look)
    view.resize(*SIZE)
    view.show()
    application.processEvents()
    times, picks = [], []
    busy = 0.0
    for k in range(SETTLE + MEASURED):
        started, worked = time.perf_counter(), time.process_time()
        view.set_actors(scenes[k % len(scenes)])
        view.repaint()
        application.processEvents()
        if k >= SETTLE:
            times.append(time.perf_counter() - started)
            busy += time.process_time() - worked
    for k in range(MEASURED // 3):
        started = time.perf_counter()
        view.hit(QPointF(SIZE[0] / 2 + k, SIZE[1] / 2))
        picks.append(time.perf_counter() - started)
    controller, name = view._quality, view._renderer.name
    rung = LADDER.index(controller.quality) if controller else -1
    view.close()
    slow = 1 / statistics.quantiles(times, n=20)[-1]
    return Speed(
        1 / statistics.mean(times), slow, 1e3 * busy / len(times), 1e3 * statistics.median(picks[5:]), rung, name
    )


@dataclass(frozen=True)
class Speed:
    fps: float
    slow_fps: float
    cpu_ms: float
    pick_ms: float
    rung: int
    renderer: str


def main():
    application = QApplication(sys.argv)
    default, cmu = default_actors(), actors(bench_motion.bench_motion())
    four = crowd(dense(default))
    for title, scenes, look, bar in (
        ("default body", [[actor] for actor in default], Look.SOLID, BAR_FPS),
        ("CMU body", [[actor] for actor in cmu], Look.SOLID, BAR_FPS),
        ("four bodies", four, Look.SOLID, CROWD_BAR_FPS),
        ("four bodies, X-ray", four, Look.XRAY, CROWD_BAR_FPS),
    ):
        speed = measure(application, scenes, look)
        n_faces = len(scenes[0][0].body.surface.faces)
        each = "" if len(scenes[0]) == 1 else " each"
        detail = (
            f"{speed.slow_fps:.0f} in the slowest 5 %; {speed.cpu_ms:.0f} ms of processor a frame; "
            f"{n_faces} triangles{each}; "
            f"quality {speed.rung} of {len(LADDER) - 1}; {speed.renderer}"
        )
        print(f"{title} at 1280×720 | {speed.fps:.1f} fps | {detail} | {speed.fps / bar:.1f} | at least 1 of {bar} fps")
        frame_ms = 1e3 / speed.fps
        print(
            f"what is under the mouse, {title} | {speed.pick_ms:.1f} ms | a frame: {frame_ms:.1f} ms "
            f"| {speed.pick_ms / frame_ms:.2f} | at most 1 frame"
        )


if __name__ == "__main__":
    main()
