"""The shape of the left half of the head, hair included, in metres of the default body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from avatars.make.field import CARVE
from avatars.make.figure import EYES, Look
from avatars.make.placing import Placed

HEAD, HAIR = 6, 7
EYE_RADIUS = 0.0122


def add_head(put: Placed, look: Look) -> None:
    """Add skull, face, ear and hair; the head's own register is joined to the neck."""
    _skull(put)
    soft = _LowerFace(put, look)
    _face(soft, look.cheeks)
    _eyes(put, look.eye_size)
    _nose(soft)
    _mouth(soft, look.mouth)
    _ear(put)
    put.join(HEAD, into=0, k=(0.012, 0.012), levels=[("neck", 1.50), ("head", 1.60)])
    _hair(put, look)
    put.join(HAIR, into=0, k=(0.0015, 0.0015), levels=[("head", 1.60), ("head", 1.70)])


@dataclass(frozen=True, slots=True)
class _LowerFace:
    """Puts a face's primitives, what is below the eyes drawn together as the figure's look says."""

    put: Placed
    look: Look

    def ellipsoid(self, part, centre, radii, **how):
        radii = np.array(radii) * (1, self.look.face_height, 1)
        self.put.ellipsoid(part, lowered(self.look, centre), radii, **how)

    def cone(self, part, a, b, ra, rb, **how):
        ra, rb = ra * self.look.face_height, rb * self.look.face_height
        self.put.cone(part, lowered(self.look, a), lowered(self.look, b), ra, rb, **how)


def lowered(look: Look, point) -> np.ndarray:
    """Return a place (3,) of the default face in the face of `look`: a child's is shorter and flatter."""
    x, y, z = point
    eyes, flat = EYES["eyeball"][1], 0.079
    y = y if y > eyes else eyes + look.face_height * (y - eyes)
    return np.array([x, y, z if z < flat else flat + look.face_depth * (z - flat)])


def _skull(put: Placed) -> None:
    put.ellipsoid("head", (0.0, 1.660, -0.012), (0.0735, 0.0825, 0.0930), register=HEAD)
    put.ellipsoid("head", (0.0, 1.640, 0.022), (0.0665, 0.066, 0.0620), k=0.02, register=HEAD)  # brow
    put.ellipsoid("head", (0.0, 1.620, -0.038), (0.0620, 0.050, 0.050), k=0.025, register=HEAD)  # back


def _face(put: Placed, cheeks: float) -> None:
    put.ellipsoid("head", (0.0, 1.594, 0.030), (0.0510, 0.060, 0.0490), k=0.018, register=HEAD)  # middle face
    put.cone("head", (0.0430, 1.5740, 0.012), (0.0145, 1.5400, 0.0615), 0.0110, 0.0155, k=0.020, register=HEAD)  # jaw
    put.cone("head", (0.0, 1.550, 0.050), (0.0, 1.5405, 0.0650), 0.024, 0.0165, k=0.016, register=HEAD)  # chin
    put.ellipsoid("head", (0.0405, 1.608, 0.050), (0.0170, 0.015, 0.0170), k=0.02, register=HEAD)  # cheek bone
    fuller = 0.0035 * cheeks
    centre = (0.0310 + 0.4 * fuller, 1.588 - 0.6 * fuller, 0.048)
    radii = np.array((0.0210, 0.022, 0.0220)) + fuller
    put.ellipsoid("head", centre, radii, k=0.020, register=HEAD)  # cheek
    put.cone("head", (0.012, 1.6475, 0.0785), (0.044, 1.6485, 0.0605), 0.0058, 0.0058, k=0.014, register=HEAD)  # brow


def _eyes(put: Placed, size: float) -> None:
    x, y, z = EYES["eyeball"]
    radius = EYE_RADIUS * size
    put.ellipsoid("head", (x, y, z + 0.0135), (0.0160, 0.0110, 0.0110), k=0.012, register=HEAD, op=CARVE)
    turn = _about_y(-0.20)
    # the lids: a shell about the eyeball with a slit in front
    put.ellipsoid("head", (x, y - 0.0002, z), np.full(3, radius + 0.0022), turn=turn, k=0.004, register=HEAD)
    put.ellipsoid(
        "head",
        (x, y + 0.0004, z + 0.011 * size),
        size * np.array((0.0138, 0.0054, 0.0120)),
        k=0.0015,
        register=HEAD,
        op=CARVE,
    )


def _nose(put: Placed) -> None:
    put.cone("head", (0.0, 1.6340, 0.0785), (0.0, 1.6000, 0.0940), 0.0065, 0.0072, k=0.012, register=HEAD)
    put.ellipsoid("head", (0.0, 1.5960, 0.0950), (0.0088, 0.0078, 0.0085), k=0.007, register=HEAD)  # tip
    put.ellipsoid("head", (0.0100, 1.5935, 0.0865), (0.0062, 0.0062, 0.0085), k=0.006, register=HEAD)  # wing
    put.ellipsoid("head", (0.0056, 1.5868, 0.0905), (0.0032, 0.0030, 0.0048), k=0.003, register=HEAD, op=CARVE)


def _mouth(put: Placed, wide: float) -> None:
    put.ellipsoid("head", (0.0, 1.5680, 0.0660), (0.0270 * wide, 0.0200, 0.0180), k=0.014, register=HEAD)
    put.cone("head", (0.0035, 1.5725, 0.0812), (0.0236 * wide, 1.5744, 0.0695), 0.0038, 0.0020, k=0.004, register=HEAD)
    put.cone("head", (0.0, 1.5628, 0.0795), (0.0220 * wide, 1.5730, 0.0695), 0.0047, 0.0020, k=0.004, register=HEAD)
    put.cone(
        "head", (0.0, 1.5678, 0.0880), (0.0262 * wide, 1.5748, 0.0740), 0.0010, 0.0009, k=0.003, register=HEAD, op=CARVE
    )
    put.cone("head", (0.0, 1.5540, 0.0830), (0.0100, 1.5545, 0.0800), 0.0030, 0.0025, k=0.008, register=HEAD, op=CARVE)


def _ear(put: Placed) -> None:
    turn = _about_y(0.42) @ _about_x(-0.20)
    put.ellipsoid("head", (0.0715, 1.6250, 0.0060), (0.0055, 0.0270, 0.0165), turn=turn, k=0.006, register=HEAD)
    put.ellipsoid("head", (0.0680, 1.6020, 0.0125), (0.0045, 0.0085, 0.0070), turn=turn, k=0.008, register=HEAD)
    put.ellipsoid(
        "head", (0.0775, 1.6275, 0.0095), (0.0045, 0.0170, 0.0090), turn=turn, k=0.004, register=HEAD, op=CARVE
    )


def _hair(put: Placed, look: Look) -> None:
    _HAIR_CUTS[look.hair_kind](put)
    # the forehead and the face, open
    put.ellipsoid("head", (0.0, 1.6150, 0.0900), (0.0600, 0.0790, 0.0700), k=0.006, register=HAIR, op=CARVE)


def _bob(put: Placed) -> None:
    """Add hair that covers the ears and ends at the jaw."""
    put.ellipsoid("head", (0.0, 1.6620, -0.0160), (0.0800, 0.0868, 0.0960), register=HAIR)
    put.ellipsoid("head", (0.0, 1.6250, -0.0480), (0.0690, 0.0620, 0.0520), k=0.03, register=HAIR)
    put.ellipsoid("head", (0.0, 1.6920, 0.0200), (0.0700, 0.0480, 0.0640), k=0.03, register=HAIR)
    put.ellipsoid("head", (0.0, 1.5850, -0.0420), (0.0760, 0.0520, 0.0520), k=0.03, register=HAIR)
    put.cone("head", (0.0650, 1.6500, -0.0060), (0.0640, 1.5760, -0.0060), 0.0245, 0.0225, k=0.03, register=HAIR)
    put.cone("head", (0.0660, 1.6600, 0.0060), (0.0660, 1.5900, 0.0060), 0.0200, 0.0190, k=0.02, register=HAIR)
    put.ellipsoid("head", (0.0700, 1.5920, 0.0640), (0.0380, 0.0760, 0.0390), k=0.010, register=HAIR, op=CARVE)


def _short(put: Placed) -> None:
    """Add close hair that leaves the ears free."""
    put.ellipsoid("head", (0.0, 1.6615, -0.0150), (0.0772, 0.0848, 0.0945), register=HAIR)
    put.ellipsoid("head", (0.0, 1.6320, -0.0450), (0.0640, 0.0540, 0.0500), k=0.02, register=HAIR)
    put.ellipsoid("head", (0.0, 1.6900, 0.0200), (0.0660, 0.0480, 0.0630), k=0.03, register=HAIR)
    put.ellipsoid("head", (0.0720, 1.6050, 0.0330), (0.0340, 0.0560, 0.0330), k=0.006, register=HAIR, op=CARVE)
    put.ellipsoid("head", (0.0800, 1.5980, 0.0060), (0.0300, 0.0600, 0.0250), k=0.006, register=HAIR, op=CARVE)


_HAIR_CUTS = {"bob": _bob, "short": _short}


def hair_excess(registers: np.ndarray) -> np.ndarray:
    """Return how far hair stands above the head's skin (n,), metres, from a field's registers (n, 8)."""
    return registers[:, HEAD] - registers[:, HAIR]


def _about_y(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _about_x(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
