"""What each triangle is made of: skin, lips, hair and clothes, with the mesh's edges drawn onto the borders."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from avatars.make.body import SHOE
from avatars.make.field import Field
from avatars.make.figure import EYES, Figure
from avatars.make.head import HAIR, HEAD, hair_excess
from avatars.make.remesh import edges_of
from avatars.make.skinning import Regions

MATERIALS = ("skin", "lips", "hair", "shirt", "trousers", "shoes", "soles")
ARM, LEG, HAND = 1, 2, 4
_NEAR = 0.0016


def limbs(registers: np.ndarray) -> np.ndarray:
    """Return the limb (n,) that points of the surface lie on: 0 trunk, 1 arm, 2 leg, 3 head, 4 foot."""
    result = np.zeros(len(registers), dtype=np.int64)
    result[registers[:, LEG] < 0.004] = 2
    result[registers[:, SHOE] < _NEAR] = 4
    result[np.minimum(registers[:, ARM], registers[:, HAND]) < _NEAR] = 1
    result[np.minimum(registers[:, HEAD], registers[:, HAIR]) < _NEAR] = 3
    return result


def dressed(points, faces, field: Field, figure: Figure) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n, 3) moved onto the borders between materials and each face's material (m,)."""
    material = np.zeros(len(faces), dtype=np.int64)
    for name, border in _borders(field, figure):
        points, inside = _cut(points, faces, border)
        points = _moved_onto(points, field)
        material[inside] = MATERIALS.index(name)
    return points, material


def _moved_onto(points, field):
    return field.onto(points, rounds=2, longest=0.001)


def _borders(field: Field, figure: Figure) -> list[tuple[str, Callable[[np.ndarray], np.ndarray]]]:
    """Return materials with functions that are positive inside them, later ones on top of earlier ones."""
    place, look = figure.place, figure.look
    hem, sole = place("trunk", [0, 0.975, 0])[1], place("foot", [0, 0.017, 0])[1]
    part = "forearm" if look.sleeve_y < 1.13 else "upperarm"
    sleeve = place(part, [0, look.sleeve_y, 0])[1]

    def shirt(p: np.ndarray) -> np.ndarray:
        limb = limbs(field.registers(p))
        regions = Regions(p, figure, limb)
        return np.minimum(np.where(limb == 1, p[:, 1] - sleeve, p[:, 1] - hem), 0.034 - 0.08 * regions.neck_level())

    def trousers(p: np.ndarray) -> np.ndarray:
        limb = limbs(field.registers(p))
        return np.where(limb == 1, -0.05, np.minimum(hem - p[:, 1], field.registers(p)[:, SHOE] - 0.0012))

    def shoes(p: np.ndarray) -> np.ndarray:
        return np.maximum(0.0012 - field.registers(p)[:, SHOE], -0.05)

    def soles(p: np.ndarray) -> np.ndarray:
        return np.minimum(sole - p[:, 1], shoes(p) + 0.001)

    def hair(p: np.ndarray) -> np.ndarray:
        registers = field.registers(p)
        return np.minimum(np.clip(hair_excess(registers), -0.05, 0.05), 0.002 - np.clip(registers[:, HAIR], -1, 0.05))

    return [
        ("shirt", shirt),
        ("trousers", trousers),
        ("shoes", shoes),
        ("soles", soles),
        ("hair", hair),
        ("lips", lambda p: _lips(p, figure)),
    ]


def _lips(points, figure):
    """Return how far inside the lips' outline points are (n,), metres."""
    origin, scale = figure.place("head", [0, 0, 0]), figure.scale("head")
    x, y, z = ((points - origin) / scale).T
    y = EYES["eyeball"][1] + (y - EYES["eyeball"][1]) / figure.look.face_height
    half = 0.0240 * figure.look.mouth
    y = y - 0.0062 * np.clip(x / half, 0, 1) ** 2  # the corners are a little higher
    across = np.clip(1 - (x / half) ** 2, 0, 1)
    top = 1.5685 + 0.0068 * across - 0.0016 * np.exp(-((x / 0.0035) ** 2))
    bottom = 1.5680 - 0.0084 * across
    inside = np.minimum(np.minimum(top - y, y - bottom), (half - x) * 0.5)
    return np.where(z > 0.06, inside, -0.02)


def _cut(points, faces, border):
    """Return points (n, 3), those nearest to the border moved onto it along edges, and whether faces are inside."""
    value = border(points)
    edges, count = edges_of(faces)
    rim = np.zeros(len(points), dtype=bool)
    rim[edges[count == 1].ravel()] = True
    va, vb = value[edges[:, 0]], value[edges[:, 1]]
    cross = va * vb < 0
    edges, va, vb, on_rim = edges[cross], va[cross], vb[cross], (count == 1)[cross]
    t = _crossing(points[edges[:, 0]], points[edges[:, 1]], border)
    first = t < 0.5
    mover = np.where(first, edges[:, 0], edges[:, 1])
    share = np.minimum(t, 1 - t)
    forced = on_rim & rim[mover]
    other = np.where(first, edges[:, 1], edges[:, 0])
    goal = points[mover] + share[:, None] * (points[other] - points[mover])
    order = np.lexsort((share, ~forced, mover))
    mover, goal, forced = mover[order], goal[order], forced[order]
    unique, at = np.unique(mover, return_index=True)
    result = points.copy()
    result[unique] = goal[at]
    result[rim, 0] = 0.0
    value = value.copy()
    value[unique] = 0.0
    return result, value[faces].sum(axis=1) > 0


def _crossing(a, b, border):
    """Return where on the way from `a` to `b` (n, 3) the border is, 0 to 1, by halving."""
    low, high = np.zeros(len(a)), np.ones(len(a))
    sign = np.sign(border(a))
    for _ in range(10):
        middle = (low + high) / 2
        same = np.sign(border(a + middle[:, None] * (b - a))) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2
