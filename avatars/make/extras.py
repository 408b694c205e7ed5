"""The small closed pieces beside the skin, each following one joint: eyes, upper lids, brows and nails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from avatars.make.field import Field
from avatars.make.figure import EYES, Figure
from avatars.make.hand import nail_frames
from avatars.make.head import EYE_RADIUS

IRIS, PUPIL = 0.54, 0.22
"""Angles from the line of sight at which iris and pupil end."""
_LID = 0.25
"""Angle over the line of sight at which the upper lid ends."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A closed mesh of the left side that follows a joint: points (n, 3), faces (m, 3), a material for each face."""

    joint: str
    points: np.ndarray
    faces: np.ndarray
    materials: list[str]

    def mirrored(self) -> Piece:
        """Return the right side's piece."""
        return Piece("r_" + self.joint[2:], self.points * (-1, 1, 1), self.faces[:, ::-1], self.materials)


def pieces(field: Field, figure: Figure) -> list[Piece]:
    """Return all pieces of both sides."""
    left = [_eye(figure), _lid(figure), _brow(field, figure), *(_nail(figure, *frame) for frame in nail_frames())]
    return [*left, *(piece.mirrored() for piece in left)]


def _globe(polar: np.ndarray, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a unit sphere about +z with rings at `polar` angles, and its faces ordered ring by ring."""
    angle = np.arange(around) * 2 * np.pi / around
    rings = [
        np.stack([np.sin(t) * np.cos(angle), np.sin(t) * np.sin(angle), np.full(around, np.cos(t))], 1) for t in polar
    ]
    points = np.concatenate([[[0, 0, 1]], *rings, [[0, 0, -1]]])
    return points, _ring_faces(len(polar), around)


def _ring_faces(n_rings: int, around: int) -> np.ndarray:
    """Return the faces of a pole, rings and another pole, one run around after the other."""
    i = np.arange(around)
    j = (i + 1) % around
    faces = [np.stack([np.zeros_like(i), 1 + i, 1 + j], axis=1)]
    for ring in range(n_rings - 1):
        a, b = 1 + ring * around, 1 + (ring + 1) * around
        faces.append(
            np.stack([np.stack([a + i, b + i, b + j], 1), np.stack([a + i, b + j, a + j], 1)], 1).reshape(-1, 3)
        )
    last = 1 + (n_rings - 1) * around
    faces.append(np.stack([last + i, np.full_like(i, last + around), last + j], axis=1))
    return np.concatenate(faces)


def _eye(figure: Figure) -> Piece:
    around = 16
    polar = np.array([PUPIL, IRIS, 0.78, 1.1, 1.55, 2.2])
    points, faces = _globe(polar, around)
    materials = ["pupils"] * around + ["irises"] * 2 * around
    materials += ["eyes"] * (len(faces) - len(materials))
    centre = figure.place("head", EYES["eyeball"])
    size = EYE_RADIUS * figure.look.eye_size * figure.scale("head").mean()
    return _outwards(Piece("l_eyeball_joint", centre + size * points, faces, materials))


def _lid(figure: Figure) -> Piece:
    """Return a cap over the upper front of the eye: a shell of two sides, its edge dark with lashes."""
    n_across = 12
    up = np.array([_LID, _LID + 0.07, 0.50, 0.75, 1.0, 1.25])
    across = np.linspace(-1.25, 1.25, n_across)
    height, side = np.meshgrid(up, across, indexing="ij")
    droop = height * (1 - 0.55 * (side / 1.25) ** 2 * (1 - (height - _LID) / (1.25 - _LID)))
    unit = np.stack([np.cos(droop) * np.sin(side), np.sin(droop), np.cos(droop) * np.cos(side)], axis=-1).reshape(-1, 3)
    radius = EYE_RADIUS * figure.look.eye_size
    points = np.concatenate([unit * (radius + 0.0012), unit * (radius + 0.0003)]) * figure.scale("head").mean()
    faces = _closed_sheet(len(up), n_across)
    lashes = (faces % len(unit) < 2 * n_across).all(axis=1)
    materials = ["hair" if dark else "skin" for dark in lashes]
    return _outwards(Piece("l_eyelid_joint", figure.place("head", EYES["eyelid"]) + points, faces, materials))


def _closed_sheet(n_rows: int, n_columns: int) -> np.ndarray:
    """Return the faces of two grids of points, the front and the back of a sheet, joined around the edge."""
    n = n_rows * n_columns
    number = np.arange(n).reshape(n_rows, n_columns)
    a, b, c, d = number[:-1, :-1].ravel(), number[:-1, 1:].ravel(), number[1:, 1:].ravel(), number[1:, :-1].ravel()
    front = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    back = front[:, ::-1] + n
    edge = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    after = np.roll(edge, -1)
    rim = np.concatenate([np.stack([edge, edge + n, after], 1), np.stack([after, edge + n, after + n], 1)])
    return np.concatenate([front, back, rim])


def _brow(field: Field, figure: Figure) -> Piece:
    """Return a flat tube along the brow, laid onto the skin."""
    n, around = 9, 6
    t = np.linspace(0, 1, n)
    line = np.stack(
        [0.0135 + 0.0350 * t, 1.6500 + 0.0052 * np.sin(0.8 * np.pi * t) - 0.0020 * t**2, 0.0870 - 0.020 * t**2], 1
    )
    spine = field.onto(figure.place("head", line), rounds=10)
    normal = field.gradient(spine)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.gradient(spine, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    high = np.cross(along, normal)
    high *= np.sign(high[:, [1]])
    size = figure.scale("head").mean()
    half = size * 0.0025 * np.sqrt(np.clip(1 - (2 * t - 0.85) ** 2 / 1.6, 0.05, 1))
    angle = np.arange(around) * 2 * np.pi / around
    ring = half[:, None, None] * np.sin(angle)[None, :, None] * high[:, None] + (
        size * 0.0012 * (0.25 + np.cos(angle))[None, :, None] * normal[:, None]
    )
    points = (spine[:, None] + ring).reshape(-1, 3)
    points = np.concatenate([[spine[0] - 0.001 * along[0]], points, [spine[-1] + 0.002 * along[-1]]])
    return _outwards(Piece("l_eyebrow_joint", points, _ring_faces(n, around), ["hair"] * (around * 2 * n)))


def _nail(figure: Figure, joint, centre, turn, radii) -> Piece:
    points, faces = _globe(np.array([0.7, 1.3, 1.85, 2.45]), 8)
    points = figure.place("hand", centre) + (points * radii * figure.scale("hand").mean()) @ turn.T
    return _outwards(Piece(joint, points, faces, ["nails"] * len(faces)))


def _outwards(piece: Piece) -> Piece:
    """Return the piece with its faces turned so that its volume is positive."""
    a, b, c = (piece.points[piece.faces[:, i]] - piece.points.mean(axis=0) for i in range(3))
    if (a * np.cross(b, c)).sum() > 0:
        return piece
    return Piece(piece.joint, piece.points, piece.faces[:, ::-1], piece.materials)
