"""A body: the joints it has and the surfaces that they carry."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.motion.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A triangle mesh bound to a skeleton's joints at rest.

    `vertices` (V, 3) metres and `normals` (V, 3) in the rest pose of the body's own space, `faces` (F, 3) vertex
    numbers, `colours` (V, 3) linear 0 to 1. Each vertex follows K joints, one or more: `joints` (V, K) joint numbers
    with `weights` (V, K) that sum to 1. The number after the last joint's stands for the figure itself, which never
    moves in its own space: H-Anim leaves there what weight a skin does not give away.
    """

    vertices: Float32Array
    normals: Float32Array
    faces: IntArray
    colours: Float32Array
    joints: IntArray
    weights: Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class Displacer:
    """A named change of shape: `vertices` (n,) move by weight times `displacements` (n, 3) metres before skinning.

    `joint` is the joint or the joint of the segment that it belongs to. `weight` is what the file stands at. The weight
    of frame i is the value of the motion's opaque column called `name`, where it has one.
    """

    name: str
    joint: int
    vertices: IntArray
    displacements: Float32Array
    weight: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A named body: a skeleton, the pose its surface is bound at, and the surface.

    `bind` (n_joints, 4, 4) holds world_from_joint of the binding pose: a vertex is shown at
    sum(weight * world_from_joint[j] @ inverse(bind[j]) @ vertex). `segments` names what each joint carries, "" where
    it carries nothing; it is empty where nothing has a name.
    """

    name: str
    skeleton: Skeleton
    surface: Surface
    bind: FloatArray
    segments: tuple[str, ...] = ()
    displacers: tuple[Displacer, ...] = ()
