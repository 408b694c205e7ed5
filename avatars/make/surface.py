"""The left half of a figure's surface: field, marching cubes on a grid finest where it matters, even triangles."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from avatars.make.body import add_arm, add_leg, add_trunk
from avatars.make.field import Field
from avatars.make.figure import Figure
from avatars.make.hand import add_hand
from avatars.make.head import add_head
from avatars.make.placing import Placed
from avatars.make.remesh import remesh


def build_field(figure: Figure) -> tuple[Field, Placed]:
    """Return the field of a figure's left half and of its middle."""
    field = Field()
    put = Placed(field, figure)
    add_trunk(put, figure.look.chest)
    add_arm(put, figure.look.sleeve_y)
    add_leg(put)
    add_hand(put)
    add_head(put, figure.look)
    return field, put


def half_mesh(field: Field, figure: Figure):
    """Return vertices (n, 3) with x >= 0 and faces (m, 3) of the left half, open along x = 0."""
    axes = _axes(figure)
    index, faces, _, _ = marching_cubes(_sampled(field, axes), 0.0)
    points = np.stack([np.interp(index[:, i], np.arange(len(axes[i])), axes[i]) for i in range(3)], axis=1)
    points[points[:, 0] < 1e-7, 0] = 0.0
    points, faces = _largest(points, faces.astype(np.int64))
    size = size_field(figure)
    points, faces = remesh(points, faces, size, field.onto)
    return _outward(*_largest(points, faces), field)


def _sampled(field: Field, axes: list[np.ndarray], *, block: int = 4, band: float = 0.03) -> np.ndarray:
    """Return the field on a grid, float32; away from the surface the value of the block's corner stands for it."""
    shape = [len(axis) for axis in axes]
    corners = [axis[::block] for axis in axes]
    coarse = field(np.stack(np.meshgrid(*corners, indexing="ij"), axis=-1).reshape(-1, 3))
    coarse = coarse.reshape([len(axis) for axis in corners])
    values = np.clip(coarse, -band, band)
    near = maximum_filter(np.abs(coarse) < band, size=3)
    for axis in range(3):
        values = np.repeat(values, block, axis=axis).take(range(shape[axis]), axis=axis)
        near = np.repeat(near, block, axis=axis).take(range(shape[axis]), axis=axis)
    index = np.argwhere(near)
    points = np.stack([axes[i][index[:, i]] for i in range(3)], axis=1)
    values[near] = np.clip(field(points), -band, band)
    return values.astype(np.float32)


def size_field(figure: Figure):
    """Return a function that gives the wished edge length at points (n, 3): fine at hands and face."""
    parts = {name: figure.scale(name) for name in ("head", "neck", "hand", "foot", "trunk")}
    coarse = 0.0265 * parts["trunk"].mean()
    spots = [
        ("hand", (0.203, 0.682, -0.060), 0.045, 0.0044, 0.040),
        ("hand", (0.198, 0.735, -0.065), 0.045, 0.0052, 0.045),
        ("hand", (0.196, 0.825, 0.020), 0.055, 0.0064, 0.045),
        ("hand", (0.198, 0.808, 0.072), 0.010, 0.0044, 0.045),
        ("head", (0.0, 1.600, 0.078), 0.040, 0.0045, 0.070),
        ("head", (0.0, 1.568, 0.085), 0.020, 0.0028, 0.035),
        ("head", (0.0, 1.592, 0.095), 0.012, 0.0034, 0.030),
        ("head", (0.030, 1.6325, 0.078), 0.016, 0.0023, 0.035),
        ("head", (0.025, 1.697, 0.070), 0.030, 0.0055, 0.050),
        ("head", (0.070, 1.665, 0.040), 0.030, 0.0055, 0.050),
        ("neck", (0.0, 1.520, 0.0), 0.062, 0.0085, 0.045),
        ("head", (0.078, 1.620, 0.008), 0.024, 0.0048, 0.030),
        ("head", (0.0, 1.640, 0.0), 0.105, 0.0108, 0.080),
        ("foot", (0.109, 0.075, -0.070), 0.050, 0.0110, 0.040),
        ("foot", (0.114, 0.0, 0.060), 0.110, 0.0155, 0.070),
        ("foot", (0.110, 0.0, -0.060), 0.080, 0.0155, 0.070),
    ]
    places = [
        (figure.place(part, at), radius * parts[part].mean(), fine * parts[part].mean(), reach * parts[part].mean())
        for part, at, radius, fine, reach in spots
    ]
    limbs = figure.place("trunk", [0.158, 0.0, 0.0])[0], 0.0180 * parts["trunk"].mean()

    def size(points: np.ndarray) -> np.ndarray:
        result = np.full(len(points), coarse)
        result = np.where(points[:, 0] > limbs[0], limbs[1], result)
        for at, radius, fine, reach in places:
            away = np.linalg.norm(points - at, axis=1) - radius
            share = np.clip(away / reach, 0, 1)
            result = np.minimum(result, fine + (coarse - fine) * share)
        return result

    return size


def _axes(figure: Figure) -> list[np.ndarray]:
    """Return the grid's planes across x, y and z."""
    p = figure.place
    hand = [p("hand", [0.17, y, 0.0])[1] for y in (0.665, 0.885)]
    head = [p("head", [0, y, 0])[1] for y in (1.525, 1.76)]
    foot = p("foot", [0, 0.03, 0])[1]
    even = figure.scale("hand").mean()
    wide = p("upperarm", [0.262, 1.4, 0.0])[0]
    x = _planes([(0.0, wide, 0.0018 * even)])
    y = _planes(
        [
            (-0.006, foot, 0.0025 * even),
            (foot, hand[0], 0.009 * even),
            (hand[0], hand[1], 0.0016 * even),
            (hand[1], head[0], 0.008 * even),
            (head[0], head[1] + 0.004, 0.0017 * figure.scale("head")[1]),
        ]
    )
    back = min(p("trunk", [0, 0, -0.150])[2], p("foot", [0, 0, -0.135])[2], p("head", [0, 0, -0.125])[2])
    front = max(p("trunk", [0, 0, 0.140])[2], p("foot", [0, 0, 0.172])[2], p("head", [0, 0, 0.115])[2])
    z = _planes([(back, front, 0.0018 * even)])
    return [x, y, z]


def _planes(runs) -> np.ndarray:
    planes = [np.linspace(a, b, max(int(np.ceil((b - a) / step)), 1), endpoint=False) for a, b, step in runs]
    return np.concatenate([*planes, [runs[-1][1]]])


def _largest(points, faces):
    """Return the mesh's largest piece."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(len(points), len(points)))
    _, label = connected_components(graph, directed=False)
    keep = label[faces[:, 0]] == np.argmax(np.bincount(label[faces[:, 0]]))
    used, numbers = np.unique(faces[keep], return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


def _outward(points, faces, field):
    """Return the mesh with its faces turned so that their normals look away from the body."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    agree = (normal * field.gradient((a + b + c) / 3)).sum()
    return points, faces if agree > 0 else faces[:, ::-1]


def mirrored(points, faces):
    """Return the whole mesh and, for each of its vertices, the vertex of the half that it comes from."""
    n = len(points)
    middle = points[:, 0] == 0
    twin = np.arange(n)
    twin[~middle] = n + np.arange((~middle).sum())
    other = points[~middle] * (-1, 1, 1)
    both = np.concatenate([np.arange(n), np.flatnonzero(~middle)])
    return np.concatenate([points, other]), np.concatenate([faces, twin[faces][:, ::-1]]), both
