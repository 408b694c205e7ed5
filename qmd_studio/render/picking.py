"""Which joint is under the mouse: the sight's first hit of the posed surface, and the joint that carries it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.render.scene import Actor, Scene, posed_vertices


@dataclass(frozen=True, slots=True)
class Hit:
    """What a sight meets first: numbers of the actor and the joint, and the distance along the sight in metres."""

    actor: int
    joint: int
    distance: float


def pick(scene: Scene, origin: FloatArray, direction: FloatArray) -> Hit | None:
    """Return the joint whose skin the sight from `origin` along the unit `direction` meets first, or None.

    Ghosts are met like solid bodies. The very triangles that are drawn are tested: what is picked is what is seen.
    """
    hits = [hit for number, actor in enumerate(scene.actors) if (hit := _pick_actor(number, actor, origin, direction))]
    return min(hits, key=lambda hit: hit.distance, default=None)


def _pick_actor(number: int, actor: Actor, origin: FloatArray, direction: FloatArray) -> Hit | None:
    surface = actor.body.surface
    corners = posed_vertices(actor)[surface.faces]
    a = corners[:, 0]
    ab, ac = corners[:, 1] - a, corners[:, 2] - a
    with np.errstate(divide="ignore", invalid="ignore"):
        across = np.cross(direction, ac)
        scale = 1.0 / np.einsum("fi,fi->f", ab, across)
        away = origin - a
        u = scale * np.einsum("fi,fi->f", away, across)
        beside = np.cross(away, ab)
        v = scale * (beside @ direction)
        distance = scale * np.einsum("fi,fi->f", ac, beside)
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 1e-4)
    if not met.any():
        return None
    face = int(np.argmin(np.where(met, distance, np.inf)))
    shares = np.zeros(len(actor.body.skeleton.joints))
    for corner, share in zip(surface.faces[face], (1 - u[face] - v[face], u[face], v[face]), strict=True):
        np.add.at(shares, surface.joints[corner], share * surface.weights[corner])
    return Hit(number, int(np.argmax(shares)), float(distance[face]))
