"""Opening generated H-Anim figures: of 1 MB, of 20,000 vertices as the default avatar has, and with a long motion."""

import time
from xml.etree import ElementTree

import bench_motion  # noqa: F401  - it finds the package
import numpy as np

from qmd_studio.avatar.humanoid import Body, Surface
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.formats.scene_graph import Encoding
from qmd_studio.motion.hanim import hanim_joints
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Joint, Skeleton, SkeletonKind

AVATAR_VERTICES = 20_000
MEGABYTE_VERTICES = 6_300
N_FRAMES = 2_751
RUNS = 7


def figure(n_vertices, around=100):
    """Return a tube of a body: three joints of the level-3 skeleton a vertex, two colours."""
    rng = np.random.default_rng(1)
    rows = n_vertices // around
    turn, height = np.meshgrid(2 * np.pi * np.arange(around) / around, np.linspace(0, 1.75, rows))
    normals = np.stack([np.cos(turn), 0 * turn, np.sin(turn)], axis=-1).reshape(-1, 3).astype(np.float32)
    vertices = 0.2 * normals + np.stack([0 * turn, height, 0 * turn], axis=-1).reshape(-1, 3)
    vertices += rng.normal(0, 0.005, vertices.shape)
    row, column = (part.ravel() for part in np.meshgrid(np.arange(rows - 1), np.arange(around), indexing="ij"))
    a, b = row * around + column, row * around + (column + 1) % around
    faces = np.concatenate([np.stack([a, a + around, b], axis=1), np.stack([b, a + around, b + around], axis=1)])
    names = [joint.name for joint in hanim_joints()]
    centres = np.array([joint.centre for joint in hanim_joints()])
    parents = [names.index(joint.parent) if joint.parent else -1 for joint in hanim_joints()]
    offsets = [
        centre - (centres[parent] if parent >= 0 else 0) for centre, parent in zip(centres, parents, strict=True)
    ]
    joints = tuple(Joint(n, p, tuple(o.tolist())) for n, p, o in zip(names, parents, offsets, strict=True))
    bind = np.tile(np.eye(4), (len(names), 1, 1))
    bind[:, :3, 3] = centres
    follows = np.argsort(rng.random((len(vertices), len(names))), axis=1)[:, :3]
    weights = rng.dirichlet(np.ones(3), len(vertices)).astype(np.float32)
    colours = np.where((np.arange(len(vertices)) % 7 < 3)[:, None], [0.5, 0.3, 0.2], [0.1, 0.2, 0.6])
    surface = Surface(vertices.astype(np.float32), normals, faces, colours.astype(np.float32), follows, weights)
    return Body("tube", Skeleton("tube", SkeletonKind.HANIM, joints, (), (), (0,)), surface, bind)


def plain(data):
    """Parse the XML and turn every attribute that is one into numbers: what no reader can leave out."""
    for element in ElementTree.fromstring(data).iter():
        for text in element.attrib.values():
            try:
                np.array(text.split(), dtype=np.float64)
            except ValueError:
                continue


def least_ms(work):
    """Return the least processor time of some runs, in milliseconds."""
    spent = []
    for _ in range(RUNS):
        before = time.process_time()
        work()
        spent.append(1000 * (time.process_time() - before))
    return min(spent)


def main():
    for title, count, bar in (("1 MB", MEGABYTE_VERTICES, ""), ("20,000 vertices", AVATAR_VERTICES, "within 120 ms")):
        body = figure(count)
        for encoding in Encoding:
            data = figure_bytes(body, None, encoding)
            ours = least_ms(lambda data=data: read_figure(data, ReadOptions()))
            row = f"opening a body of {title}, {encoding}, {len(data) / 1e6:.2f} MB | {ours:.1f} ms"
            if encoding is Encoding.XML:
                reference = least_ms(lambda data=data: plain(data))
                print(f"{row} | XML and numbers alone: {reference:.1f} ms | {ours / reference:.2f} | {bar}")
            else:
                print(f"{row} | | | {bar}")
    data = long_motion()
    ours, reference = least_ms(lambda: read_figure(data, ReadOptions())), least_ms(lambda: plain(data))
    title = f"opening an HAnimMotion, {N_FRAMES} frames x 94 joints, {len(data) / 1e6:.2f} MB"
    print(f"{title} | {ours:.0f} ms | XML and numbers alone: {reference:.0f} ms | {ours / reference:.2f} | ")


def long_motion():
    """Return an X3D file of a small body whose joints all turn, each at a pace of its own."""
    opened = read_figure(figure_bytes(figure(300), None, Encoding.XML), ReadOptions())
    skeleton = opened.skeleton
    pace = np.random.default_rng(2).uniform(0.2, 1.2, skeleton.n_columns)
    X = 0.6 * np.sin(pace * np.arange(N_FRAMES)[:, None] / 30)
    return figure_bytes(opened.body, Motion(skeleton, X, 120.0), Encoding.XML)


if __name__ == "__main__":
    main()
