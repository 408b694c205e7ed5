"""The figure of a glTF file: its joints as a skeleton, the pose its skin is bound at, and its animation as a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.gltf_animation import Track, sampled
from qmd_studio.formats.gltf_document import Document, name_of
from qmd_studio.formats.gltf_nodes import SCALE_MATTERS, Tree, local_matrices, rigid
from qmd_studio.motion.as_euler import euler_zyx
from qmd_studio.motion.channels import named_apart
from qmd_studio.motion.hanim import hanim_joints
from qmd_studio.motion.skeleton import (
    MAX_LEVEL,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Matrix3,
    Skeleton,
    SkeletonKind,
    Vector3,
    depths,
)

MAX_JOINT_FRAMES = 3_000_000
USUAL_JOINT_FRAMES = 400_000
"""So many poses of joints any file may ask for; of more only one that has at least as many numbers itself."""
_MOVES_M = 1e-6
_BLOCK = 256


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """J joints: `parents` by joint number, `world` (N, 4, 4) of all nodes at rest in metres, `rest` (J, 4, 4) rigid.

    `bind` (J, 4, 4) is what the surface is bound at once its vertices are multiplied by `scale`. `owner` gives for
    each node the number of the joint that carries it, -1 for none.
    """

    tree: Tree
    parents: tuple[int, ...]
    world: FloatArray
    rest: FloatArray
    bind: FloatArray
    scale: float
    owner: tuple[int, ...]


def figure_of(document: Document, tree: Tree, metres_per_unit: float) -> Figure:
    """Return the figure at rest; raises `FormatError` where scales flatten it or make it too large."""
    number = tree.joint_number()
    owner = [-1] * len(tree.entries)
    world = _globals(tree, local_matrices(tree.translation, tree.rotation, tree.scale), metres_per_unit)
    if not (np.abs(world) < 1e9).all():
        raise FormatError("the figure is too large", wanted="at most 1e9 m in size")
    for node in tree.order:
        above = int(tree.parent[node])
        owner[node] = number.get(node, owner[above] if above >= 0 else -1)
    joints = list(tree.joints)
    parents = tuple(owner[int(tree.parent[node])] if tree.parent[node] >= 0 else -1 for node in joints)
    rest = rigid(world[joints])
    bound = np.linalg.inv(rest)
    given = [k for k, node in enumerate(tree.skin_joints) if node in number]
    places = [number[tree.skin_joints[k]] for k in given]
    scale = metres_per_unit if not given else 1.0
    if given:
        nodes = [tree.skin_joints[k] for k in given]
        bound[places] = np.linalg.inv(rest[places]) @ world[nodes] @ tree.inverse_bind[given]
        scale = _common_scale(document, np.asarray(bound[places]))
        bound[places] = bound[places] @ np.diag([1 / scale, 1 / scale, 1 / scale, 1.0])
    if not (np.abs(np.linalg.det(bound[:, :3, :3])) > 1e-12).all():
        raise FormatError("a joint's scale flattens its skin", wanted="scales above 0")
    return Figure(tree, parents, world, rest, np.linalg.inv(bound), scale, tuple(owner))


def check_length(document: Document, tree: Tree, n_frames: int) -> None:
    """Raise `FormatError` for more poses than there is room for: two keys far apart ask for any number of them."""
    most = min(MAX_JOINT_FRAMES, max(USUAL_JOINT_FRAMES, document.numbers))
    if n_frames * len(tree.entries) > most * 4 or n_frames * len(tree.joints) > most:
        got = f"{n_frames} frames of {len(tree.joints)} joints"
        raise FormatError("the animation is too long", wanted=f"at most {most} poses of joints", got=got)


def posed(figure: Figure, tracks: list[Track], times: FloatArray, unit: float) -> tuple[FloatArray, FloatArray]:
    """Return for each frame and joint its turn against rest (F, J, 3, 3) and its offset (F, J, 3) metres."""
    tree = figure.tree
    turns = np.empty((len(times), len(tree.joints), 3, 3))
    offsets = np.empty((len(times), len(tree.joints), 3))
    for start in range(0, len(times), _BLOCK):
        part = slice(start, start + _BLOCK)
        turns[part], offsets[part] = _posed_block(figure, tracks, times[part], unit)
    return turns, offsets


def moving_joints(figure: Figure, offsets: FloatArray) -> BoolArray:
    """Return which joints (J,) have moves of their own: roots, and those whose offset changes."""
    rest = _rest_offsets(figure)
    size = max(1.0, float(np.abs(rest).max(initial=0.0)))
    away = np.abs(offsets - rest).max(axis=(0, 2), initial=0.0) > _MOVES_M * size
    return np.asarray(away | (np.array(figure.parents) < 0))


def skeleton_of(
    document: Document, figure: Figure, moving: BoolArray, *, opaque: list[tuple[str, int]], name: str
) -> Skeleton:
    """Return the skeleton: x, y, z moves of the joints that have them, then x, y, z turns, joint by joint.

    Turns multiply as Rz · Ry · Rx and follow the joint's rest orientation. It is of kind HANIM where most joints have
    names of H-Anim, else BVH. `opaque` columns, (name, joint), come last.
    """
    tree, rest = figure.tree, figure.rest
    names = [name_of(tree.entries[node], f"node {node}") for node in tree.joints]
    offsets = _rest_offsets(figure)
    depth = depths(figure.parents)
    columns: list[Column] = []
    joints = []
    for j, parent in enumerate(figure.parents):
        level = min(depth[j], MAX_LEVEL)
        if moving[j]:
            columns += [
                Column(f"{names[j]} t{'xyz'[a]}", j, ColumnKind.TRANSLATION, a, level=level, rest=float(offsets[j, a]))
                for a in range(3)
            ]
        first = len(columns)
        columns += [Column(f"{names[j]} r{'xyz'[a]}", j, ColumnKind.ROTATION, a, level=level) for a in range(3)]
        outer = rest[parent, :3, :3] if parent >= 0 else np.eye(3)
        turn = outer.T @ rest[j, :3, :3]
        turn = np.eye(3) if np.abs(turn - np.eye(3)).max() < 1e-6 else turn
        joints.append(Joint(names[j], parent, _vector(offsets[j]), (first + 2, first + 1, first), _matrix(turn)))
    columns += [Column(title, joint, ColumnKind.OPAQUE, 0, level=MAX_LEVEL) for title, joint in opaque]
    sites = _end_sites(figure)
    known = {joint.name for joint in hanim_joints()} | {"humanoid_root"}
    is_hanim = sum(joint_name in known for joint_name in names) > len(names) / 2
    return Skeleton(
        name=name,
        kind=SkeletonKind.HANIM if is_hanim else SkeletonKind.BVH,
        joints=tuple(joints),
        end_sites=sites,
        columns=named_apart(columns),
        points=tuple(range(len(joints) + len(sites))),
    )


def values_of(skeleton: Skeleton, turns: FloatArray, offsets: FloatArray) -> FloatArray:
    """Return X (F, n_columns) of the posed joints; opaque columns are 0."""
    X = np.zeros((len(turns), skeleton.n_columns))
    for number, joint in enumerate(skeleton.joints):
        local = np.array(joint.orientation).T @ turns[:, number]
        X[:, list(joint.product)] = euler_zyx(local)
    for index, column in enumerate(skeleton.columns):
        if column.kind is ColumnKind.TRANSLATION:
            X[:, index] = offsets[:, column.joint, column.axis]
    return X


def _globals(tree: Tree, local: FloatArray, unit: float) -> FloatArray:
    """Return world matrices (..., N, 4, 4) in metres of local ones."""
    world = np.empty_like(local)
    for node in tree.order:
        above = int(tree.parent[node])
        outer = world[..., above, :, :] if above >= 0 else np.diag([unit, unit, unit, 1.0])
        world[..., node, :, :] = outer @ local[..., node, :, :]
    return world


def _posed_block(figure: Figure, tracks: list[Track], times: FloatArray, unit: float) -> tuple[FloatArray, FloatArray]:
    tree = figure.tree
    parts = {"translation": tree.translation, "rotation": tree.rotation, "scale": tree.scale}
    moved = {path: np.repeat(values[None], len(times), axis=0) for path, values in parts.items()}
    for track in tracks:
        if track.path in moved:
            moved[track.path][:, track.node] = sampled(track, times)
    local = local_matrices(moved["translation"], moved["rotation"], moved["scale"])
    world = rigid(_globals(tree, local, unit)[:, list(tree.joints)])
    turns, offsets = world[..., :3, :3].copy(), world[..., :3, 3].copy()
    for j, parent in enumerate(figure.parents):
        if parent >= 0:
            outer = world[:, parent, :3, :3].swapaxes(1, 2)
            turns[:, j] = outer @ world[:, j, :3, :3]
            offsets[:, j] = np.einsum("fij,fj->fi", outer, world[:, j, :3, 3] - world[:, parent, :3, 3])
    return turns, offsets


def _rest_offsets(figure: Figure) -> FloatArray:
    offsets = figure.rest[:, :3, 3].copy()
    for j, parent in enumerate(figure.parents):
        if parent >= 0:
            offsets[j] = figure.rest[parent, :3, :3].T @ (figure.rest[j, :3, 3] - figure.rest[parent, :3, 3])
    return offsets


def _common_scale(document: Document, bound: NDArray[Any]) -> float:
    """Return the scale that all joints give to the skin, to be taken into its vertices."""
    scales = np.cbrt(np.abs(np.linalg.det(bound[:, :3, :3])))
    middle = float(np.median(scales))
    if not middle > 1e-9:
        raise FormatError("the joints' scales flatten the skin", wanted="scales above 0", got=f"{middle:g}")
    if np.abs(scales / middle - 1).max() > SCALE_MATTERS * 10:
        document.note("joints scale the skin differently; their scales are kept in the pose it is bound at")
    return middle if abs(middle - 1) > SCALE_MATTERS else 1.0


def _end_sites(figure: Figure) -> tuple[EndSite, ...]:
    """Return nodes without mesh or child that hang from a joint: the ends of its bones."""
    tree, chosen = figure.tree, set(figure.tree.joints)
    sites = []
    for node, entry in enumerate(tree.entries):
        above = int(tree.parent[node])
        if node in chosen or above not in chosen or entry.get("children") or {"mesh", "camera"} & entry.keys():
            continue
        joint = figure.owner[node]
        local = figure.rest[joint, :3, :3].T @ (figure.world[node, :3, 3] - figure.rest[joint, :3, 3])
        sites.append(EndSite(name_of(entry, f"node {node}"), joint, _vector(local)))
    return tuple(sites)


def _vector(values: FloatArray) -> Vector3:
    return (float(values[0]), float(values[1]), float(values[2]))


def _matrix(values: FloatArray) -> Matrix3:
    return (_vector(values[0]), _vector(values[1]), _vector(values[2]))
