"""A figure's triangles shared out among its segments, each a closed mesh of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from avatars.make.model import Model
from avatars.make.remesh import edges_of, vertex_normals

BULGE = 0.45
"""How far a cap stands out at its middle, as a share of the opening's radius: it fills the gap when a joint bends."""


@dataclass(frozen=True, slots=True)
class Part:
    """The closed mesh of one joint's segment: points (n, 3), normals, faces (m, 3) and their materials (m,)."""

    joint: str
    points: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    materials: np.ndarray


def parts_of(model: Model) -> list[Part]:
    """Return the segments' meshes: each face goes to the joint that its corners follow most."""
    owner = _owners(model)
    return [_part(model, owner == number, name) for number, name in enumerate(model.joints) if (owner == number).any()]


def _owners(model: Model) -> np.ndarray:
    """Return the joint (m,) of each face, small islands given to what surrounds them."""
    share = model.weights[model.faces].sum(axis=1)
    owner = share.argmax(axis=1)
    edges = np.sort(np.concatenate([model.faces[:, [0, 1]], model.faces[:, [1, 2]], model.faces[:, [2, 0]]]), axis=1)
    key = edges[:, 0] * len(model.points) + edges[:, 1]
    order = np.argsort(key, kind="stable")
    face = np.tile(np.arange(len(model.faces)), 3)[order]
    next_to = face.reshape(-1, 2)  # the mesh is closed: every edge has two faces
    for _ in range(4):
        votes = np.zeros((len(model.faces), len(model.joints)))
        for a, b in ((0, 1), (1, 0)):
            np.add.at(votes, (next_to[:, a], owner[next_to[:, b]]), 1.0)
        lonely = votes[np.arange(len(owner)), owner] <= 1
        owner = np.where(lonely & (votes.max(axis=1) >= 2), votes.argmax(axis=1), owner)
    return owner


def _part(model: Model, mine: np.ndarray, joint: str) -> Part:
    used, faces = np.unique(model.faces[mine], return_inverse=True)
    faces = faces.reshape(-1, 3)
    points, materials = model.points[used], model.materials[mine]
    normals = model.normals[used]
    for loop, material in _openings(faces, materials):
        rim = points[loop]
        middle = rim.mean(axis=0)
        after = np.roll(rim, -1, axis=0)
        outward = -np.cross(rim - middle, after - middle).sum(axis=0)
        outward /= max(np.linalg.norm(outward), 1e-12)
        radius = np.linalg.norm(rim - middle, axis=1).mean()
        n = len(points)
        points = np.concatenate([points, rim, [middle + BULGE * radius * outward]])
        numbers = n + np.arange(len(loop))
        cap = np.stack([np.roll(numbers, -1), numbers, np.full(len(loop), n + len(loop))], axis=1)
        slope = vertex_normals(points, cap)[n:]
        normals = np.concatenate([normals, slope])
        faces = np.concatenate([faces, cap])
        materials = np.concatenate([materials, np.full(len(loop), material)])
    return Part(joint, points, normals, faces, materials)


def _openings(faces: np.ndarray, materials: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Return the loops of edges that have one face, in the direction of their faces, with the commonest material."""
    edges, count = edges_of(faces)
    n = int(faces.max()) + 1
    open_keys = set((edges[count == 1, 0] * n + edges[count == 1, 1]).tolist())
    following: dict[int, list[tuple[int, int]]] = {}
    for number, face in enumerate(faces.tolist()):
        for a, b in zip(face, (face[1], face[2], face[0]), strict=True):
            if min(a, b) * n + max(a, b) in open_keys:
                following.setdefault(a, []).append((b, int(materials[number])))
    loops = []
    while following:
        start = min(following)
        loop, kinds, at = [], [], start
        while at in following:
            step, kind = following[at].pop()
            if not following[at]:
                del following[at]
            loop.append(at)
            kinds.append(kind)
            at = step
        if len(loop) > 2:
            loops.append((np.array(loop), int(np.bincount(kinds).argmax())))
    return loops
