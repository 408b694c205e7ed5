"""The skeleton: joints with rest offsets, the ordered columns of the motion matrix, and the points that are measured.

One model serves ASF, BVH and MPEG-4/H-Anim bodies. In column vectors, for each joint j with parent p:

    position[j] = position[p] + R[p] @ (offset[j] + sum over its translation columns of axis * (value - rest))
    R[j]        = R[p] @ orientation[j] @ product over `joint.product`, left to right, of rotation(axis * sign, value)

A joint is the near end of the bones it turns. End sites are the far ends of the last bones. Joints and end sites
together are the *nodes*, numbered joints first; `points` says which nodes an error is measured at.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TypeAlias

from qmd_studio.errors import FormatError

Vector3: TypeAlias = tuple[float, float, float]
Matrix3: TypeAlias = tuple[Vector3, Vector3, Vector3]

IDENTITY: Matrix3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
LARGEST = 1e12
"""The largest length in metres and angle in radians that is taken: poses are then finite, in single precision too."""

LENGTH_UNITS = (1e-6, 1e6)
"""The least and the largest length unit of a file, in metres."""

MAX_LEVEL = 6
"""The paper's deepest level (section 3.2): joints further out count as level 6."""


class ColumnKind(StrEnum):
    """What a column of the motion matrix does to its joint."""

    ROTATION = "rotation"
    TRANSLATION = "translation"
    OPAQUE = "opaque"
    """Carried along but moving nothing: MPEG-4 extension BAPs, whose meaning is the user's."""


class SkeletonKind(StrEnum):
    """The family a skeleton belongs to: it decides which writers can take its motions as they are."""

    ASF = "asf"
    BVH = "bvh"
    BAP = "bap"
    HANIM = "hanim"


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the motion matrix: a degree of freedom of a joint.

    `axis` is 0, 1, 2 for x, y, z of the joint's own rest frame; a positive value turns (or moves) about `sign` times
    that axis, by the right-hand rule. `rest` is the value that leaves the joint at its rest offset. `limits` are
    anatomical, in radians or metres. `level` is the paper's l (1 = root, largest effect, to 6).
    """

    name: str
    joint: int
    kind: ColumnKind
    axis: int
    sign: int = 1
    level: int = 1
    rest: float = 0.0
    limits: tuple[float, float] | None = None
    bap_id: int | None = None

    @property
    def unit(self) -> str:
        """The unit of the column's values inside the studio: "rad", "m", or "1" for an opaque column."""
        return {ColumnKind.ROTATION: "rad", ColumnKind.TRANSLATION: "m", ColumnKind.OPAQUE: "1"}[self.kind]


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint: `offset` in metres in the parent's rest frame, `orientation` from its own rest frame to the parent's.

    `product` holds the indices of its rotation columns in the order in which their matrices are multiplied, left to
    right; the leftmost is applied last. The order of the columns in the matrix is independent of it. `parent` is -1 for
    a root.
    """

    name: str
    parent: int
    offset: Vector3
    product: tuple[int, ...] = ()
    orientation: Matrix3 = IDENTITY


@dataclass(frozen=True, slots=True)
class EndSite:
    """The far end of a bone: `offset` in metres in the frame of joint number `joint`."""

    name: str
    joint: int
    offset: Vector3


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Joints (parents before children), end sites, columns, and the measured points (indices of nodes).

    `metres_per_unit` is the length unit of the file it came from, for display and for writing back.
    Raises `FormatError` where the parts do not fit together: a parent that does not come before its child, a column
    of no joint, a rotation column that its joint's product does not hold exactly once; and for a length that is not
    finite or above `LARGEST`, or a unit outside `LENGTH_UNITS`.
    """

    name: str
    kind: SkeletonKind
    joints: tuple[Joint, ...]
    end_sites: tuple[EndSite, ...]
    columns: tuple[Column, ...]
    points: tuple[int, ...]
    metres_per_unit: float = 1.0
    _hash: int = field(init=False, repr=False, compare=False, default=0)

    def __post_init__(self) -> None:
        _check(self)
        parts = (self.name, self.kind, self.joints, self.end_sites, self.columns, self.points, self.metres_per_unit)
        object.__setattr__(self, "_hash", hash(parts))

    def __hash__(self) -> int:
        return self._hash  # computed once: compiled chains are looked up by skeleton on every frame

    @property
    def n_columns(self) -> int:
        """The number m of degrees of freedom."""
        return len(self.columns)

    @property
    def n_nodes(self) -> int:
        """The number of joints and end sites."""
        return len(self.joints) + len(self.end_sites)

    @property
    def node_names(self) -> tuple[str, ...]:
        """The names of all nodes: joints, then end sites."""
        return tuple(j.name for j in self.joints) + tuple(s.name for s in self.end_sites)

    @property
    def point_names(self) -> tuple[str, ...]:
        """The names of the measured points, in the order of `points`."""
        names = self.node_names
        return tuple(names[node] for node in self.points)

    @property
    def levels(self) -> tuple[int, ...]:
        """The paper's level of each column: the table that selective averaging reads."""
        return tuple(column.level for column in self.columns)

    def joint_index(self, name: str) -> int:
        """Return the number of the joint called `name`; raises `KeyError` with the names that exist."""
        for index, joint in enumerate(self.joints):
            if joint.name == name:
                return index
        raise KeyError(f"no joint {name!r}; the joints are {', '.join(j.name for j in self.joints)}")

    def with_levels(self, levels: Mapping[str, int]) -> Skeleton:
        """Return this skeleton with the levels of the named columns replaced (1 to 6).

        Raises `FormatError` for a column that does not exist or a level outside 1 to 6.
        """
        names = {column.name for column in self.columns}
        for name, level in levels.items():
            if name not in names:
                raise FormatError("no such column", at=f"column {name!r}", hint="Use the names the level table lists")
            if not 1 <= level <= MAX_LEVEL:
                raise FormatError("a level is out of range", at=f"column {name!r}", wanted="1 to 6", got=str(level))
        columns = tuple(replace(c, level=levels.get(c.name, c.level)) for c in self.columns)
        return replace(self, columns=columns)

    def scaled(self, factor: float) -> Skeleton:
        """Return this skeleton with every length multiplied by `factor` (> 0), its file unit with it."""

        def lengths(vector: Vector3) -> Vector3:
            return (vector[0] * factor, vector[1] * factor, vector[2] * factor)

        def column(c: Column) -> Column:
            if c.kind is not ColumnKind.TRANSLATION:
                return c
            limits = None if c.limits is None else (c.limits[0] * factor, c.limits[1] * factor)
            return replace(c, rest=c.rest * factor, limits=limits)

        return replace(
            self,
            joints=tuple(replace(j, offset=lengths(j.offset)) for j in self.joints),
            end_sites=tuple(replace(s, offset=lengths(s.offset)) for s in self.end_sites),
            columns=tuple(column(c) for c in self.columns),
            metres_per_unit=self.metres_per_unit * factor,
        )


def depths(parents: tuple[int, ...]) -> tuple[int, ...]:
    """Return the depth of each joint in the tree, a root being 1; parents come before children."""
    result: list[int] = []
    for parent in parents:
        result.append(1 if parent < 0 else result[parent] + 1)
    return tuple(result)


def _check(skeleton: Skeleton) -> None:
    if not skeleton.joints:
        raise FormatError("the skeleton has no joint", wanted="at least a root")
    low, high = LENGTH_UNITS
    if not low <= skeleton.metres_per_unit <= high:
        wanted, got = f"{low:g} to {high:g} metres", f"{skeleton.metres_per_unit:g}"
        raise FormatError("the length unit cannot be used", wanted=wanted, got=got)
    n_joints = len(skeleton.joints)
    for index, joint in enumerate(skeleton.joints):
        if not -1 <= joint.parent < index:
            raise FormatError("a joint's parent does not come before it", at=f"joint {joint.name!r}")
        _check_lengths(joint.offset, f"joint {joint.name!r}")
    for site in skeleton.end_sites:
        if not 0 <= site.joint < n_joints:
            raise FormatError("an end site hangs from no joint", at=f"end site {site.name!r}")
        _check_lengths(site.offset, f"end site {site.name!r}")
    _check_columns(skeleton)
    for node in skeleton.points:
        if not 0 <= node < skeleton.n_nodes:
            raise FormatError("a measured point is not a node", at=f"point {node}")


def _check_columns(skeleton: Skeleton) -> None:
    n_joints = len(skeleton.joints)
    rotations: dict[int, list[int]] = {}
    for index, column in enumerate(skeleton.columns):
        if not 0 <= column.joint < n_joints:
            raise FormatError("a column belongs to no joint", at=f"column {column.name!r}")
        _check_lengths((column.rest,), f"column {column.name!r}")
        if column.axis not in (0, 1, 2) or column.sign not in (1, -1):
            raise FormatError("a column has no axis", at=f"column {column.name!r}", wanted="axis 0 to 2, sign 1 or -1")
        if column.kind is ColumnKind.ROTATION:
            rotations.setdefault(column.joint, []).append(index)
    for index, joint in enumerate(skeleton.joints):
        if sorted(joint.product) != rotations.get(index, []):
            raise FormatError("a joint's product and its rotation columns differ", at=f"joint {joint.name!r}")


def _check_lengths(lengths: tuple[float, ...], at: str) -> None:
    for length in lengths:
        if not abs(length) <= LARGEST:
            wanted = f"at most {LARGEST:g} m in size"
            raise FormatError("a length cannot be used", at=at, wanted=wanted, got=f"{length:g}")
