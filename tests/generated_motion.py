"""Motions made by formula, where there is no corpus: a walker of 31 joints and 62 columns, as CMU's AMCs have."""

import numpy as np

from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind

_LEG = (("hipjoint", "root", (0.09, -0.09, 0.0), ""), ("femur", "hipjoint", (0.12, -0.4, 0.0), "xyz"),
        ("tibia", "femur", (0.12, -0.4, 0.0), "x"), ("foot", "tibia", (0.0, -0.05, 0.12), "xz"),
        ("toes", "foot", (0.0, 0.0, 0.06), "x"))  # fmt: skip
_ARM = (("clavicle", "thorax", (0.18, 0.04, 0.0), "yz"), ("humerus", "clavicle", (0.3, 0.0, 0.0), "xyz"),
        ("radius", "humerus", (0.18, 0.0, 0.0), "x"), ("wrist", "radius", (0.09, 0.0, 0.0), "y"),
        ("hand", "wrist", (0.05, 0.0, 0.0), "xz"), ("fingers", "hand", (0.04, 0.0, 0.0), "x"),
        ("thumb", "wrist", (0.04, 0.0, 0.05), "xz"))  # fmt: skip
_SPINE = (("lowerback", "root", (0.0, 0.12, 0.0), "xyz"), ("upperback", "lowerback", (0.0, 0.12, 0.0), "xyz"),
          ("thorax", "upperback", (0.0, 0.12, 0.0), "xyz"), ("lowerneck", "thorax", (0.0, 0.08, 0.0), "xyz"),
          ("upperneck", "lowerneck", (0.0, 0.08, 0.0), "xyz"), ("head", "upperneck", (0.0, 0.09, 0.0), "xyz"),
          )  # fmt: skip
_SWING = {"femur": 0.5, "tibia": 0.6, "foot": 0.3, "toes": 0.2, "humerus": 0.4, "radius": 0.3, "thumb": 0.3}


def _bones():
    yield from _SPINE
    for bones in (_ARM, _LEG):
        for side, sign in (("r", -1.0), ("l", 1.0)):
            for name, parent, (x, y, z), turns in bones:
                inner = parent if parent in ("root", "thorax") else side + parent
                yield side + name, inner, (sign * x, y, z), turns


def walker_skeleton():
    """31 joints, 62 columns in AMC order, measured at the root and at the far end of each of the 30 bones."""
    bones = list(_bones())
    names = ["root", *(name for name, *_ in bones)]
    level, ends, first_child = {"root": 1}, {"root": (0.0, 0.0, 0.0)}, {}
    columns = [Column(f"root.t{a}", 0, ColumnKind.TRANSLATION, i) for i, a in enumerate("xyz")]
    columns += [Column(f"root.r{a}", 0, ColumnKind.ROTATION, i) for i, a in enumerate("xyz")]
    joints = [Joint("root", -1, (0.0, 0.0, 0.0), (5, 4, 3))]
    for index, (name, parent, end, turns) in enumerate(bones, start=1):
        level[name], ends[name] = level[parent] + 1, end
        first_child.setdefault(parent, index)
        product = tuple(range(len(columns) + len(turns) - 1, len(columns) - 1, -1))
        columns += [
            Column(f"{name}.r{a}", index, ColumnKind.ROTATION, "xyz".index(a), level=min(level[name], 6)) for a in turns
        ]
        joints.append(Joint(name, names.index(parent), ends[parent], product))
    leaves = [name for name in names[1:] if name not in first_child]
    sites = tuple(EndSite(f"{name}_end", names.index(name), ends[name]) for name in leaves)
    points = [0]
    points += [first_child[name] if name in first_child else len(names) + leaves.index(name) for name in names[1:]]
    return Skeleton(
        "walker", SkeletonKind.ASF, tuple(joints), sites, tuple(columns), tuple(points), metres_per_unit=ASF_UNIT_M
    )


def walker(n_frames=343, *, fps=120.0, seed=1):
    """A walk with a drifting course: smooth swings of every joint, a little captured-looking noise, wide lone steps."""
    skeleton = walker_skeleton()
    random = np.random.default_rng(seed)
    phase = 2 * np.pi * 0.9 * np.arange(n_frames) / fps
    X = np.zeros((n_frames, skeleton.n_columns))
    for index, column in enumerate(skeleton.columns):
        reach = next((size for name, size in _SWING.items() if name in column.name), 0.06)
        for harmonic in (1, 2, 3):
            X[:, index] += reach / harmonic**2 * np.sin(harmonic * phase + random.uniform(0, 2 * np.pi))
        X[:, index] += np.cumsum(np.cumsum(random.normal(0, 2e-5 * reach, n_frames)))
    X[:, :3] *= 0.3
    X[:, 2] += 1.2 * np.arange(n_frames) / fps
    X[:, 1] += 0.95
    return Motion(skeleton, X, fps, "generated walk")
