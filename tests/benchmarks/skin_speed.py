"""Skinning on the processor: the default avatar, against a loop over joints with 4 × 4 matrices."""

import time

import bench_motion  # noqa: F401  - it finds the package
import numpy as np

from qmd_studio import assets
from qmd_studio.avatar.dressed import dress
from qmd_studio.avatar.skinning import skin_matrices, skinned
from qmd_studio.registry import default_body, open_file

ROUNDS = 15


def plain(surface, matrices):
    """The formula as it is written: each joint moves every vertex, by its weight."""
    vertices = np.concatenate([surface.vertices, np.ones((len(surface.vertices), 1))], axis=1)
    posed = np.zeros((len(vertices), 3))
    for joint, matrix in enumerate(matrices):
        weight = np.where(surface.joints == joint, surface.weights, 0.0).sum(axis=1)
        posed += weight[:, None] * (vertices @ matrix.T)[:, :3]
    return posed


def fastest(work):
    best = np.inf
    for _ in range(ROUNDS):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return 1000 * best


def main():
    body = default_body()
    motion = open_file(assets.resource("motions", "wave.bap")).motion
    matrices = skin_matrices(body, dress(motion, body).poses([60])[0])
    surface = body.surface
    off = np.abs(skinned(surface, matrices)[0] - plain(surface, matrices)).max()
    assert off < 1e-6, off
    ours, theirs = fastest(lambda: skinned(surface, matrices)), fastest(lambda: plain(surface, matrices))
    what = f"skinning on the processor, {len(surface.vertices):,} vertices, {len(surface.faces):,} triangles"
    print(f"{what} | {ours:.1f} ms | a loop over joints, no normals: {theirs:.1f} ms | {ours / theirs:.4f} | ")


if __name__ == "__main__":
    main()
