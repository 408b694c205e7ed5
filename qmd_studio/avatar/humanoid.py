"""A body: the joints it has and the surfaces that they carry."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.motion.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A triangle mesh bound to a skeleton's joints at rest.

    `vertices` (V, 3) metres and `normals` (V, 3) in the rest pose of the body's own space, `faces` (F, 3) vertex
    numbers, `colours` (V, 3) linear 0 to 1. Each vertex follows up to four joints: `joints` (V, 4) joint numbers with
    `weights` (V, 4) that sum to 1.
    """

    vertices: Float32Array
    normals: Float32Array
    faces: IntArray
    colours: Float32Array
    joints: IntArray
    weights: Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A named body: a skeleton, the pose its surface is bound at, and the surface.

    `bind` (n_joints, 4, 4) holds world_from_joint of the binding pose: a vertex is shown at
    sum(weight * world_from_joint[j] @ inverse(bind[j]) @ vertex).
    """

    name: str
    skeleton: Skeleton
    surface: Surface
    bind: FloatArray
