"""Even triangles of a wished size on an implicit surface: split, collapse, flip, relax and project, over and over.

After Botsch and Kobbelt, "A remeshing approach to multiresolution modeling" (2004), with a size that varies over the
surface. The rim at x = 0 stays on that plane, so that the half mesh can be mirrored. All passes run in the order of
the vertex numbers: the same input gives the same mesh.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import njit
from scipy.sparse import coo_matrix

Size = Callable[[np.ndarray], np.ndarray]
Project = Callable[[np.ndarray], np.ndarray]


def remesh(vertices, faces, size: Size, project: Project, *, rounds: int = 5):
    """Return vertices (n, 3) and faces (m, 3) with edges about as long as `size(points)` says."""
    for _ in range(40):  # from a fine mesh to about the right one, before anything costs much
        n = len(vertices)
        vertices, faces, changed = _collapse(vertices, faces, size)
        if not changed or len(vertices) > 0.97 * n:
            break
    for _ in range(rounds):
        for _ in range(3):
            vertices, faces, changed = _split(vertices, faces, size)
            if not changed:
                break
        for _ in range(6):
            vertices, faces, changed = _collapse(vertices, faces, size)
            if not changed:
                break
        for _ in range(4):
            faces, changed = _flip(vertices, faces)
            if not changed:
                break
        for _ in range(2):
            vertices = _relax(vertices, faces, size)
        vertices = project(vertices)
    for _ in range(3):
        vertices = project(_relax(vertices, faces, size))
    return vertices, faces


def edges_of(faces):
    """Return the edges (n, 2) in ascending order and how many faces each has (n,)."""
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    n = int(faces.max()) + 1
    keys, count = np.unique(pairs[:, 0] * n + pairs[:, 1], return_counts=True)
    return np.stack([keys // n, keys % n], axis=1), count


def _split(vertices, faces, size):
    edges, _ = edges_of(faces)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    middle = vertices[edges].mean(axis=1)
    long = np.flatnonzero(length > 4 / 3 * size(middle))
    if not len(long):
        return vertices, faces, False
    key = edges[long, 0] * len(vertices) + edges[long, 1]
    lookup = len(vertices) + np.arange(len(long))
    ring = np.sort(np.stack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]], axis=1), axis=2)
    wanted = ring[:, :, 0] * len(vertices) + ring[:, :, 1]
    at = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
    new = np.where(key[at] == wanted, lookup[at], -1)
    result = [faces[(new < 0).all(axis=1)]]
    for turn in range(3):
        f, m = np.roll(faces, -turn, axis=1), np.roll(new, -turn, axis=1)
        one = (m[:, 0] >= 0) & (m[:, 1] < 0) & (m[:, 2] < 0)
        a, b, c, ab = f[one, 0], f[one, 1], f[one, 2], m[one, 0]
        result += [np.stack([a, ab, c], 1), np.stack([ab, b, c], 1)]
        two = (m[:, 0] >= 0) & (m[:, 1] >= 0) & (m[:, 2] < 0)
        a, b, c, ab, bc = f[two, 0], f[two, 1], f[two, 2], m[two, 0], m[two, 1]
        result += [np.stack([ab, b, bc], 1), np.stack([a, ab, bc], 1), np.stack([a, bc, c], 1)]
    full = (new >= 0).all(axis=1)
    (a, b, c), (ab, bc, ca) = faces[full].T, new[full].T
    result += [np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate([vertices, middle[long]]), np.concatenate(result), True


def _around(faces, n):
    """Return the faces around each vertex: starts (n + 1,) and face numbers."""
    order = np.argsort(faces.ravel(), kind="stable")
    starts = np.searchsorted(faces.ravel()[order], np.arange(n + 1))
    return starts, order // 3


def _collapse(vertices, faces, size):
    edges, count = edges_of(faces)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    wished = size(vertices[edges].mean(axis=1))
    short = np.flatnonzero(length < 0.8 * wished)
    if not len(short):
        return vertices, faces, False
    short = short[np.argsort(length[short] / wished[short], kind="stable")]
    rim = np.zeros(len(vertices), dtype=np.bool_)
    rim[edges[count == 1].ravel()] = True
    starts, around = _around(faces, len(vertices))
    vertices, faces = vertices.copy(), faces.copy()
    done = _collapse_all(vertices, faces, starts, around, edges[short], count[short] == 1, rim, size(vertices))
    keep = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 0] != faces[:, 2])
    used, numbers = np.unique(faces[keep], return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3), done > 0


@njit(cache=True)
def _collapse_all(vertices, faces, starts, around, edges, on_rim, rim, size):
    locked = np.zeros(len(vertices), np.bool_)
    mark = np.full(len(vertices), -1)
    done = 0
    for e in range(len(edges)):
        a, b = edges[e]
        if locked[a] or locked[b] or (rim[a] and rim[b] and not on_rim[e]):
            continue
        if rim[b] and not rim[a]:
            a, b = b, a
        target = vertices[a].copy() if rim[a] and not rim[b] else (vertices[a] + vertices[b]) / 2
        if _may_collapse(vertices, faces, starts, around, a, b, target, mark, e, 1 if on_rim[e] else 2, size, locked):
            for c in (a, b):
                for i in range(starts[c], starts[c + 1]):
                    for j in range(3):
                        locked[faces[around[i], j]] = True
            vertices[a] = target
            for i in range(starts[b], starts[b + 1]):
                for j in range(3):
                    if faces[around[i], j] == b:
                        faces[around[i], j] = a
            done += 1
    return done


@njit(cache=True)
def _may_collapse(vertices, faces, starts, around, a, b, target, mark, e, shared, size, locked):
    for i in range(starts[a], starts[a + 1]):
        for j in range(3):
            mark[faces[around[i], j]] = 2 * e
    common = 0
    for i in range(starts[b], starts[b + 1]):
        for j in range(3):
            c = faces[around[i], j]
            if c != a and c != b and mark[c] == 2 * e:
                common += 1
                mark[c] = 2 * e + 1
    if common != shared:
        return False
    for c in (a, b):
        for i in range(starts[c], starts[c + 1]):
            f = faces[around[i]]
            if (f[0] == a or f[1] == a or f[2] == a) and (f[0] == b or f[1] == b or f[2] == b):
                continue
            for j in range(3):
                if locked[f[j]]:
                    return False
            p, q, r = vertices[f[0]], vertices[f[1]], vertices[f[2]]
            before = np.cross(q - p, r - p)
            p = target if f[0] == a or f[0] == b else p
            q = target if f[1] == a or f[1] == b else q
            r = target if f[2] == a or f[2] == b else r
            after = np.cross(q - p, r - p)
            long = max(np.sum((p - q) ** 2), np.sum((q - r) ** 2), np.sum((p - r) ** 2))
            lengths = np.sqrt(np.sum(before**2)) * np.sqrt(np.sum(after**2))
            if np.sum(before * after) < 0.4 * lengths or long > 2.2 * size[c] ** 2:
                return False
    return True


def _flip(vertices, faces):
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    across = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    owner = np.tile(np.arange(len(faces)), 3)
    key = np.minimum(pairs[:, 0], pairs[:, 1]) * len(vertices) + np.maximum(pairs[:, 0], pairs[:, 1])
    order = np.argsort(key, kind="stable")
    twin = np.flatnonzero(key[order][1:] == key[order][:-1])
    first, second = order[twin], order[twin + 1]
    edges, count = edges_of(faces)
    valence = np.bincount(edges.ravel(), minlength=len(vertices))
    wish = np.full(len(vertices), 6)
    wish[edges[count == 1].ravel()] = 4
    existing = set((edges[:, 0] * len(vertices) + edges[:, 1]).tolist())
    quads = np.stack([pairs[first, 0], pairs[first, 1], across[first], across[second]], axis=1)
    excess = valence - wish
    before = (excess[quads] ** 2).sum(axis=1)
    after = ((excess[quads] + [-1, -1, 1, 1]) ** 2).sum(axis=1)
    good = np.flatnonzero(after < before)
    a, b, c, d = (vertices[quads[good, i]] for i in range(4))
    old = np.cross(b - a, c - a) + np.cross(a - b, d - b)
    n1, n2 = np.cross(d - c, b - c), np.cross(a - c, d - c)
    square = np.linalg.norm(old, axis=1)
    flat = ((n1 * old).sum(1) > 0.2 * square * np.linalg.norm(n1, axis=1)) & (
        (n2 * old).sum(1) > 0.2 * square * np.linalg.norm(n2, axis=1)
    )
    good = good[flat]
    good = good[np.argsort((after - before)[good], kind="stable")]
    faces = faces.copy()
    touched = np.zeros(len(vertices), dtype=bool)
    done = 0
    for q in good.tolist():
        a, b, c, d = quads[q].tolist()
        if touched[[a, b, c, d]].any() or min(c, d) * len(vertices) + max(c, d) in existing:
            continue
        touched[[a, b, c, d]] = True
        faces[owner[first[q]]] = (c, d, b)
        faces[owner[second[q]]] = (d, c, a)
        done += 1
    return faces, done > 0


def _relax(vertices, faces, size):
    """Move each vertex in its tangent plane to its neighbours' mean; those of the rim along the rim."""
    edges, count = edges_of(faces)
    n = len(vertices)
    rim = np.zeros(n, dtype=bool)
    rim[edges[count == 1].ravel()] = True
    both = np.concatenate([edges, edges[:, ::-1]])
    on = np.concatenate([count == 1, count == 1])
    keep = ~rim[both[:, 0]] | on
    both = both[keep]
    pull = 1 / size(vertices[both].mean(axis=1)) ** 0.5
    matrix = coo_matrix((pull, (both[:, 0], both[:, 1])), shape=(n, n)).tocsr()
    mean = (matrix @ vertices) / np.maximum(np.asarray(matrix.sum(axis=1)), 1e-12)
    normal = vertex_normals(vertices, faces)
    normal[rim, 0] = 0
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    move = mean - vertices
    move -= (move * normal).sum(axis=1, keepdims=True) * normal
    move[rim, 0] = 0
    return vertices + 0.6 * move


def vertex_normals(vertices, faces):
    """Return unit normals (n, 3), faces weighing by their area."""
    face = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    total = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(total, faces[:, corner], face)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-15)
