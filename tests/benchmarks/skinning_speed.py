"""Skinning of 20,000 vertices, three joints each: on the processor, and by the renderer's vertex shader.

The renderer draws into a picture so small that hardly anything but the vertices costs time; an empty stage is drawn
between, and its time taken off.
"""

import statistics
import time

import bench_motion  # noqa: F401 - finds the package
import numpy as np
from hanim_speed import AVATAR_VERTICES, figure

from qmd_studio.avatar.skinning import skin_matrices, skinned
from qmd_studio.motion.rotation import euler_matrix
from qmd_studio.render.camera import Camera
from qmd_studio.render.gl import GraphicsError
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Scene

RUNS = 31
SIZE = (16, 16)


def poses(body):
    """Return world_from_joint (RUNS, J, 4, 4): every joint turned a little about its own place."""
    world = np.repeat(body.bind[None], RUNS, axis=0)
    turns = np.random.default_rng(4).uniform(-0.3, 0.3, (RUNS, len(body.bind), 3))
    world[..., :3, :3] = euler_matrix(turns, "zyx")
    return world


def plain(surface, matrices):
    """The formula as it is written, vertex by joint, without normals."""
    blended = (surface.weights[..., None, None] * matrices[surface.joints]).sum(axis=1)
    ones = np.ones((len(surface.vertices), 1))
    return np.einsum("vij,vj->vi", blended, np.concatenate([surface.vertices, ones], axis=1))[:, :3]


def drawing_ms(renderer, body, worlds):
    """Return the median time of a picture of the body less that of an empty stage, in milliseconds."""
    camera = Camera().frame(body.surface.vertices, 1.0)
    spent = {True: [], False: []}
    for world in worlds:
        for full in (True, False):
            scene = Scene((Actor(body, world),) if full else (), show_ground=False, show_axes=False)
            started = time.perf_counter()
            renderer.picture(scene, camera, SIZE, quality=LADDER[3])
            spent[full].append(1e3 * (time.perf_counter() - started))
    return statistics.median(spent[True][3:]) - statistics.median(spent[False][3:])


def main():
    body = figure(AVATAR_VERTICES)
    worlds = poses(body)
    ours, reference = [], []
    for world in worlds:
        matrices = skin_matrices(body, world)
        started = time.perf_counter()
        posed, _ = skinned(body.surface, matrices)
        middle = time.perf_counter()
        expected = plain(body.surface, matrices)
        ours.append(1e3 * (middle - started))
        reference.append(1e3 * (time.perf_counter() - middle))
    assert np.abs(posed - expected).max() < 1e-5
    ours, reference = statistics.median(ours), statistics.median(reference)
    title = f"skinning {AVATAR_VERTICES} vertices of three joints"
    print(f"{title}, processor, with normals | {ours:.1f} ms | plain NumPy, no normals: {reference:.1f} ms "
          f"| {ours / reference:.2f} | ")  # fmt: skip
    try:
        with OffscreenRenderer() as renderer:
            drawn, name = drawing_ms(renderer, body, worlds), renderer.renderer.name
    except GraphicsError as problem:
        print(f"no row for the renderer: {problem}")
        return
    print(f"{title}, renderer | {drawn:.1f} ms | processor: {ours:.1f} ms; {name} | {drawn / ours:.2f} "
          "| ")  # fmt: skip


if __name__ == "__main__":
    main()
