"""Names of columns as a person reads them: whole joints by their name, the rest with their axes."""

from __future__ import annotations

from itertools import groupby

from qmd_studio.motion.skeleton import Skeleton


def short_name(skeleton: Skeleton, column: int) -> str:
    """Return the name of a column without the name of its joint, "rx" of "root_rx"; the whole name where it has none.

    Raises `IndexError` for a column that does not exist.
    """
    name = skeleton.columns[column].name
    joint = skeleton.joints[skeleton.columns[column].joint].name
    rest = name.removeprefix(joint).strip(" ._:/-") if name != joint else ""
    return rest or name


def exact_columns(skeleton: Skeleton, fdf: int) -> str:
    """Return what the first `fdf` columns are: "root, lowerback rx ry", a joint alone where all its columns are in.

    An empty string for no column.
    """
    counts: dict[int, int] = {}
    for column in skeleton.columns:
        counts[column.joint] = counts.get(column.joint, 0) + 1
    groups = []
    for joint, members in groupby(range(min(fdf, skeleton.n_columns)), key=lambda i: skeleton.columns[i].joint):
        columns = list(members)
        groups.append(_group(skeleton, joint, columns, whole=len(columns) == counts[joint]))
    return ", ".join(groups)


def _group(skeleton: Skeleton, joint: int, columns: list[int], *, whole: bool) -> str:
    name = skeleton.joints[joint].name
    if whole:
        return name
    short = [short_name(skeleton, column) for column in columns]
    return " ".join((name, *short))
