"""The shape of the left hand: palm toward -x, fingers down, thumb forward, in metres of the default body."""

from __future__ import annotations

import numpy as np

from avatars.make.figure import default_centres
from avatars.make.placing import Placed
from qmd_studio.motion.hanim import table_rows

FINGERS = ("index", "middle", "ring", "pinky")
HAND, FIRST = 4, 5
"""Registers: the palm with the thumb, and the fingers."""

_RADII = {  # at the knuckle, the two joints and the tip
    "index": (0.0119, 0.0108, 0.0099, 0.0084),
    "middle": (0.0121, 0.0111, 0.0101, 0.0087),
    "ring": (0.0117, 0.0106, 0.0096, 0.0082),
    "pinky": (0.0108, 0.0095, 0.0085, 0.0073),
}
_THUMB = (0.0150, 0.0128, 0.0110, 0.0086)
_PALM = (  # y, centre x, centre z, half thickness, half width
    (0.885, 0.1984, -0.0583, 0.0170, 0.0240),
    (0.862, 0.1980, -0.0585, 0.0185, 0.0275),
    (0.845, 0.1968, -0.0610, 0.0175, 0.0340),
    (0.825, 0.1962, -0.0640, 0.0160, 0.0400),
    (0.805, 0.1960, -0.0655, 0.0145, 0.0435),
    (0.788, 0.1962, -0.0657, 0.0125, 0.0445),
    (0.764, 0.1965, -0.0657, 0.0090, 0.0420),
)


def finger_points(finger: str) -> np.ndarray:
    """Return knuckle, two joints and tip (4, 3) of a finger or the thumb of the default body."""
    centres = default_centres()
    tip = next(r for r in table_rows("hanim_sites.csv") if r["name"] == f"l_{finger}_distal_tip")
    return np.array([*(centres[f"l_{finger}{i}"] for i in (1, 2, 3)), [float(tip[a]) for a in ("x_m", "y_m", "z_m")]])


def add_hand(put: Placed) -> None:
    """Add palm, fingers and thumb."""
    put.loft("hand", 1, _PALM, caps=(0.012, 0.010), register=HAND)
    put.ellipsoid("hand", (0.1880, 0.820, -0.090), (0.0095, 0.030, 0.0145), k=0.012, register=HAND)  # hypothenar
    put.ellipsoid("hand", (0.1870, 0.795, -0.0640), (0.0075, 0.0150, 0.0360), k=0.012, register=HAND)  # pads
    for finger in FINGERS:
        _finger(put, finger)
    _thumb(put)
    put.join(FIRST, into=HAND, k=(0.0015, 0.010), levels=[("hand", 0.760), ("hand", 0.782)])
    put.join(HAND, into=0, k=(0.0, 0.005), levels=[("hand", 0.835), ("hand", 0.850)])


def _finger(put: Placed, finger: str) -> None:
    points, (r1, r2, r3, r4) = finger_points(finger), _RADII[finger]
    down = (points[3] - points[2]) / np.linalg.norm(points[3] - points[2])
    end = points[3] - r4 * down
    outward = np.array([1.0, 0.0, 0.0])
    start = points[0] + np.array([-0.001, 0.016, 0.0])
    put.cone("hand", start, points[0], r1 * 0.95, r1, k=0.004, register=FIRST)
    middle = (points[0] + points[1]) / 2
    put.cone("hand", points[0], middle, r1, r2 * 0.97, k=0.0008, register=FIRST)
    put.cone("hand", middle, points[1], r2 * 0.97, r2, k=0.0008, register=FIRST)
    middle = (points[1] + points[2]) / 2
    put.cone("hand", points[1], middle, r2, r3 * 0.97, k=0.0008, register=FIRST)
    put.cone("hand", middle, points[2], r3 * 0.97, r3, k=0.0008, register=FIRST)
    put.cone("hand", points[2], end, r3, r4, k=0.0008, register=FIRST)
    put.ellipsoid("hand", end - 0.0015 * outward, (r4 * 0.95, r4 * 1.1, r4 * 1.02), k=0.003, register=FIRST)
    for place, radius in ((points[0], r1), (points[1], r2)):
        bump = place + (0.36 * radius) * outward
        put.ellipsoid("hand", bump, (radius * 0.70, radius * 0.95, radius * 0.72), k=0.0025, register=FIRST)


def _thumb(put: Placed) -> None:
    points, (r1, r2, r3, r4) = finger_points("thumb"), _THUMB
    start = points[0] + np.array([-0.003, -0.012, 0.018])
    put.cone("hand", start, points[1], r1, r2, k=0.012, register=HAND)
    put.ellipsoid("hand", (0.1890, 0.8290, -0.0150), (0.0120, 0.0180, 0.0300), k=0.014, register=HAND)  # thenar
    web = np.array([[0.1945, 0.8230, -0.0100], [0.1955, 0.8000, -0.0330]])
    put.cone("hand", web[0], web[1], 0.0095, 0.0095, k=0.018, register=HAND)
    away = (points[3] - points[2]) / np.linalg.norm(points[3] - points[2])
    end = points[3] - r4 * away
    put.cone("hand", points[1], points[2], r2, r3, k=0.004, register=HAND)
    put.cone("hand", points[2], end, r3, r4, k=0.003, register=HAND)
    put.ellipsoid(
        "hand", end + np.array([-0.001, -0.0006, 0.0]), (r4 * 1.02, r4 * 0.95, r4 * 1.1), k=0.004, register=HAND
    )


def nail_frames() -> list[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    """Return (joint, centre, axes as columns, radii) of each nail of the default body; the third axis is along it."""
    result = []
    for finger in FINGERS:
        points, radius = finger_points(finger), _RADII[finger][3]
        result.append(_nail(f"l_{finger}3", points, radius, np.array([1.0, 0.0, 0.0])))
    result.append(_nail("l_thumb3", finger_points("thumb"), _THUMB[3], np.array([0.15, 1.0, 0.3])))
    return result


def _nail(joint, points, radius, outward):
    along = (points[3] - points[2]) / np.linalg.norm(points[3] - points[2])
    outward = outward - (outward @ along) * along
    outward /= np.linalg.norm(outward)
    centre = points[3] - 1.05 * radius * along + 0.86 * radius * outward
    turn = np.stack([outward, np.cross(along, outward), along], axis=1)
    return joint, centre, turn, np.array([0.0021, 0.66 * radius, 0.85 * radius])
