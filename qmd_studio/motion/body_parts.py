"""Which part of a body each joint is: root, spine, elbow, knee, first joint of the thumb, in any program's naming.

Names are compared with the columns of `resources/tables/joint_parts.csv`, one a naming; the naming with the most hits
is taken. What it leaves open is found by the shape of the tree. LeftShoulder is the collar bone in some namings and
the upper arm in others: where no joint is left to be the upper arm, the one above the elbow is it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from qmd_studio.motion.hanim import table_rows
from qmd_studio.motion.joint_names import Limb, plain_names
from qmd_studio.motion.kinematics import node_positions, rest_values
from qmd_studio.motion.limbs import find_limbs
from qmd_studio.motion.skeleton import Skeleton

BY_SHAPE = "shape"
"""The naming of a skeleton whose names say nothing."""
FINGERS = ("index", "middle", "ring", "pinky")
_MIDDLE = ("root", "pelvis", "spine", "neck", "head")
_LEG, _ARM = ("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")
_ENOUGH = 6


@dataclass(frozen=True, slots=True)
class BodyParts:
    """The joints of a body: `named` gives parts of one joint each, sided ones as "l_knee".

    `spine` runs from above the root to the joint that carries the arms, `neck` from there to below the head; joints
    below one another. `naming` is the column of the table that fits best, with `hits` of its names found.
    """

    naming: str
    hits: int
    root: int
    named: Mapping[str, int]
    spine: tuple[int, ...]
    neck: tuple[int, ...]

    @property
    def head(self) -> int | None:
        """The head's joint, if there is one."""
        return self.named.get("head")

    @property
    def pelvis(self) -> int:
        """The joint that carries the legs: the root in most skeletons."""
        return self.named.get("pelvis", self.root)

    def part_of(self) -> dict[int, str]:
        """Return the part of each joint that is one; "spine" and "neck" for all of theirs."""
        parts = {joint: part for part, joint in self.named.items()}
        parts |= dict.fromkeys(self.spine, "spine") | dict.fromkeys(self.neck, "neck")
        return parts | ({self.head: "head"} if self.head is not None else {}) | {self.root: "root"}


def namings() -> tuple[str, ...]:
    """Return the namings that are known, such as "mixamo"."""
    return tuple(column for column in table_rows("joint_parts.csv")[0] if column != "part")


def naming_hits(skeleton: Skeleton) -> dict[str, int]:
    """Return for each naming how many joints of `skeleton` it has a name for."""
    return {naming: sum(len(joints) for joints in _hits(skeleton, naming).values()) for naming in namings()}


@lru_cache(maxsize=64)
def parts_of(skeleton: Skeleton) -> BodyParts:
    """Return which joint is what. Nothing is refused: the first joint is a root at least."""
    hits = naming_hits(skeleton)
    naming = max(hits, key=lambda name: hits[name])
    named = {part: joints[0] for part, joints in _hits(skeleton, naming).items() if part not in ("spine", "neck")}
    if hits[naming] < _ENOUGH:
        naming, named = BY_SHAPE, {}
    parents = tuple(joint.parent for joint in skeleton.joints)
    limbs = find_limbs(skeleton, node_positions(skeleton, rest_values(skeleton)[None])[0])
    for arms, names in ((limbs.arms, _ARM), (limbs.legs, _LEG)):
        for limb in arms:
            _complete(named, limb, names, parents)
    if "head" not in named and limbs.head is not None:
        named["head"] = limbs.head
    return _with_trunk(naming, hits.get(naming, 0), named, parents)


@lru_cache(maxsize=1)
def _names() -> dict[str, dict[tuple[str, bool], str]]:
    """Return for each naming the part of (plain name, whether it has a side)."""
    found: dict[str, dict[tuple[str, bool], str]] = {naming: {} for naming in namings()}
    for row in table_rows("joint_parts.csv"):
        for naming, of_name in found.items():
            for name in filter(None, row[naming].split("|")):
                of_name.setdefault((name, row["part"] not in _MIDDLE), row["part"])
    return found


def _hits(skeleton: Skeleton, naming: str) -> dict[str, list[int]]:
    """Return the joints of each part, first come first served; only spine and neck have several."""
    of_name, found = _names()[naming], dict[str, list[int]]()
    for joint, (name, side) in enumerate(plain_names(skeleton)):
        part = of_name.get((re.sub(r"[^a-z0-9]", "", name), side != 0))
        if part is None or skeleton.joints[joint].name.startswith("__"):  # MakeHuman's helpers to joints of that name
            continue
        key = {1: "l_", -1: "r_", 0: ""}[side] + part
        if part in ("spine", "neck") or key not in found:
            found.setdefault(key, []).append(joint)
    return found


def _complete(named: dict[str, int], limb: Limb, names: tuple[str, str, str], parents: tuple[int, ...]) -> None:
    """Fill in what the naming left open of a limb, or all of it where its joints do not follow one another."""
    side = "l_" if limb.side > 0 else "r_"
    upper, lower, end = (side + name for name in names)
    collar = side + "clavicle"
    if upper not in named and named.get(collar) in limb.upper:
        named[upper] = named.pop(collar)
    ordered = [named[key] for key in (upper, lower, end) if key in named]
    if any(above not in _path(parents, below) for above, below in pairwise(ordered)):
        for key in (upper, lower, end):
            named.pop(key, None)
    named.setdefault(upper, limb.upper[0])
    if limb.lower:
        named.setdefault(lower, limb.lower[0])
    if names is _ARM and named.get(side + "forearm_twist") == limb.end and end not in named:
        named.pop(side + "forearm_twist")  # the forearm's own turn has no joint here: this one is the hand
    if limb.end not in (named[upper], named.get(lower)):
        named.setdefault(end, limb.end)
    if names is _ARM and limb.girdle and limb.girdle[-1] != named[upper]:
        named.setdefault(collar, limb.girdle[-1])


def _with_trunk(naming: str, hits: int, named: dict[str, int], parents: tuple[int, ...]) -> BodyParts:
    hips = [_path(parents, named[key]) for key in ("l_hip", "r_hip") if key in named]
    arms = [_path(parents, named[key])[:-1] for key in ("l_shoulder", "r_shoulder") if key in named]
    head = _path(parents, named["head"]) if "head" in named else ()
    pelvis = _last_common([path[:-1] for path in hips], 0) if hips else named.get("root", 0)
    top = head[:-1] or (_common(arms) if arms else ())
    root = _last_common([top, _path(parents, pelvis)], pelvis) if top else pelvis
    chest = _last_common([top, *arms], root) if arms and top else (top[-1] if top else root)
    trunk = top[top.index(root) + 1 :] if root in top else ()
    split = trunk.index(chest) + 1 if chest in trunk else 0
    named = {part: joint for part, joint in named.items() if part not in ("root", "pelvis")}
    if pelvis != root:
        named["pelvis"] = pelvis
    return BodyParts(naming, hits, root, named, trunk[:split], trunk[split:])


def _path(parents: tuple[int, ...], joint: int) -> tuple[int, ...]:
    path = [joint]
    while parents[path[-1]] >= 0:
        path.append(parents[path[-1]])
    return tuple(path[::-1])


def _common(paths: list[tuple[int, ...]]) -> tuple[int, ...]:
    shared: list[int] = []
    for level in zip(*paths, strict=False):
        if len(set(level)) > 1:
            break
        shared.append(level[0])
    return tuple(shared)


def _last_common(paths: list[tuple[int, ...]], default: int) -> int:
    return (_common(paths) or (default,))[-1]
