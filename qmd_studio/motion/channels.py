"""The columns of a joint whose freedoms are channels in a parent-parallel frame, as BVH has them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from qmd_studio.motion.skeleton import (
    IDENTITY,
    MAX_LEVEL,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Skeleton,
    SkeletonKind,
    Vector3,
    depths,
)

POSITIONS = ("Xposition", "Yposition", "Zposition")
ROTATIONS_ZYX = ("Zrotation", "Yrotation", "Xrotation")


def default_site_name(joint_name: str) -> str:
    """Return the name of an end site that has none of its own."""
    return f"{joint_name} end"


def channel_skeleton(
    joints: Sequence[tuple[str, int, Vector3, Sequence[str]]],
    end_sites: Sequence[EndSite],
    metres_per_unit: float = 1.0,
) -> Skeleton:
    """Build a skeleton of kind BVH from joints given as (name, parent, offset, channels), parents first.

    A position replaces its part of the offset; rotations multiply in the order of the channels. End sites are ordered
    by joint, levels are the depth in the tree, all nodes are measured points. Raises `FormatError` like `Skeleton`.
    """
    depth = depths(tuple(parent for _, parent, _, _ in joints))
    columns: list[Column] = []
    built: list[Joint] = []
    for index, (name, parent, offset, channels) in enumerate(joints):
        first = len(columns)
        level = min(depth[index], MAX_LEVEL)
        columns += [replace(_column(channel, name, index, offset), level=level) for channel in channels]
        product = tuple(i for i in range(first, len(columns)) if columns[i].kind is ColumnKind.ROTATION)
        built.append(Joint(name, parent, offset, product))
    return Skeleton(
        name=built[0].name if built else "",
        kind=SkeletonKind.BVH,
        joints=tuple(built),
        end_sites=tuple(sorted(end_sites, key=lambda site: site.joint)),
        columns=named_apart(columns),
        points=tuple(range(len(built) + len(end_sites))),
        metres_per_unit=metres_per_unit,
    )


def channel_of(column: Column) -> str:
    """Return the channel that a column is: "Xposition" to "Zrotation"."""
    return "XYZ"[column.axis] + ("rotation" if column.kind is ColumnKind.ROTATION else "position")


def has_channels(skeleton: Skeleton) -> bool:
    """Tell whether `skeleton` is as `channel_skeleton` builds it: then BVH holds its motions value for value."""
    return skeleton.kind is SkeletonKind.BVH and _is_preorder(skeleton) and _columns_are_channels(skeleton)


def _column(channel: str, joint_name: str, joint: int, offset: Vector3) -> Column:
    axis = "XYZ".index(channel[0])
    name = f"{joint_name} {channel}"
    if channel.endswith("rotation"):
        return Column(name, joint, ColumnKind.ROTATION, axis)
    return Column(name, joint, ColumnKind.TRANSLATION, axis, rest=offset[axis])


def named_apart(columns: list[Column]) -> tuple[Column, ...]:
    """Number the columns whose joints share a name, so that a column's name is its own."""
    seen: dict[str, int] = {}
    result = []
    for column in columns:
        count = seen[column.name] = seen.get(column.name, 0) + 1
        result.append(column if count == 1 else replace(column, name=f"{column.name} #{count}"))
    return tuple(result)


def _is_preorder(skeleton: Skeleton) -> bool:
    """Tell whether each joint follows its parent or the subtree of an elder child, as nested text needs it."""
    path: list[int] = []
    for index, joint in enumerate(skeleton.joints):
        while path and path[-1] != joint.parent:
            path.pop()
        if joint.parent >= 0 and not path:
            return False
        path.append(index)
    sites = [site.joint for site in skeleton.end_sites]
    return sites == sorted(sites)


def _columns_are_channels(skeleton: Skeleton) -> bool:
    owners = [column.joint for column in skeleton.columns]
    if owners != sorted(owners):
        return False
    for joint in skeleton.joints:
        if joint.orientation != IDENTITY or list(joint.product) != sorted(joint.product):
            return False
    moves = [(c.joint, c.axis) for c in skeleton.columns if c.kind is ColumnKind.TRANSLATION]
    return len(moves) == len(set(moves)) and all(_is_channel(skeleton, column) for column in skeleton.columns)


def _is_channel(skeleton: Skeleton, column: Column) -> bool:
    if column.kind is ColumnKind.TRANSLATION and column.rest != skeleton.joints[column.joint].offset[column.axis]:
        return False
    return column.sign == 1 and column.kind is not ColumnKind.OPAQUE
