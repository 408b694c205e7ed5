"""How far two motions on one skeleton are apart: the paper's DEF, millimetres, and the error of speed and acceleration.

DEF is the mean over frames of the Euclidean norm of all points' position errors stacked into one vector, in ASF length
units whatever the source. It is blind to jitter, which the eye is not: hence the errors of velocity and acceleration,
the mean magnitude of the first and second differences of the position error, times the frame rate and its square.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.kinematics import node_positions, point_positions
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import Skeleton

Align = Literal["none", "first"]
_SAME_LENGTH_M = 1e-3  # skeletons whose bones differ by less are the same one, rounded by some file
_COPY_HINT = "Only a motion and a copy of it on the same skeleton can be compared"
_FRAMES_AT_ONCE = 2048


@dataclass(frozen=True, slots=True, eq=False)
class MotionError:
    """The position error of a decoded motion: `distance_mm` (n_frames, n_points) and what sums it up.

    `p99_mm` is the smallest distance that 99 % of all distances do not exceed. `worst_joint` is the name of the point
    where, and `worst_frame` the frame when, the largest distance occurs.
    """

    def_: float
    mean_mm: float
    p99_mm: float
    max_mm: float
    worst_joint: str
    worst_frame: int
    velocity_mm_s: float
    acceleration_mm_s2: float
    distance_mm: Float32Array

    def as_json(self) -> dict[str, float | int | str]:
        """Return the figures under the names that the command line prints."""
        return {
            "def": self.def_,
            "mean_mm": self.mean_mm,
            "p99_mm": self.p99_mm,
            "max_mm": self.max_mm,
            "worst_joint": self.worst_joint,
            "worst_frame": self.worst_frame,
            "velocity_mm_s": self.velocity_mm_s,
            "acceleration_mm_s2": self.acceleration_mm_s2,
        }


def measure(original: Motion, decoded: Motion, *, align: Align = "none") -> MotionError:
    """Measure `decoded` against `original` at the original's points.

    The decoded motion may have been through a file of another kind, as from AMC to BVH: what counts is that its
    skeleton has a node of each point's name, on bones of the same lengths. `align="first"` first moves the decoded
    motion so that both roots stand at one place in frame 0. Velocities take the original's frame rate. Raises
    `FormatError` where the two differ in skeleton or in their number of frames.
    """
    nodes = _nodes_to_compare(original, decoded)
    error = np.concatenate(
        [
            node_positions(decoded.skeleton, decoded.X[start : start + _FRAMES_AT_ONCE])[:, nodes]
            - point_positions(original.skeleton, original.X[start : start + _FRAMES_AT_ONCE])
            for start in range(0, original.n_frames, _FRAMES_AT_ONCE)
        ]
    )
    if align == "first":
        error -= _root_at_first(decoded) - _root_at_first(original)
    distance = np.linalg.norm(error, axis=2)
    return summed_up(
        (1000 * distance).astype(np.float32),
        original.skeleton,
        def_=float(np.sqrt((distance**2).sum(axis=1)).mean()) / ASF_UNIT_M,
        velocity_mm_s=_mean_change(error, 1) * 1000 * original.fps,
        acceleration_mm_s2=_mean_change(error, 2) * 1000 * original.fps**2,
    )


def summed_up(
    distance_mm: Float32Array,
    skeleton: Skeleton,
    *,
    def_: float,
    velocity_mm_s: float,
    acceleration_mm_s2: float,
) -> MotionError:
    """Return the `MotionError` of distances (n_frames, n_points) in mm; the sums over frames are already made."""
    # the order in memory is free: kernels keep the frames of a point together
    flat = distance_mm.ravel(order="K")
    rank = math.ceil(0.99 * flat.size) - 1
    frame, point = np.unravel_index(int(distance_mm.argmax()), distance_mm.shape)
    return MotionError(
        def_=def_,
        mean_mm=float(flat.mean(dtype=np.float64)),
        p99_mm=float(np.partition(flat, rank)[rank]),
        max_mm=float(distance_mm[frame, point]),
        worst_joint=skeleton.point_names[point],
        worst_frame=int(frame),
        velocity_mm_s=velocity_mm_s,
        acceleration_mm_s2=acceleration_mm_s2,
        distance_mm=distance_mm,
    )


def _mean_change(error: FloatArray, order: int) -> float:
    """Return the mean size of the `order`-th differences of errors (n_frames, n_points, 3); 0 where there are none."""
    changes = np.linalg.norm(np.diff(error, n=order, axis=0), axis=2)
    return float(changes.mean()) if changes.size else 0.0


def _root_at_first(motion: Motion) -> FloatArray:
    root: FloatArray = node_positions(motion.skeleton, motion.X[:1])[0, 0]
    return root


def _nodes_to_compare(original: Motion, decoded: Motion) -> list[int]:
    """Return the decoded motion's node for each point of the original."""
    if original.n_frames != decoded.n_frames:
        wanted, got = f"{original.n_frames} frames", f"{decoded.n_frames} frames"
        raise FormatError("the motions differ in length", wanted=wanted, got=got, hint="Compare a motion with its copy")
    first, second = original.skeleton, decoded.skeleton
    if not first.points:
        raise FormatError("the skeleton has no points to measure at")
    if first.node_names == second.node_names:
        _check_bones(first, second, range(second.n_nodes))
        return list(first.points)
    number = {name: node for node, name in enumerate(second.node_names)}
    if set(first.node_names) != number.keys() or len(number) != first.n_nodes:
        wanted, got = _unlike(first, second)
        raise FormatError("the motions have different skeletons", wanted=wanted, got=got, hint=_COPY_HINT)
    nodes = [number[name] for name in first.node_names]
    _check_bones(first, second, nodes)
    return [nodes[point] for point in first.points]


def _check_bones(first: Skeleton, second: Skeleton, nodes: Sequence[int]) -> None:
    """Compare the lengths of bones; their directions at rest depend on the axes that a file gives its joints."""
    apart = np.abs(_bone_lengths(first) - _bone_lengths(second)[list(nodes)])
    if apart.max() > _SAME_LENGTH_M:
        raise FormatError(
            "the motions have skeletons of different measures",
            at=f"joint {first.node_names[int(apart.argmax())]}",
            wanted="the same bones",
            got=f"a bone that is {1000 * apart.max():.3g} mm longer or shorter",
            hint=_COPY_HINT,
        )


def _unlike(first: Skeleton, second: Skeleton) -> tuple[str, str]:
    """Return what is wanted and what is there instead, for two skeletons whose names differ."""
    mine = [name for name in first.node_names if name not in second.node_names]
    other = [name for name in second.node_names if name not in first.node_names]
    wanted = f"{first.n_nodes} joints and ends" + (f", {mine[0]!r} among them" if mine else "")
    return wanted, f"{second.n_nodes}" + (f", {other[0]!r} among them" if other else "")


def _bone_lengths(skeleton: Skeleton) -> FloatArray:
    """Return how far each node (n_nodes,) is from the joint before it, in metres; 0 for roots, which stand anywhere."""
    offsets = [joint.offset if joint.parent >= 0 else (0.0, 0.0, 0.0) for joint in skeleton.joints]
    lengths: FloatArray = np.linalg.norm(np.array(offsets + [site.offset for site in skeleton.end_sites]), axis=1)
    return lengths
