"""The surface of a glTF figure: meshes that follow its skin's joints, meshes that hang from one, and their morphs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.area_normals import area_normals
from qmd_studio.avatar.humanoid import Displacer, Surface
from qmd_studio.errors import FormatError
from qmd_studio.formats.gltf_document import Document, Record, accessor, item, listed, name_of, record, whole
from qmd_studio.formats.gltf_figure import Figure
from qmd_studio.formats.gltf_image import base_colours
from qmd_studio.formats.gltf_nodes import own_extras

MAX_VERTICES = 1_000_000
MAX_MORPHS = 1_000
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_PLAIN = np.full(3, 0.8)


@dataclass(slots=True)
class Parts:
    """What has been gathered, primitive by primitive, and the displacers that each mesh node's weights drive."""

    vertices: list[FloatArray] = field(default_factory=list)
    normals: list[FloatArray] = field(default_factory=list)
    faces: list[IntArray] = field(default_factory=list)
    colours: list[FloatArray] = field(default_factory=list)
    joints: list[IntArray] = field(default_factory=list)
    weights: list[FloatArray] = field(default_factory=list)
    n_vertices: int = 0
    displacers: list[Displacer] = field(default_factory=list)
    driven: dict[int, list[int]] = field(default_factory=dict)


def parts_of(document: Document, figure: Figure) -> Parts:
    """Return the figure's meshes at the pose they are bound at; raises `FormatError` where they do not fit together."""
    parts = Parts()
    for node, entry in enumerate(figure.tree.entries):
        if "mesh" not in entry:
            continue
        if "skin" in entry and entry["skin"] != figure.tree.skin:
            document.note(f"the mesh of {name_of(entry, f'node {node}')!r} has another skin and is not shown")
            continue
        _add_mesh(document, parts, figure, node)
    return parts


def surface_of(parts: Parts) -> Surface | None:
    """Return the surface, None where there is none."""
    if not parts.vertices:
        return None
    n_influences = max(joints.shape[1] for joints in parts.joints)
    joints = [np.pad(j, ((0, 0), (0, n_influences - j.shape[1]))) for j in parts.joints]
    weights = [np.pad(w, ((0, 0), (0, n_influences - w.shape[1]))) for w in parts.weights]
    return Surface(
        vertices=np.concatenate(parts.vertices).astype(np.float32),
        normals=np.concatenate(parts.normals).astype(np.float32),
        faces=np.concatenate(parts.faces),
        colours=np.concatenate(parts.colours).astype(np.float32),
        joints=np.concatenate(joints),
        weights=np.concatenate(weights).astype(np.float32),
    )


def _add_mesh(document: Document, parts: Parts, figure: Figure, node: int) -> None:
    entry = figure.tree.entries[node]
    mesh = item(document, "meshes", entry["mesh"])
    skinned = "skin" in entry
    matrix = np.diag([figure.scale, figure.scale, figure.scale, 1.0])
    if not skinned:
        matrix = figure.world[node]
        joint = figure.owner[node]
        if joint >= 0:
            matrix = figure.bind[joint] @ np.linalg.inv(figure.rest[joint]) @ matrix
    moved: list[list[tuple[int, FloatArray]]] = []
    for k, primitive in enumerate(listed(mesh, "primitives")):
        at = f"mesh {entry['mesh']}, primitive {k}"
        if not isinstance(primitive, dict):
            raise FormatError("this is no object", at=at)
        first = parts.n_vertices
        if _add_primitive(document, parts, figure, primitive, matrix=matrix, node=node, at=at):
            moved.append(
                [(first, shift @ matrix[:3, :3].T) for shift in _morphs(document, primitive, parts, first, at)]
            )
    _add_displacers(document, parts, figure, mesh, node=node, moved=moved)


def _add_primitive(
    document: Document, parts: Parts, figure: Figure, primitive: Record, *, matrix: FloatArray, node: int, at: str
) -> bool:
    """Gather one primitive; False for points and lines, which are not shown."""
    attributes = record(primitive, "attributes")
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN) or "POSITION" not in attributes:
        document.note("points and lines are not shown")
        return False
    given = accessor(document, attributes["POSITION"], width=3)
    n = len(given)
    parts.n_vertices += n
    if parts.n_vertices > MAX_VERTICES:
        raise FormatError("the meshes are too large", at=at, wanted=f"at most {MAX_VERTICES} vertices")
    faces = _faces(document, primitive, n, mode=mode, at=at)
    vertices = given.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    if not (np.abs(vertices) < 1e9).all():
        raise FormatError("a mesh is too large", at=at, wanted="at most 1e9 m in size")
    if "skin" in figure.tree.entries[node]:
        joints, weights = _influences(document, figure, attributes, n, at=at)
    else:
        joint = figure.owner[node] if figure.owner[node] >= 0 else len(figure.parents)
        joints, weights = np.full((n, 1), joint, dtype=np.int64), np.ones((n, 1))
    if "NORMAL" in attributes:
        normals = _same_count(accessor(document, attributes["NORMAL"], width=3), n, at).astype(np.float64)
        turn = np.linalg.inv(matrix[:3, :3]).T if abs(np.linalg.det(matrix[:3, :3])) > 1e-18 else np.eye(3)
        normals = _unit(normals @ turn.T) if np.abs(turn - turn[0, 0] * np.eye(3)).max() > 1e-12 else _unit(normals)
    else:
        normals = area_normals(vertices, faces)
    parts.vertices.append(vertices)
    parts.normals.append(normals)
    parts.faces.append(faces + parts.n_vertices - n)
    parts.colours.append(_colours(document, primitive, attributes, n, at=at))
    parts.joints.append(joints)
    parts.weights.append(weights)
    return True


def _faces(document: Document, primitive: Record, n: int, *, mode: int, at: str) -> IntArray:
    """Return triangles (m, 3) of a primitive of `n` vertices."""
    if "indices" in primitive:
        index = accessor(document, primitive["indices"], width=1)[:, 0].astype(np.int64)
    else:
        index = np.arange(n)
    if len(index) and not 0 <= index.min() <= index.max() < n:
        got = f"{index.min()} to {index.max()}"
        raise FormatError("a face has a vertex that does not exist", at=at, wanted=f"below {n}", got=got)
    if mode == _TRIANGLES:
        return index[: len(index) // 3 * 3].reshape(-1, 3)
    if len(index) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    if mode == _FAN:
        return np.stack([np.full(len(index) - 2, index[0]), index[1:-1], index[2:]], axis=1)
    faces = np.stack([index[:-2], index[1:-1], index[2:]], axis=1)
    faces[1::2] = faces[1::2, ::-1]
    return faces


def _influences(
    document: Document, figure: Figure, attributes: Record, n: int, *, at: str
) -> tuple[IntArray, FloatArray]:
    """Return joint numbers and weights (n, 4 a set) of a skinned primitive, the weights summing to 1."""
    number = figure.tree.joint_number()
    table = np.array([number.get(node, len(figure.parents)) for node in figure.tree.skin_joints], dtype=np.int64)
    sets = [k for k in range(16) if f"JOINTS_{k}" in attributes and f"WEIGHTS_{k}" in attributes]
    if not sets:
        document.warnings.append(f"{at}: the mesh has a skin but no weights; it follows the first joint")
        return np.full((n, 1), table[0], dtype=np.int64), np.ones((n, 1))
    given, weights = (
        np.concatenate(
            [_same_count(accessor(document, attributes[f"{kind}_{k}"], width=4), n, at) for k in sets], axis=1
        )
        for kind in ("JOINTS", "WEIGHTS")
    )
    joints, weights = given.astype(np.int64), np.maximum(weights.astype(np.float64), 0.0)
    joints[weights == 0] = 0
    if n and not 0 <= joints.min() <= joints.max() < len(table):
        got = f"{joints.min()} to {joints.max()}"
        raise FormatError("a vertex follows a joint that does not exist", at=at, wanted=f"below {len(table)}", got=got)
    total = weights.sum(axis=1, keepdims=True)
    if (total <= 0).any():
        document.warnings.append(f"{at}: {int((total <= 0).sum())} vertices follow no joint; they follow the first")
        weights[total[:, 0] <= 0, 0] = 1.0
        total = weights.sum(axis=1, keepdims=True)
    if (np.abs(total - 1) > 0.01).any():
        document.warnings.append(f"{at}: weights do not sum to 1; they are made to")
    exact = np.abs(total - 1) < 1e-6
    return table[joints], np.where(exact, weights, weights / total)


def _colours(document: Document, primitive: Record, attributes: Record, n: int, *, at: str) -> FloatArray:
    """Return linear colours (n, 3): the vertices' own times the material's."""
    colours = np.tile(_PLAIN, (n, 1))
    if "material" in primitive:
        material = item(document, "materials", primitive["material"])
        texture = record(record(material, "pbrMetallicRoughness"), "baseColorTexture")
        name = f"TEXCOORD_{whole(texture.get('texCoord', 0), at, below=16)}"
        uv = None
        if texture and name in attributes:
            uv = _same_count(accessor(document, attributes[name], width=2), n, at).astype(np.float64)
        colours = np.broadcast_to(base_colours(document, material, uv), (n, 3)).copy()
    if "COLOR_0" in attributes:
        entry = item(document, "accessors", attributes["COLOR_0"])
        width = 4 if entry.get("type") == "VEC4" else 3
        own = _same_count(accessor(document, attributes["COLOR_0"], width=width), n, at)[:, :3].astype(np.float64)
        colours = own if "material" not in primitive else colours * own
    return np.asarray(np.clip(colours, 0.0, 1.0), dtype=np.float64)


def _morphs(document: Document, primitive: Record, parts: Parts, first: int, at: str) -> list[FloatArray]:
    """Return what each morph target adds to the positions (n, 3) of a primitive."""
    targets = listed(primitive, "targets")
    if len(targets) > MAX_MORPHS:
        raise FormatError("the mesh has too many morph targets", at=at, wanted=f"at most {MAX_MORPHS}")
    shifts = []
    for target in targets:
        place: Any = target.get("POSITION") if isinstance(target, dict) else None
        n = parts.n_vertices - first
        if place is None:
            shifts.append(np.zeros((n, 3)))
        else:
            shifts.append(_same_count(accessor(document, place, width=3), n, at).astype(np.float64))
    return shifts


def _add_displacers(
    document: Document,
    parts: Parts,
    figure: Figure,
    mesh: Record,
    *,
    node: int,
    moved: list[list[tuple[int, FloatArray]]],
) -> None:
    """Turn the morph targets of a mesh into displacers, one of all its primitives."""
    n_targets = max((len(shifts) for shifts in moved), default=0)
    extras = mesh.get("extras")
    names = extras.get("targetNames") if isinstance(extras, dict) else None
    given = figure.tree.entries[node].get("weights", mesh.get("weights", []))
    owners = own_extras(document).get("displacer_joints")
    driven = parts.driven.setdefault(node, [])
    for k in range(n_targets):
        vertices, shifts = [], []
        for first, shift in (primitive[k] for primitive in moved if k < len(primitive)):
            kept = np.flatnonzero(shift.any(axis=1))
            vertices.append(kept + first)
            shifts.append(shift[kept])
        title = names[k] if isinstance(names, list) and k < len(names) else None
        weight = given[k] if isinstance(given, list) and k < len(given) else 0.0
        joint = owners[k] if isinstance(owners, list) and k < len(owners) else max(figure.owner[node], 0)
        driven.append(len(parts.displacers))
        parts.displacers.append(
            Displacer(
                name=title[:200] if isinstance(title, str) and title else f"morph {len(parts.displacers)}",
                joint=joint if isinstance(joint, int) and 0 <= joint < len(figure.parents) else 0,
                vertices=np.concatenate(vertices).astype(np.int64),
                displacements=np.concatenate(shifts).astype(np.float32),
                weight=float(weight) if isinstance(weight, int | float) and abs(weight) < 1e6 else 0.0,
            )
        )


def _same_count(values: Any, n: int, at: str) -> Any:
    if len(values) != n:
        raise FormatError("a mesh's arrays differ in length", at=at, wanted=str(n), got=str(len(values)))
    return values


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit = vectors / np.where(length > 0, length, 1.0)
    return np.where(length > 0, np.where(np.abs(length - 1) < 1e-6, vectors, unit), [0.0, 1.0, 0.0])
