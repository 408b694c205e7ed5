"""Joint names without prefix and side, however the program that wrote them spells left and right; limbs of joints."""

from __future__ import annotations

import re
from dataclasses import dataclass

from qmd_studio.motion.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class Limb:
    """An arm or a leg: joints of the girdle, the upper and the lower part, and the hand or foot. `side` is +1 left."""

    side: int
    girdle: tuple[int, ...]
    upper: tuple[int, ...]
    lower: tuple[int, ...]
    end: int


def plain_names(skeleton: Skeleton) -> list[tuple[str, int]]:
    """Return each joint's name in lower case without prefix and side, and its side: +1 left, -1 right, 0 neither."""
    return [_plain(joint.name) for joint in skeleton.joints]


def _plain(name: str) -> tuple[str, int]:
    name = re.sub(r"^.*:", "", name)
    name = re.sub(r"^(Character\d*|Bip\d*|Bip\d+|Armature|rig)[_ ]+", "", name)
    for pattern, keep in (
        (r"^(?P<s>[lr])[_. ](?P<rest>.+)$", "rest"),
        (r"^(?P<s>left|right)[_. ]?(?P<rest>.*)$", "rest"),
        (r"^(?P<rest>.+?)[_. ]?(?P<s>left|right)$", "rest"),
        (r"^(?P<rest>.+)[_. ](?P<s>[lr])$", "rest"),
    ):
        found = re.match(pattern, name, re.IGNORECASE)
        if found:
            return found[keep].lower().lstrip("_"), 1 if found["s"].lower().startswith("l") else -1
    found = re.match(r"^(?P<s>[lLrR])(?P<rest>[A-Z].*)$", name) or re.match(
        r"^(?P<s>[lr])(?P<rest>hip|femur|tibia|foot|toe|clavicle|humerus|radius|wrist|hand|finger|thumb|shoulder|arm|leg|ankle|elbow|knee).*$",
        name,
        re.IGNORECASE,
    )
    if found:
        return name[1:].lower(), 1 if found["s"] in "lL" else -1
    return name.lower().lstrip("_"), 0
