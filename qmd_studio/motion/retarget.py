"""Any motion on any body: geometry, not renaming.

A part of the source (pelvis, forearm, …) and the same part of the target have frames that mean the same (see
`part_frames`). The target's part is held parallel to the source's in every frame, so its bones point the way the
source's do; the root's path is scaled by the length of the legs and keeps its height over the ground. Then each joint
turns as near to that as its degrees of freedom let it, from the root outward: what one cannot hold is left to the next.

A `Retargeting` is made once for two skeletons and poses one frame or all of them in the same way.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.anatomical_limits import beyond_limits, limited_joints
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.fast_kinematics import world_from_joint_fast
from qmd_studio.motion.foot_pinning import pinned_legs
from qmd_studio.motion.joint_fit_kernels import follow
from qmd_studio.motion.joint_map import JointMap, match_joints
from qmd_studio.motion.kinematics import chain_of, node_positions, rest_values
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.part_frames import LocalFrames, local_frames
from qmd_studio.motion.reference_pose import REST, Reference
from qmd_studio.motion.resampling import resampled
from qmd_studio.motion.retarget_kernels import directed, fit_kernel, wanted_kernel
from qmd_studio.motion.retarget_plan import Drive, Freedom, drive_of, freedom_of, leg_length, size_of
from qmd_studio.motion.skeleton import ColumnKind, Skeleton

Limits: TypeAlias = Literal["report", "keep"]


@dataclass(frozen=True, slots=True, eq=False)
class Posed:
    """Poses of the target: `world` (n_frames, J, 4, 4), `X` (n_frames, n_columns) and the angles that are left.

    `error` (n_frames, J) radians is 0 for joints that nothing drives; `beyond` (n_columns,) counts values outside
    their anatomical limits.
    """

    world: FloatArray
    X: FloatArray
    error: FloatArray
    beyond: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RetargetResult:
    """A retargeted motion and how well it went.

    `mapped` target joints are driven, `unmapped` source joints with turns of their own drive nothing.
    `clamped_share`, 0 to 1, is the share of values with anatomical limits that lay outside them (and, with limits
    kept, were brought back). Angle errors are between where a driven joint should look and where it does, degrees:
    the mean over joints and frames, and each joint's own mean.
    """

    motion: Motion
    mapped: tuple[str, ...]
    unmapped: tuple[str, ...]
    clamped_share: float
    mean_angle_error_deg: float
    joint_angle_error_deg: Mapping[str, float]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Retargeting:
    """The way from motions of `source` to motions of `target`; make one with `retargeting`."""

    source: Skeleton
    target: Skeleton
    joint_map: JointMap
    upright: FloatArray
    drive: Drive
    freedom: Freedom
    scale: float
    lift_m: float
    limits: Limits = "report"
    notes: tuple[str, ...] = field(default=())

    def pose(self, world_from_joint_source: FloatArray) -> FloatArray:
        """Return world_from_joint of the target (n_frames, Jt, 4, 4) for that of the source (n_frames, Js, 4, 4)."""
        return self.posed(world_from_joint_source).world

    def wanted(self, world_from_joint_source: FloatArray) -> FloatArray:
        """Return the world rotations (n_frames, Jt, 3, 3) that the target's driven joints aim at."""
        parts = np.empty((len(world_from_joint_source), len(self.drive.joints), 3, 3))
        directed(world_from_joint_source, self.upright[:3, :3].copy(), self.drive.joints, self.drive.frames, parts)
        wanted = np.zeros((len(parts), len(self.target.joints), 3, 3))
        d = self.drive
        wanted_kernel(parts, d.source, d.base, d.share, d.frame_inverse, wanted)
        return wanted

    def posed(self, world_from_joint_source: FloatArray, wanted: FloatArray | None = None) -> Posed:
        """Return the poses with their columns' values; `wanted` replaces what the joints aim at."""
        world_source = np.ascontiguousarray(world_from_joint_source, dtype=np.float64)
        wanted = self.wanted(world_source) if wanted is None else wanted
        chain, f = chain_of(self.target), self.freedom
        offset = np.array([joint.offset for joint in self.target.joints], dtype=np.float64)
        n_frames, n_joints = wanted.shape[:2]
        world = np.empty((n_frames, n_joints, 4, 4))
        X = np.repeat(rest_values(self.target)[None], n_frames, axis=0)
        error, beyond = np.zeros((n_frames, n_joints)), np.zeros(self.target.n_columns)
        fit_kernel(
            *(wanted, self.drive.source, chain.parent, chain.orientation, offset),
            *(f.n_axes, f.axes, f.sign, f.column, f.lead, f.low, f.high, self.limits == "keep"),
            *(f.hinge_child, f.hinge, f.bone, f.child_bone, f.lower_bone),
            *(world, X, error, beyond),
        )
        self._move(world, X, self._place(world_source))
        return Posed(world, X, error, beyond)

    def motion(self, motion: Motion, *, fps: float | None = None, pin_feet: bool = False) -> RetargetResult:
        """Return `motion` on the target, at `fps` frames a second where that is given.

        With `pin_feet` feet that stand in the source stand still. Angles go on from frame to frame without jumps.
        Raises `FormatError` where `motion` is not one of the source's.
        """
        if motion.skeleton != self.source:
            wanted, got = f"joints of {self.source.name!r}", f"{motion.skeleton.name!r}"
            raise FormatError("the motion is not on the skeleton that is retargeted", wanted=wanted, got=got)
        if fps is not None and fps != motion.fps:
            motion = resampled(motion, fps)
        world = world_from_joint_fast(self.source, motion.X)
        aims = self.wanted(world)
        posed = self.posed(world, aims)
        notes = self.notes
        if pin_feet:
            aims, note = pinned_legs(self.target, aims, posed.world, (self._placed(world), motion.fps, self.source))
            posed, notes = self.posed(world, aims), (*notes, note)
        X = self._followed(posed.X)
        X, posed, share = self._anatomical(X, posed)
        return self._result(Motion(self.target, X, motion.fps, name=motion.name), posed, share, notes)

    def _anatomical(self, X: FloatArray, posed: Posed) -> tuple[FloatArray, Posed, float]:
        """Hold a body of H-Anim's free joints against the limits of the parameters; return what share lay outside."""
        driven = self._driven()
        joints = [joint for joint in limited_joints(self.target) if driven[joint.joint]]
        if not joints:
            return X, posed, self._share(posed, len(X))
        X, count = X.copy(), 0
        for joint in joints:
            outside, values = beyond_limits(joint, X)
            count += int(outside.sum())
            if self.limits == "keep":
                X[:, list(joint.product)] = values
        if count and self.limits == "keep":
            held = world_from_joint_fast(self.target, X)
            away = np.einsum("fjki,fjki->fj", posed.world[..., :3, :3], held[..., :3, :3])  # the trace of one turn
            error = posed.error + np.where(driven, np.arccos(np.clip((away - 1) / 2, -1.0, 1.0)), 0.0)
            posed = replace(posed, world=held, error=error)
        return X, posed, count / (sum(joint.n_limited for joint in joints) * len(X))

    def _share(self, posed: Posed, n_frames: int) -> float:
        """The share of values outside the limits that the target's own columns have."""
        limited = [
            f for j in np.flatnonzero(self._driven()) for a in range(self.freedom.n_axes[j])
            if self.freedom.low[j, a] > -1e9 and (f := int(self.freedom.column[j, a])) >= 0
        ]  # fmt: skip
        return float(posed.beyond[limited].sum() / (len(limited) * n_frames)) if limited else 0.0

    def _placed(self, world_source: FloatArray) -> FloatArray:
        """The positions (n_frames, Js, 3) of the source's joints, upright."""
        return np.asarray(world_source[:, :, :3, 3] @ self.upright[:3, :3].T)

    def _place(self, world_source: FloatArray) -> FloatArray:
        """Where the middle of the target's hips goes, (n_frames, 3) metres."""
        joints = _hips(self.source)
        middle = world_source[..., :3, 3][:, joints].mean(axis=1) @ self.upright[:3, :3].T
        return np.asarray(self.scale * middle + [0.0, self.lift_m, 0.0])

    def _move(self, world: FloatArray, X: FloatArray, place: FloatArray) -> None:
        """Move the target, in `world` and `X`, so that the middle of its hips is at `place`, as far as it can move."""
        chain, joint = chain_of(self.target), _mover(self.target)
        if joint is None:
            return
        shift = place - world[..., :3, 3][:, _hips(self.target)].mean(axis=1)
        parent = int(chain.parent[joint])
        turn = world[:, parent, :3, :3] if parent >= 0 else np.broadcast_to(np.eye(3), (len(world), 3, 3))
        local = np.einsum("fij,fi->fj", turn, shift)
        free = np.zeros_like(local)
        for k in range(chain.move_start[joint], chain.move_start[joint + 1]):
            axis, column = chain.move_axis[k], chain.move_column[k]
            X[:, column] += chain.move_sign[k] * local[:, axis]
            free[:, axis] = local[:, axis]
        moved = np.einsum("fij,fj->fi", turn, free)
        world[..., :3, 3][:, _below(self.target, joint)] += moved[:, None]

    def _followed(self, X: FloatArray) -> FloatArray:
        X, f = X.copy(), self.freedom
        for j in np.flatnonzero((self.drive.source >= 0) & (f.n_axes > 0)):
            n = int(f.n_axes[j])
            if n == 3:
                follow(X, f.column[j], f.sign[j], f.axes[j], f.low[j], f.high[j], self.limits == "keep")
            elif self.limits == "report":
                X[:, f.column[j, :n]] = np.unwrap(X[:, f.column[j, :n]], axis=0)
        return X

    def _result(self, motion: Motion, posed: Posed, share: float, notes: tuple[str, ...]) -> RetargetResult:
        driven = self._driven()
        names = [joint.name for joint in self.target.joints]
        means = np.degrees(posed.error.mean(axis=0))
        mapped_sources = {source for source, targets in self.joint_map.pairs if targets}
        turning = {c.joint for c in self.source.columns if c.kind is ColumnKind.ROTATION}
        return RetargetResult(
            motion=motion,
            mapped=tuple(names[j] for j in np.flatnonzero(driven)),
            unmapped=tuple(
                joint.name for k, joint in enumerate(self.source.joints)
                if k in turning and joint.name not in mapped_sources
            ),
            clamped_share=share,
            mean_angle_error_deg=float(means[driven].mean()) if driven.any() else 0.0,
            joint_angle_error_deg={names[j]: float(means[j]) for j in np.flatnonzero(driven)},
            notes=notes,
        )  # fmt: skip

    def _driven(self) -> BoolArray:
        return np.asarray((self.drive.source >= 0) & (self.freedom.n_axes > 0))


def retargeting(
    source: Skeleton,
    target: Skeleton,
    *,
    joint_map: JointMap | None = None,
    reference: Reference = REST,
    upright: FloatArray | None = None,
    limits: Limits = "report",
) -> Retargeting:
    """Return the way from `source` to `target`, all geometry computed.

    `joint_map` is matched by the parts of both where none is given. `reference` is the pose of the source that counts
    as the target's rest. `upright` (4, 4) stands the source up where its file has another axis up. Raises
    `FormatError` for a map with joints that the skeletons lack or with no pair.
    """
    joint_map = match_joints(source, target) if joint_map is None else joint_map.checked(source, target)
    if not any(targets for _, targets in joint_map.pairs):
        raise FormatError("the joint map pairs no joint with another", wanted="at least one pair")
    upright = np.eye(4) if upright is None else np.asarray(upright, dtype=np.float64)
    row = rest_values(source) if reference.row is None else np.asarray(reference.row, dtype=np.float64)
    aligned = reference.kind != "zero"
    nodes = [node_positions(s, rest_values(s)[None])[0] for s in (source, target)]
    ours, theirs = (local_frames(s, x, aligned=aligned) for s, x in ((source, row), (target, rest_values(target))))
    if reference.trunk_row is not None:
        ours = _with_trunk_of(source, ours, local_frames(source, reference.trunk_row), reference.trunk_parts)
    drive = drive_of(joint_map, (source, target), (ours, theirs))
    legs = [leg_length(parts_of(s), n) for s, n in zip((source, target), nodes, strict=True)]
    sizes = legs if min(legs) > 0 else [size_of(source), size_of(target)]
    scale = sizes[1] / sizes[0] if min(sizes) > 0 else 1.0
    soles = (ours.sole_m, theirs.sole_m)
    lift = soles[1] - scale * soles[0] if soles[0] is not None and soles[1] is not None else 0.0
    freedom = freedom_of(target, drive.source, joint_map.columns)
    return Retargeting(
        source, target, joint_map, upright, drive, freedom, scale, lift, limits, _notes(source, target, reference)
    )


def _with_trunk_of(skeleton: Skeleton, frames: LocalFrames, trunk: LocalFrames, which: tuple[str, ...]) -> LocalFrames:
    parts = {joint: re.sub("^[lr]_", "", part) for joint, part in parts_of(skeleton).part_of().items()}
    of_trunk = {joint: frame for joint, frame in trunk.frame_in.items() if parts.get(joint) in which}
    return replace(frames, frame_in=frames.frame_in | of_trunk)


def _notes(source: Skeleton, target: Skeleton, reference: Reference) -> tuple[str, ...]:
    notes = [f"joints were recognised as named by {parts_of(source).naming}"]
    if parts_of(source).naming == "shape":
        notes = ["joints were recognised by the shape of the skeleton: check the map"]
    if _mover(target) is None:
        notes.append("the body cannot move from its place: its root has no translations")
    return (*notes, reference.note) if reference.note else tuple(notes)


def _hips(skeleton: Skeleton) -> list[int]:
    """The joints whose middle is the place of the figure: both hips, or the root."""
    parts = parts_of(skeleton)
    hips = [parts.named[key] for key in ("l_hip", "r_hip") if key in parts.named]
    return hips if len(hips) == 2 else [parts.root]


def _mover(skeleton: Skeleton) -> int | None:
    """The joint that carries the figure about: the root or the nearest joint above it with translations."""
    chain, joint = chain_of(skeleton), parts_of(skeleton).root
    while joint >= 0:
        if chain.move_start[joint + 1] > chain.move_start[joint]:
            return joint
        joint = int(chain.parent[joint])
    return None


def _below(skeleton: Skeleton, top: int) -> list[int]:
    found = {top}
    for joint, above in enumerate(j.parent for j in skeleton.joints):
        if above in found:
            found.add(joint)
    return sorted(found)
