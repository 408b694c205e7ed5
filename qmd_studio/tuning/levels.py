"""The paper's level of each column as it comes, before anyone edits it."""

from __future__ import annotations

from qmd_studio.motion.skeleton import MAX_LEVEL, Skeleton, SkeletonKind, depths


def default_levels(skeleton: Skeleton) -> tuple[int, ...]:
    """Return the level of each column that a reader gives it: 1 the root, to 6.

    For MPEG-4 and H-Anim skeletons the table of the body animation parameters; for all others, and for columns that the
    table does not know, the depth of the joint in the tree, capped (section 3.2 of the paper).
    """
    depth = depths(tuple(joint.parent for joint in skeleton.joints))
    by_depth = tuple(min(depth[column.joint], MAX_LEVEL) for column in skeleton.columns)
    if skeleton.kind not in (SkeletonKind.BAP, SkeletonKind.HANIM):
        return by_depth
    table = _levels_by_name()
    return tuple(table.get(c.name, level) for c, level in zip(skeleton.columns, by_depth, strict=True))


def _levels_by_name() -> dict[str, int]:
    from qmd_studio.motion.bap import bap_skeleton  # its tables are read from disk: only for those who ask

    return {column.name: column.level for column in bap_skeleton().columns}
