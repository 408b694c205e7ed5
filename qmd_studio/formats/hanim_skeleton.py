"""The skeleton of an H-Anim figure, and motions on it from the turns and moves of its joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.formats.hanim_figure import Figure, level_of
from qmd_studio.formats.hanim_view import applied, label
from qmd_studio.motion.as_euler import euler_zyx
from qmd_studio.motion.hanim import table_rows
from qmd_studio.motion.skeleton import (
    IDENTITY,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Matrix3,
    Skeleton,
    SkeletonKind,
    Vector3,
)


def skeleton_of(figure: Figure, movers: Iterable[int] = (), displacers: Iterable[tuple[str, int]] = ()) -> Skeleton:
    """Return the figure's skeleton: x, y and z turns in each joint, moves of the roots and of `movers`.

    Columns are ordered by the paper's levels as the body animation parameters are; a joint of another name takes its
    depth in the tree as its level. `displacers` are (name, joint) of opaque columns at the end.
    """
    moving = set(movers) | {joint for joint, parent in enumerate(figure.parents) if parent < 0}
    levels = [level_of(figure, joint, _levels_by_name()) for joint in range(len(figure.joints))]
    offsets = _offsets(figure)
    columns: list[Column] = []
    products: list[tuple[int, ...]] = [()] * len(levels)
    for joint in sorted(range(len(levels)), key=lambda number: levels[number]):
        name, level = figure.names[joint], levels[joint]
        if joint in moving:
            columns += [
                Column(
                    f"{name} t{'xyz'[axis]}",
                    joint,
                    ColumnKind.TRANSLATION,
                    axis,
                    level=level,
                    rest=offsets[joint][axis],
                )
                for axis in range(3)
            ]
        first = len(columns)
        pairs = figure.limits[joint]
        limits = [None] * 3 if pairs is None else [(float(low), float(high)) for low, high in pairs]
        columns += [
            Column(f"{name} r{'xyz'[axis]}", joint, ColumnKind.ROTATION, axis, level=level, limits=limits[axis])
            for axis in range(3)
        ]
        products[joint] = (first + 2, first + 1, first)
    columns += [Column(name, joint, ColumnKind.OPAQUE, 0, level=levels[joint]) for name, joint in displacers]
    turn = _matrix(figure.frame)
    joints = tuple(
        Joint(name, parent, offset, product, turn if parent < 0 else IDENTITY)
        for name, parent, offset, product in zip(figure.names, figure.parents, offsets, products, strict=True)
    )
    sites = _sites(figure)
    measured = [len(joints) + number for number, site in enumerate(sites) if site.name.endswith("_tip")]
    return Skeleton(
        name=label(figure.humanoid) or "humanoid",
        kind=SkeletonKind.HANIM,
        joints=joints,
        end_sites=sites,
        columns=tuple(columns),
        points=(*range(len(joints)), *measured),
    )


def bind_of(figure: Figure) -> FloatArray:
    """Return world_from_joint at rest (n_joints, 4, 4): frames parallel to the humanoid's, at the centres."""
    bind = np.tile(np.eye(4), (len(figure.joints), 1, 1))
    bind[:, :3, :3] = figure.frame
    bind[:, :3, 3] = figure.in_metres(np.array(figure.centres))
    return bind


def motion_values(
    figure: Figure,
    skeleton: Skeleton,
    turns: Mapping[int, FloatArray],
    moves: Mapping[int, FloatArray],
    *,
    n_frames: int,
    spaces: FloatArray | None = None,
) -> FloatArray:
    """Return X (n_frames, n_columns) of joints that turn by `turns` (n_frames, 3, 3) and move by `moves` (n_frames, 3).

    Both are as in the file: in the figure's own units and axes. `spaces` (n_frames, 4, 4) takes the humanoid's space to
    metres where that moves too. A joint without either stays at rest. Turns may be angles (n_frames, 3) z, y, x.
    """
    X = np.zeros((n_frames, skeleton.n_columns))
    space = figure.space[None] if spaces is None else spaces
    linear = np.linalg.inv(figure.frame) @ figure.space[:3, :3]
    rows = {joint: list(row.product) for joint, row in enumerate(skeleton.joints)}
    for joint, turn in turns.items():
        X[:, rows[joint]] = turn if turn.ndim == 2 else euler_zyx(turn)
    if spaces is not None:
        _turn_roots(figure, X, rows, turns, spaces)
    for joint, columns in _translations(skeleton).items():
        move = moves.get(joint, np.zeros((1, 3)))
        if figure.parents[joint] < 0:
            place = figure.centres[joint] + move
            X[:, columns] = (
                np.einsum("fij,fj->fi", space[:, :3, :3], np.broadcast_to(place, (n_frames, 3))) + (space[:, :3, 3])
            )
        else:
            X[:, columns] = np.array(skeleton.joints[joint].offset) + move @ linear.T
    return X


def _turn_roots(
    figure: Figure, X: FloatArray, rows: dict[int, list[int]], turns: Mapping[int, FloatArray], spaces: FloatArray
) -> None:
    """Take what the humanoid itself turns by into its roots."""
    u, _, v = np.linalg.svd(spaces[:, :3, :3])
    own = np.linalg.inv(figure.frame) @ (u @ v)
    for joint, parent in enumerate(figure.parents):
        if parent < 0:
            turn = turns.get(joint, np.eye(3)[None])
            X[:, rows[joint]] = euler_zyx(np.broadcast_to(own @ turn, (len(X), 3, 3)))


def _translations(skeleton: Skeleton) -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for number, column in enumerate(skeleton.columns):
        if column.kind is ColumnKind.TRANSLATION:
            found.setdefault(column.joint, []).append(number)
    return found


def _sites(figure: Figure) -> tuple[EndSite, ...]:
    back = np.linalg.inv(figure.frame)
    centres = figure.in_metres(np.array(figure.centres))
    found = [
        EndSite(name, joint, _vector(back @ (applied(figure.space, place) - centres[joint])))
        for joint, name, place in figure.sites
    ]
    return tuple(sorted(found, key=lambda site: site.joint))


def _offsets(figure: Figure) -> list[Vector3]:
    """Return each joint's place from its parent's, in metres and the figure's axes; a root's place in the world."""
    places = figure.in_metres(np.array(figure.centres))
    back = np.linalg.inv(figure.frame)
    return [
        _vector(back @ (place - places[parent]) if parent >= 0 else place)
        for place, parent in zip(places, figure.parents, strict=True)
    ]


def _vector(values: FloatArray) -> Vector3:
    return (float(values[0]), float(values[1]), float(values[2]))


def _matrix(values: FloatArray) -> Matrix3:
    return (_vector(values[0]), _vector(values[1]), _vector(values[2]))


@lru_cache(maxsize=1)
def _levels_by_name() -> dict[str, int]:
    from qmd_studio.motion.hanim_names import canonical_joint

    levels = {row["joint"]: int(row["level"]) for row in table_rows("bap_levels.csv")}
    return {canonical_joint(name): level for name, level in levels.items()} | levels
