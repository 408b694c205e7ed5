"""The two generations of H-Anim's joint names, and the level of articulation that a set of joints stands for."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from qmd_studio.motion.hanim import table_rows


def canonical_joint(name: str) -> str:
    """Return the name that H-Anim 2 (ISO/IEC 19774-1:2019) gives the joint; a name of no standard stays as it is."""
    return _names().get(name.lower(), name)


def level_of_articulation(names: Iterable[str]) -> int:
    """Return the level of articulation, 0 to 4, that joints of these names come nearest to.

    It is the highest level of which half the joints are there, those that it adds to the level below, and so below.
    """
    levels = _levels()
    present = {canonical_joint(name) for name in names}
    for level in range(1, 5):
        added = [name for name, own in levels.items() if own == level]
        if 2 * sum(name in present for name in added) < len(added):
            return level - 1
    return 4


def joint_of_segment(segment: str) -> str | None:
    """Return the H-Anim 2 name of the joint that carries the segment `segment`, None for a name of no standard."""
    return _segments().get(segment.lower())


def segment_of_joint(joint: str) -> str:
    """Return what the standard calls the segment that `joint` carries, "" for a joint of no standard."""
    canonical = canonical_joint(joint)
    return next((name for name, owner in _segments().items() if owner == canonical), "")


@lru_cache(maxsize=1)
def _names() -> dict[str, str]:
    rows = table_rows("hanim_names.csv")
    found = {row["v1"].lower(): row["name"] for row in rows if row["v1"]}
    found |= {row["name"].lower(): row["name"] for row in rows}
    found["humanoidroot"] = "humanoid_root"
    for name in list(found.values()):  # drafts leave out the ray, which is the second toe's
        if name.endswith("_2") and "tarso" in name:
            found.setdefault(name[:-2], name)
    return found


@lru_cache(maxsize=1)
def _levels() -> dict[str, int]:
    return {row["name"]: int(row["loa"]) for row in table_rows("hanim_names.csv")}


@lru_cache(maxsize=1)
def _segments() -> dict[str, str]:
    rows = table_rows("hanim_names.csv")
    found = {row["segment"].lower(): row["name"] for row in rows if row["segment"]}
    for row in rows:
        if row["segment_v1"]:
            found.setdefault(row["segment_v1"].lower(), row["name"])
    return found
