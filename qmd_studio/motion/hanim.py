"""The H-Anim body at level of articulation 3: joint centres and end sites, from the tables that ship.

Metres, x to the body's left, y up, z forward; feet on y = 0, arms hanging, palms to the thighs. Names are those of
H-Anim 1, which MPEG-4 uses (ISO/IEC 19774, ISO/IEC 14496-2). Eyes and jaw are left out: no body animation parameter
moves them. The right side mirrors the left, as in the published example.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import lru_cache

from qmd_studio.assets import resource
from qmd_studio.motion.skeleton import EndSite, Vector3


@dataclass(frozen=True, slots=True)
class HAnimJoint:
    """A joint at rest: `centre` in metres in the body's own space; `parent` is None for the root."""

    name: str
    parent: str | None
    centre: Vector3


def table_rows(name: str) -> list[dict[str, str]]:
    """Return the rows of a table that ships, such as `table_rows("baps.csv")`, as text by column name."""
    with resource("tables", name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@lru_cache(maxsize=1)
def hanim_joints() -> tuple[HAnimJoint, ...]:
    """Return the 87 joints that body animation parameters move, parents before children."""
    return tuple(
        HAnimJoint(row["name"], row["parent"] or None, _position(row)) for row in table_rows("hanim_joints.csv")
    )


def hanim_end_sites() -> tuple[EndSite, ...]:
    """Return the ends of the last bones (skull, heels, second toes, finger tips), joints numbered as `hanim_joints`."""
    number = {joint.name: index for index, joint in enumerate(hanim_joints())}
    centres = {joint.name: joint.centre for joint in hanim_joints()}
    return tuple(
        EndSite(row["name"], number[row["joint"]], difference(_position(row), centres[row["joint"]]))
        for row in table_rows("hanim_sites.csv")
    )


def difference(a: Vector3, b: Vector3) -> Vector3:
    """Return a - b, rounded to the tables' tenth of a millimetre so that equal bones have equal offsets."""
    return (round(a[0] - b[0], 4), round(a[1] - b[1], 4), round(a[2] - b[2], 4))


def _position(row: dict[str, str]) -> Vector3:
    return (float(row["x_m"]), float(row["y_m"]), float(row["z_m"]))
