"""Two knobs before any codec: fewer frames a second, and fewer columns, with what a player makes of them.

A reduced motion is a motion like any other: every k-th frame at a k-th of the rate, on a skeleton that lacks the
dropped columns and holds their first values in its joints' rest instead. A reduced file needs nothing of its decoder.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import CodecError
from qmd_studio.motion.in_between import JUMP
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.rotation import axis_rotation
from qmd_studio.motion.skeleton import MAX_LEVEL, ColumnKind, Joint, Matrix3, Skeleton, Vector3

MAX_LOA = 3
"""The highest H-Anim level of articulation that tells joints apart: bodies here have no more."""


@dataclass(frozen=True, slots=True)
class Reduction:
    """What is left out: `fps_divisor` k keeps every k-th frame, `max_level` drops columns of a higher level.

    `max_loa` drops the body animation parameters of joints that an H-Anim body of that level of articulation (0 to 3)
    lacks. A joint keeps all its rotations as long as one of them stays. The default reduces nothing.
    """

    fps_divisor: int = 1
    max_level: int = MAX_LEVEL
    max_loa: int | None = None

    def __post_init__(self) -> None:
        if self.fps_divisor < 1:
            raise CodecError("frames cannot be kept so often", wanted="every 1 or more", got=str(self.fps_divisor))
        if not 1 <= self.max_level <= MAX_LEVEL:
            raise CodecError("a level is out of range", wanted=f"1 to {MAX_LEVEL}", got=str(self.max_level))
        if self.max_loa is not None and not 0 <= self.max_loa <= MAX_LOA:
            wanted = f"a level of articulation of 0 to {MAX_LOA}"
            raise CodecError("a level is out of range", wanted=wanted, got=str(self.max_loa))

    def kept_columns(self, skeleton: Skeleton) -> BoolArray:
        """Return which columns (n_columns,) stay; raises `CodecError` where none does, or `max_loa` says nothing."""
        kept = np.array([column.level <= self.max_level for column in skeleton.columns], dtype=np.bool_)
        if self.max_loa is not None:
            kept &= _within_loa(skeleton, self.max_loa)
        turning = {c.joint for c, k in zip(skeleton.columns, kept, strict=True) if k and c.kind is ColumnKind.ROTATION}
        together = [c.kind is ColumnKind.ROTATION and c.joint in turning for c in skeleton.columns]
        kept |= np.array(together, dtype=np.bool_)
        if not kept.any() and self != Reduction():
            raise CodecError("no column would be left", hint="Keep higher levels")
        return kept

    def n_columns(self, skeleton: Skeleton) -> int:
        """Return how many columns are left; raises as `kept_columns` does."""
        if self.max_level == MAX_LEVEL and self.max_loa is None:
            return skeleton.n_columns
        return int(self.kept_columns(skeleton).sum())

    def n_rows(self, n_frames: int) -> int:
        """Return the rows of differences (the paper's n) that are left of `n_frames` frames."""
        return -(-n_frames // self.fps_divisor) - 1

    def reduce(self, motion: Motion) -> Motion:
        """Return the reduced motion; raises `CodecError` where no column is left, `FormatError` for too low a rate."""
        if self == Reduction():
            return motion
        kept = self.kept_columns(motion.skeleton)
        frames = slice(None, None, self.fps_divisor)
        mask = None if motion.mask is None else motion.mask[frames][:, kept]
        skeleton = motion.skeleton if kept.all() else held_skeleton(motion.skeleton, kept, motion.X[0])
        X = motion.X[frames][:, kept]
        return replace(motion, skeleton=skeleton, X=X, fps=motion.fps / self.fps_divisor, mask=mask)

    def restore(self, reduced: Motion, original: Motion) -> Motion:
        """Return what a player shows of `reduced`, decoded or not, with the frames and columns of `original`.

        Poses between are those of `motion.in_between`; after the last frame that was kept, and in the columns that were
        not, values stay. Raises `CodecError` where `reduced` is not what `reduce` makes of `original`.
        """
        kept = self.kept_columns(original.skeleton)
        wanted = (self.n_rows(original.n_frames) + 1, int(kept.sum()))
        if reduced.X.shape != wanted:
            raise CodecError("the motion is not a reduction", wanted=str(wanted), got=str(reduced.X.shape))
        X = np.tile(original.X[0], (original.n_frames, 1))
        X[:, kept] = _in_between(reduced, self.fps_divisor, original.n_frames)
        return original.with_values(X)


def held_skeleton(skeleton: Skeleton, kept: BoolArray, pose: FloatArray) -> Skeleton:
    """Return the skeleton with the columns `kept` (n_columns,), all others held at their values in `pose`.

    Held rotations turn their joint's rest orientation, held translations move its rest offset: for every value of the
    kept columns the joints are where they were. A joint's rotations are kept or held together.
    """
    new_index = np.cumsum(kept) - 1
    joints = tuple(
        replace(
            joint,
            offset=_held_offset(skeleton, number, kept, pose),
            product=tuple(int(new_index[c]) for c in joint.product if kept[c]),
            orientation=_held_orientation(skeleton, joint, kept, pose),
        )
        for number, joint in enumerate(skeleton.joints)
    )
    columns = tuple(column for column, stays in zip(skeleton.columns, kept, strict=True) if stays)
    return replace(skeleton, joints=joints, columns=columns)


def _held_orientation(skeleton: Skeleton, joint: Joint, kept: BoolArray, pose: FloatArray) -> Matrix3:
    held = [c for c in joint.product if not kept[c]]
    if not held:
        return joint.orientation
    orientation = np.array(joint.orientation)
    for c in held:
        column = skeleton.columns[c]
        orientation = orientation @ axis_rotation(column.axis, np.asarray(column.sign * pose[c]))
    return (_vector(orientation[0]), _vector(orientation[1]), _vector(orientation[2]))


def _held_offset(skeleton: Skeleton, joint: int, kept: BoolArray, pose: FloatArray) -> Vector3:
    offset = np.array(skeleton.joints[joint].offset)
    for c, column in enumerate(skeleton.columns):
        if column.joint == joint and column.kind is ColumnKind.TRANSLATION and not kept[c]:
            offset[column.axis] += column.sign * (pose[c] - column.rest)
    return _vector(offset)


def _vector(values: FloatArray) -> Vector3:
    x, y, z = values.tolist()
    return (x, y, z)


def _in_between(reduced: Motion, every: int, n_frames: int) -> FloatArray:
    """Return (n_frames, columns) the poses of `reduced` and those between them: `motion.in_between` for all at once."""
    X, skeleton = reduced.X, reduced.skeleton
    before, place = np.divmod(np.arange(n_frames), every)
    steps = np.diff(X, axis=0, append=X[-1:])
    flips = (np.abs(steps) > JUMP) & np.array([c.kind is ColumnKind.ROTATION for c in skeleton.columns])
    owners = np.array([c.joint for c in skeleton.columns])
    for joint in np.unique(owners[flips.any(axis=0)]):
        columns = np.flatnonzero(owners == joint)
        steps[np.ix_(flips[:, columns].any(axis=1), columns)] = 0.0
    between: FloatArray = X[before] + steps[before] * (place / every)[:, np.newaxis]
    return between


def _within_loa(skeleton: Skeleton, max_loa: int) -> BoolArray:
    from qmd_studio.motion.bap import bap  # its tables are read from disk: only for those who ask

    ids = [column.bap_id for column in skeleton.columns]
    if not any(ids):
        hint = "Levels of articulation are known of body animation parameters; choose a level from 1 to 6 instead"
        raise CodecError("the skeleton has no levels of articulation", got=repr(skeleton.name), hint=hint)
    least = [None if bap_id is None else bap(bap_id).loa for bap_id in ids]
    return np.array([loa is None or loa <= max_loa for loa in least], dtype=np.bool_)
