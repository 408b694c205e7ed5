"""The 296 body animation parameters of MPEG-4 (ISO/IEC 14496-2), and the H-Anim skeleton that they move.

Everything about a parameter is a row of `resources/tables/baps.csv`: its joint, its signed axis, the place of its turn
in its joint's composition, its unit and its coding group. The code here only reads it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from qmd_studio.motion.hanim import difference, hanim_end_sites, hanim_joints, table_rows
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind

N_BAPS = 296
"""All parameters, extensions included."""

N_DEFINED_BAPS = 186
"""The parameters that the standard defines; 187 to 296 are extensions, whose meaning is the user's."""

N_OLD_BAPS = 169
"""The parameters of the older numbering (`Bap.old_id`)."""

_ROOT_ORDER = (182, 181, 183, 186, 184, 185)
_SI_PER_UNIT = {"1e-5 rad": 1e-5, "mm": 1e-3, "1": 1.0}


@dataclass(frozen=True, slots=True)
class Bap:
    """One body animation parameter.

    A positive value turns (right-hand rule) or moves by `sign` times `axis` (0, 1, 2 for x to the body's left, y up,
    z forward). Among the turns of one joint that with the least `applied` happens first; all axes are fixed to the
    joint. `si_per_unit` is radians or metres for one unit of the file (1 for an extension). `group` and `place` give
    the order of coding; `step` and `fine_step` are quantiser steps in file units. `loa` is the least H-Anim level that
    has the joint. `limits` are anatomical, in radians. `old_id` is the number among the 169 of version 3.0.
    """

    id: int
    name: str
    joint: str | None
    kind: ColumnKind
    axis: int
    sign: int
    applied: int
    si_per_unit: float
    group: int
    place: int
    step: int
    fine_step: int
    loa: int | None
    old_id: int | None
    positive_means: str
    limits: tuple[float, float] | None


@lru_cache(maxsize=1)
def bap_table() -> tuple[Bap, ...]:
    """Return the 296 parameters; parameter `id` stands at `id - 1`."""
    limits = {int(row["bap_id"]): _limits(row) for row in table_rows("joint_limits.csv")}
    return tuple(_bap(row, limits.get(int(row["id"]))) for row in table_rows("baps.csv"))


def bap(bap_id: int) -> Bap:
    """Return parameter `bap_id`, 1 to 296; raises `KeyError` for any other number."""
    if not 1 <= bap_id <= N_BAPS:
        raise KeyError(f"no body animation parameter {bap_id}: they are 1 to {N_BAPS}")
    return bap_table()[bap_id - 1]


@lru_cache(maxsize=2)
def bap_skeleton(*, extensions: bool = False) -> Skeleton:
    """Return the H-Anim skeleton with a column per parameter: 186, or 296 with the extensions as opaque columns last.

    Columns are ordered by the paper's levels, the root first, so that FDF means on them what it means in the paper.
    Joints and end sites are all measured points.
    """
    number = {joint.name: index for index, joint in enumerate(hanim_joints())}
    columns = tuple(_column(bap(bap_id), level, number) for bap_id, level in _ordered_ids(extensions))
    turns: dict[int, list[int]] = {}
    for index, column in enumerate(columns):
        if column.kind is ColumnKind.ROTATION:
            turns.setdefault(column.joint, []).append(index)
    joints = _joints({joint: _product(indices, columns) for joint, indices in turns.items()})
    end_sites = hanim_end_sites()
    return Skeleton(
        name="H-Anim LOA-3",
        kind=SkeletonKind.BAP,
        joints=joints,
        end_sites=end_sites,
        columns=columns,
        points=tuple(range(len(joints) + len(end_sites))),
    )


def column_of(bap_id: int) -> int:
    """Return the column of parameter `bap_id` in `bap_skeleton`; raises `KeyError` where there is no such parameter.

    A number above 186 has a column only in `bap_skeleton(extensions=True)`, whose first 186 columns are the same.
    """
    return _column_numbers()[bap(bap_id).id]


@lru_cache(maxsize=1)
def _column_numbers() -> dict[int, int]:
    return {bap_id: index for index, (bap_id, _) in enumerate(_ordered_ids(True))}


def _ordered_ids(extensions: bool) -> list[tuple[int, int]]:
    """Return (parameter, level) in the order of the columns."""
    of_joint: dict[str, list[int]] = {}
    for parameter in bap_table()[:N_DEFINED_BAPS]:
        of_joint.setdefault(str(parameter.joint), []).append(parameter.id)
    of_joint[hanim_joints()[0].name] = list(_ROOT_ORDER)
    ordered: list[tuple[int, int]] = []
    for row in table_rows("bap_levels.csv"):
        ordered += [(bap_id, int(row["level"])) for bap_id in of_joint[row["joint"]]]
    if extensions:
        ordered += [(bap_id, 6) for bap_id in range(N_DEFINED_BAPS + 1, N_BAPS + 1)]
    return ordered


def _column(parameter: Bap, level: int, number: dict[str, int]) -> Column:
    return Column(
        name=parameter.name,
        joint=number[parameter.joint] if parameter.joint else 0,
        kind=parameter.kind,
        axis=parameter.axis,
        sign=parameter.sign,
        level=level,
        limits=parameter.limits,
        bap_id=parameter.id,
    )


def _product(indices: list[int], columns: tuple[Column, ...]) -> tuple[int, ...]:
    """Return the joint's rotation columns as factors: the turn that happens last stands leftmost."""
    return tuple(sorted(indices, key=lambda index: -bap(columns[index].bap_id or 0).applied))


def _joints(products: dict[int, tuple[int, ...]]) -> tuple[Joint, ...]:
    number = {joint.name: index for index, joint in enumerate(hanim_joints())}
    centres = {joint.name: joint.centre for joint in hanim_joints()}
    return tuple(
        Joint(
            name=joint.name,
            parent=number[joint.parent] if joint.parent else -1,
            offset=difference(joint.centre, centres[joint.parent]) if joint.parent else joint.centre,
            product=products.get(index, ()),
        )
        for index, joint in enumerate(hanim_joints())
    )


def _limits(row: dict[str, str]) -> tuple[float, float]:
    return (math.radians(float(row["min_deg"])), math.radians(float(row["max_deg"])))


def _bap(row: dict[str, str], limits: tuple[float, float] | None) -> Bap:
    axis = row["axis"]
    return Bap(
        id=int(row["id"]),
        name=row["name"],
        joint=row["joint"] or None,
        kind=ColumnKind(row["kind"]),
        axis="xyz".index(axis[1]) if axis else 0,
        sign=-1 if axis.startswith("-") else 1,
        applied=int(row["applied"] or 0),
        si_per_unit=_SI_PER_UNIT[row["unit"]],
        group=int(row["group"]),
        place=int(row["place"]),
        step=int(row["step"]),
        fine_step=int(row["fine_step"]),
        loa=int(row["loa"]) if row["loa"] else None,
        old_id=int(row["old_id"]) if row["old_id"] else None,
        positive_means=row["positive_means"],
        limits=limits,
    )
