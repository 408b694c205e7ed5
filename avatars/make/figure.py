"""The figures that are made: their proportions against H-Anim's default body, their colours and their clothes.

A part is a stretch of the body that keeps its shape and is scaled from one of its joints: a figure's joint centres and
surfaces are those of the default body, part by part, so that they fit together whatever the scales.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from qmd_studio.motion.hanim import hanim_joints

EYES = {"eyeball": (0.0300, 1.6325, 0.0640), "eyelid": (0.0300, 1.6325, 0.0640), "eyebrow": (0.0290, 1.6480, 0.0800)}
JAW = (0.0, 1.6130, 0.0200)
"""Centres that the table of joints leaves out, from the feature points infraorbitale, sellion and tragion."""

ANCHORS = {
    "trunk": "HumanoidRoot",
    "neck": "vc7",
    "head": "skullbase",
    "upperarm": "l_shoulder",
    "forearm": "l_elbow",
    "hand": "l_wrist",
    "thigh": "l_hip",
    "shank": "l_knee",
    "foot": "l_ankle",
}
_CHAIN = {
    "trunk": None,
    "neck": "trunk",
    "head": "neck",
    "upperarm": "trunk",
    "forearm": "upperarm",
    "hand": "forearm",
    "thigh": "trunk",
    "shank": "thigh",
    "foot": "shank",
}


@dataclass(frozen=True, slots=True)
class Look:
    """Colours, sRGB 0 to 1, and the places where clothes end, in metres of the default body."""

    skin: tuple[float, float, float]
    lips: tuple[float, float, float]
    hair: tuple[float, float, float]
    iris: tuple[float, float, float]
    shirt: tuple[float, float, float]
    trousers: tuple[float, float, float]
    shoes: tuple[float, float, float]
    soles: tuple[float, float, float]
    sleeve_y: float
    hair_kind: str = "short"
    face_height: float = 1.0
    face_depth: float = 1.0
    chest: float = 1.0
    eye_size: float = 1.0
    mouth: float = 1.0
    cheeks: float = 0.0


@dataclass(frozen=True, slots=True)
class Figure:
    """A named figure: a scale (3,) of each part and its looks."""

    name: str
    title: str
    look: Look
    scales: dict[str, tuple[float, float, float]] = field(default_factory=dict)

    def scale(self, part: str) -> np.ndarray:
        """Return the part's scales along x, y and z (3,)."""
        return np.asarray(self.scales.get(part, (1.0, 1.0, 1.0)))

    def place(self, part: str, points) -> np.ndarray:
        """Return where `points` (..., 3) of a part of the default body are in this figure, metres."""
        points = np.asarray(points, dtype=np.float64)
        anchor = default_centres()[ANCHORS[part]]
        return self._anchor(part) + self.scale(part) * (points - anchor)

    def _anchor(self, part: str) -> np.ndarray:
        before, anchor = _CHAIN[part], default_centres()[ANCHORS[part]]
        if before is not None:
            return self.place(before, anchor)
        return anchor + np.array([0.0, self._rise(), 0.0])

    def _rise(self) -> float:
        """Return how far the trunk moves so that the soles stay on the ground."""
        centres = default_centres()
        drop = sum(
            self.scale(part)[1] * (centres[a][1] - centres[b][1])
            for part, a, b in (
                ("trunk", "HumanoidRoot", "l_hip"),
                ("thigh", "l_hip", "l_knee"),
                ("shank", "l_knee", "l_ankle"),
            )
        )
        return drop + self.scale("foot")[1] * centres["l_ankle"][1] - centres["HumanoidRoot"][1]

    def centres(self) -> dict[str, np.ndarray]:
        """Return the centre (3,) of every joint by name, metres, parents before children."""
        result = {}
        for name, centre in default_centres().items():
            mirrored = name.startswith("r_")
            point = self.place(part_of("l_" + name[2:] if mirrored else name), centre * _flip(mirrored))
            result[name] = point * _flip(mirrored)
        return result


def part_of(joint: str) -> str:
    """Return the part that a joint of the left side or the middle belongs to; a part's anchor ends the part before."""
    plain = joint.removeprefix("l_")
    if joint.startswith("vc"):
        return "neck"
    if plain.startswith(("skull", "eye", "temporo")):
        return "head"
    for part, joints in (
        ("forearm", ("elbow",)),
        ("thigh", ("hip",)),
        ("shank", ("knee",)),
        ("upperarm", ("shoulder",)),
        ("foot", ("ankle", "subtalar", "midtarsal", "metatarsal")),
        ("hand", ("wrist", "thumb", "index", "middle", "ring", "pinky")),
    ):
        if plain.startswith(joints):
            return part
    return "trunk"


def default_centres() -> dict[str, np.ndarray]:
    """Return the default body's centres (3,) by joint name: H-Anim's, with eyes and jaw, parents before children."""
    result = {joint.name: np.array(joint.centre) for joint in hanim_joints()}
    result["temporomandibular"] = np.array(JAW)
    for side, sign in (("l", 1), ("r", -1)):
        for name, centre in EYES.items():
            result[f"{side}_{name}_joint"] = np.array(centre) * (sign, 1, 1)
    return result


def parents() -> dict[str, str | None]:
    """Return the parent of every joint by name."""
    result = {joint.name: joint.parent for joint in hanim_joints()}
    return result | {name: "skullbase" for name in default_centres() if name not in result}


def _flip(mirrored: bool) -> np.ndarray:
    return np.array([-1.0 if mirrored else 1.0, 1.0, 1.0])


ADA = Figure(
    "ada",
    "Ada",
    Look(
        skin=(0.86, 0.66, 0.53),
        lips=(0.75, 0.46, 0.41),
        hair=(0.20, 0.13, 0.09),
        iris=(0.30, 0.20, 0.10),
        shirt=(0.13, 0.22, 0.36),
        trousers=(0.23, 0.24, 0.27),
        shoes=(0.16, 0.13, 0.12),
        soles=(0.80, 0.78, 0.74),
        sleeve_y=0.935,
        hair_kind="bob",
    ),
)
TIM = Figure(
    "tim",
    "Tim",
    Look(
        skin=(0.93, 0.76, 0.64),
        lips=(0.86, 0.60, 0.53),
        hair=(0.48, 0.30, 0.14),
        iris=(0.22, 0.38, 0.48),
        shirt=(0.12, 0.36, 0.33),
        trousers=(0.30, 0.36, 0.50),
        shoes=(0.78, 0.26, 0.20),
        soles=(0.93, 0.92, 0.90),
        sleeve_y=1.235,
        face_height=0.86,
        face_depth=0.72,
        chest=0.55,
        eye_size=1.13,
        mouth=0.84,
        cheeks=1.0,
    ),
    {
        "trunk": (0.655, 0.724, 0.700),
        "neck": (0.700, 0.640, 0.700),
        "head": (0.985, 0.990, 0.975),
        "upperarm": (0.703, 0.655, 0.703),
        "forearm": (0.703, 0.639, 0.703),
        "hand": (0.735, 0.703, 0.735),
        "thigh": (0.703, 0.613, 0.703),
        "shank": (0.703, 0.613, 0.703),
        "foot": (0.745, 0.745, 0.745),
    },
)
FIGURES = (ADA, TIM)
