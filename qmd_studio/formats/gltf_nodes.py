"""The nodes of a glTF file: their tree, how each stands in its parent, and which of them are the figure's joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.gltf_document import Document, Record, accessor, item, listed, name_of, numbers, record, whole

MAX_JOINTS = 4_000
SCALE_MATTERS = 1e-3
"""Scales nearer to 1 than this are rounding."""
_ORTHOGONAL = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """N nodes of the scene: `order` parents first, `parent` (N,) -1 for a root, and `joints` in the skeleton's order.

    `skin` is the skin's number or None; `skin_joints` the nodes that its meshes' joint numbers mean; `inverse_bind`
    (len(skin_joints), 4, 4). `figure` is the node that stands for the figure itself in files of the studio, or None.
    """

    entries: tuple[Record, ...]
    parent: IntArray
    order: tuple[int, ...]
    translation: FloatArray
    rotation: FloatArray
    scale: FloatArray
    joints: tuple[int, ...]
    skin: int | None
    skin_joints: tuple[int, ...]
    inverse_bind: FloatArray
    figure: int | None

    def joint_number(self) -> dict[int, int]:
        """Return the number in the skeleton of each joint's node."""
        return {node: number for number, node in enumerate(self.joints)}


def tree_of(document: Document, animated: set[int]) -> Tree:
    """Return the scene's nodes. Raises `FormatError` for a tree that goes round, or nodes that cannot be placed."""
    entries = tuple(item(document, "nodes", index) for index in range(len(listed(document.root, "nodes"))))
    parent = _parents(entries)
    order = _order(entries, parent)
    placed = [_placed(entry, f"node {index}") for index, entry in enumerate(entries)]
    skin, skin_joints, inverse_bind = _skin(document, len(entries))
    figure = _figure(document, skin_joints)
    chosen = _chosen(entries, parent, order, skin_joints=skin_joints, animated=animated, figure=figure)
    joints = tuple(node for node in order if node in chosen)
    given = tuple(node for node in skin_joints if node in chosen)
    if set(given) == chosen and len(given) == len(chosen) and _parents_first(given, parent):
        joints = given
    if not joints:
        raise FormatError("the file holds no figure", wanted="a skin with joints, or nodes with meshes or animation")
    if len(joints) > MAX_JOINTS:
        raise FormatError("the figure has too many joints", wanted=f"at most {MAX_JOINTS}", got=str(len(joints)))
    return Tree(
        entries,
        parent,
        order,
        translation=np.array([t for t, _, _ in placed]).reshape(-1, 3),
        rotation=np.array([r for _, r, _ in placed]).reshape(-1, 4),
        scale=np.array([s for _, _, s in placed]).reshape(-1, 3),
        joints=joints,
        skin=skin,
        skin_joints=skin_joints,
        inverse_bind=inverse_bind,
        figure=figure,
    )


def turn_matrices(quaternions: FloatArray) -> FloatArray:
    """Return rotation matrices (..., 3, 3) of quaternions (..., 4), x y z w of any length above 0."""
    q = quaternions / np.maximum(np.linalg.norm(quaternions, axis=-1, keepdims=True), 1e-30)
    x, y, z, w = (q[..., k] for k in range(4))
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def local_matrices(translation: FloatArray, rotation: FloatArray, scale: FloatArray) -> FloatArray:
    """Return matrices (..., 4, 4) of translations (..., 3), quaternions (..., 4) and scales (..., 3)."""
    result = np.zeros((*translation.shape[:-1], 4, 4))
    result[..., :3, :3] = turn_matrices(rotation) * scale[..., None, :]
    result[..., :3, 3] = translation
    result[..., 3, 3] = 1.0
    return result


def rigid(matrices: FloatArray) -> FloatArray:
    """Return matrices (..., 4, 4) without scale and shear: the nearest rotation, and the place as it is.

    A matrix that mirrors or flattens keeps what rotation is nearest. Those that are rotations already, as nearly all
    are, stay as they are.
    """
    linear = matrices[..., :3, :3]
    square = np.abs(linear @ np.swapaxes(linear, -1, -2) - np.eye(3)).max(axis=(-1, -2), initial=0.0)
    other = ~((square < _ORTHOGONAL) & (np.linalg.det(linear) > 0))
    result = matrices.copy()
    if other.any():
        u, _, v = np.linalg.svd(linear[other])
        u[..., :, 2] *= np.where(np.linalg.det(u @ v) < 0, -1.0, 1.0)[..., None]
        result[other, :3, :3] = u @ v
    return result


def _parents(entries: tuple[Record, ...]) -> IntArray:
    parent = np.full(len(entries), -1, dtype=np.int64)
    for index, entry in enumerate(entries):
        for child in listed(entry, "children"):
            number = whole(child, f"node {index}, children", below=len(entries))
            if parent[number] >= 0 or number == index:
                raise FormatError("a node hangs from two nodes or from itself", at=f"node {number}")
            parent[number] = index
    return parent


def _order(entries: tuple[Record, ...], parent: IntArray) -> tuple[int, ...]:
    """Return all nodes depth first; raises `FormatError` where they go round."""
    order: list[int] = []
    waiting = [index for index in range(len(entries) - 1, -1, -1) if parent[index] < 0]
    while waiting:
        order.append(waiting.pop())
        waiting.extend(reversed(listed(entries[order[-1]], "children")))
    if len(order) != len(entries):
        lost = next(index for index in range(len(entries)) if index not in set(order))
        raise FormatError("the nodes go round in a circle", at=f"node {lost}")
    return tuple(order)


def _placed(entry: Record, at: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return a node's translation (3,), quaternion (4,) and scale (3,), from its matrix where it has one."""
    if "matrix" not in entry:
        rotation = numbers(entry.get("rotation", [0, 0, 0, 1]), 4, f"{at}, rotation")
        if not 1e-6 < np.linalg.norm(rotation) < 1e6:
            raise FormatError("a rotation has no direction", at=at, got=str(rotation.tolist()))
        translation = numbers(entry.get("translation", [0, 0, 0]), 3, f"{at}, translation")
        return translation, rotation, numbers(entry.get("scale", [1, 1, 1]), 3, f"{at}, scale")
    matrix = numbers(entry["matrix"], 16, f"{at}, matrix").reshape(4, 4).T
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    scale[0] *= -1.0 if np.linalg.det(matrix[:3, :3]) < 0 else 1.0
    turn = rigid(_unscaled(matrix, scale))[:3, :3]
    return matrix[:3, 3].copy(), quaternion_of(turn[None])[0], scale


def _unscaled(matrix: FloatArray, scale: FloatArray) -> FloatArray:
    result = matrix.copy()
    result[:3, :3] = matrix[:3, :3] / np.where(np.abs(scale) > 1e-12, scale, 1.0)
    return result


def quaternion_of(turns: FloatArray) -> FloatArray:
    """Return quaternions (n, 4), x y z w, of rotation matrices (n, 3, 3), each in the sign nearest to the one before.

    Of the four ways to take a root the one of the largest number is used (Shepperd 1978).
    """
    trace = np.trace(turns, axis1=1, axis2=2)
    squares = np.stack([turns[:, 0, 0], turns[:, 1, 1], turns[:, 2, 2], trace], axis=1)
    largest = np.argmax(squares, axis=1)
    result = np.empty((len(turns), 4))
    for way in range(4):
        at = largest == way
        m = turns[at]
        if way == 3:
            parts = [m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1], 1 + trace[at]]
        else:
            i, j, k = way, (way + 1) % 3, (way + 2) % 3
            parts = [np.empty(0)] * 4
            parts[i] = 1 + m[:, i, i] - m[:, j, j] - m[:, k, k]
            parts[j], parts[k] = m[:, j, i] + m[:, i, j], m[:, k, i] + m[:, i, k]
            parts[3] = m[:, k, j] - m[:, j, k]
        result[at] = np.stack(parts, axis=1)
    result /= np.linalg.norm(result, axis=1, keepdims=True)
    turned = np.einsum("ij,ij->i", result[1:], result[:-1]) < 0
    result[1:] *= np.where(np.cumsum(turned) % 2 == 1, -1.0, 1.0)[:, None]
    return result


def _skin(document: Document, n_nodes: int) -> tuple[int | None, tuple[int, ...], FloatArray]:
    """Return the first skin that has joints: its number, joints and inverse bind matrices."""
    skins = [item(document, "skins", index) for index in range(len(listed(document.root, "skins")))]
    for number, skin in enumerate(skins):
        joints = tuple(whole(j, f"skin {number}, joints", below=n_nodes) for j in listed(skin, "joints"))
        if not joints:
            continue
        if len(set(joints)) != len(joints):
            raise FormatError("a skin names a joint twice", at=f"skin {number}")
        if len(skins) > 1:
            document.note(f"the file has {len(skins)} skins; {name_of(skin, f'skin {number}')!r} is opened")
        inverse = np.tile(np.eye(4), (len(joints), 1, 1))
        if "inverseBindMatrices" in skin:
            given = accessor(document, skin["inverseBindMatrices"], width=16).astype(np.float64)
            if len(given) < len(joints):
                raise FormatError(
                    "bind matrices are missing", at=f"skin {number}", wanted=str(len(joints)), got=str(len(given))
                )
            inverse = given[: len(joints)].reshape(-1, 4, 4).swapaxes(1, 2).copy()
            inverse[:, 3] = (0.0, 0.0, 0.0, 1.0)
        if not (np.abs(np.linalg.det(inverse[:, :3, :3])) > 1e-18).all() or not (np.abs(inverse) < 1e12).all():
            raise FormatError("a bind matrix cannot be inverted", at=f"skin {number}")
        return number, joints, inverse
    return None, (), np.zeros((0, 4, 4))


def _figure(document: Document, skin_joints: tuple[int, ...]) -> int | None:
    own = own_extras(document)
    figure: Any = own.get("figure")
    return figure if isinstance(figure, int) and not isinstance(figure, bool) and figure in skin_joints else None


def own_extras(document: Document) -> Record:
    """Return what the studio itself left in the file beside what glTF holds; empty in other files."""
    extras = record(document.root, "asset").get("extras", {})
    own = extras.get("qmd_studio", {}) if isinstance(extras, dict) else {}
    return own if isinstance(own, dict) else {}


def _chosen(
    entries: tuple[Record, ...],
    parent: IntArray,
    order: tuple[int, ...],
    *,
    skin_joints: tuple[int, ...],
    animated: set[int],
    figure: int | None,
) -> set[int]:
    """Return the nodes that become joints: the skin's, what lies between and moves above them; else what has a mesh."""
    wanted = set(skin_joints) - {figure}
    if not wanted:
        wanted = {node for node in order if "mesh" in entries[node] or node in animated}
    chosen = set(wanted)
    below = np.zeros(len(entries), dtype=np.int64)
    for node in reversed(order):
        below[node] += node in wanted
        if parent[node] >= 0:
            below[parent[node]] += below[node]
    above = np.zeros(len(entries), dtype=np.bool_)
    for node in order:
        above[node] = parent[node] >= 0 and (above[parent[node]] or parent[node] in wanted or parent[node] in animated)
        if below[node] and node != figure and (above[node] or node in animated):
            chosen.add(node)
    return chosen


def _parents_first(nodes: tuple[int, ...], parent: IntArray) -> bool:
    place = {node: k for k, node in enumerate(nodes)}
    return all(place.get(int(parent[node]), -1) < k for k, node in enumerate(nodes))
