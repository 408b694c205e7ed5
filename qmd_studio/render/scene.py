"""What the renderer is asked to draw: bodies in their poses, and how the stage around them looks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar import skinning
from qmd_studio.avatar.humanoid import Body

Colour = tuple[float, float, float]

GHOST_TINT: Colour = (0.015, 0.26, 0.85)
"""The blue of a decoded motion's ghost, linear."""
GHOST_ALPHA = 0.75
GHOST_GAP_M = 0.004
"""A ghost nearer than this to a solid body's skin is taken to agree with it, and hidden by it."""


class Look(StrEnum):
    """How a body's surface is shown."""

    SOLID = "solid"
    """In its own colours."""
    SEGMENTS = "segments"
    """Each joint's skin in a colour of its own."""
    XRAY = "xray"
    """The skin lets its joints and bones be seen."""
    WIRE = "wire"
    """With the edges of its triangles."""


@dataclass(frozen=True, slots=True, eq=False)
class Actor:
    """A body in one pose: `world_from_joint` (n_joints, 4, 4) metres.

    `tint` (linear 0 to 1) colours the body, `alpha` below 1 lets the scene show through; a ghost is translucent with a
    brighter rim, casts no shadow, and shows only where it leaves the solid bodies by more than `GHOST_GAP_M`. `heat`
    (n_joints,) from 0 to 1 paints each joint's skin by the colour map; NaN leaves a joint as it is. Where `only_hot`,
    skin without heat is not seen at all. `morphs` (n_displacers,) are the weights of the body's displacers, those of
    its file if None. `world_from_figure` (4, 4) is where the figure's own space stands, for skin that follows no joint;
    the identity if None.
    """

    body: Body
    world_from_joint: FloatArray
    tint: Colour | None = None
    alpha: float = 1.0
    ghost: bool = False
    heat: FloatArray | None = None
    only_hot: bool = False
    look: Look = Look.SOLID
    morphs: FloatArray | None = None
    world_from_figure: FloatArray | None = None

    def joint_positions(self) -> FloatArray:
        """Return the joints' positions (n_joints, 3), metres."""
        return np.asarray(self.world_from_joint, dtype=np.float64)[:, :3, 3]

    def skin_matrices(self) -> FloatArray:
        """Return what moves the surface from the binding pose to this one, (n_joints + 1, 4, 4)."""
        return skinning.skin_matrices(self.body, self.world_from_joint, self.world_from_figure)

    def displacer_weights(self) -> FloatArray:
        """Return the weights of the body's displacers, (n_displacers,)."""
        if self.morphs is None:
            return skinning.rest_weights(self.body)
        return np.asarray(self.morphs, dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The actors and the stage. `selected` and `hovered` are (actor, joint) numbers; `ground_y` is in metres.

    Without `backdrop` the picture is transparent where nothing stands, its colours multiplied by their alpha.
    """

    actors: tuple[Actor, ...] = ()
    dark: bool = False
    selected: tuple[int, int] | None = None
    hovered: tuple[int, int] | None = None
    show_ground: bool = True
    show_axes: bool = True
    ground_y: float = 0.0
    backdrop: bool = True

    def with_actors(self, actors: tuple[Actor, ...]) -> Scene:
        """Return the stage with other actors, the selected joint still selected if there is one of its number."""
        selected = self.selected
        if selected is not None:
            number, joint = selected
            if number >= len(actors) or joint >= len(actors[number].body.skeleton.joints):
                selected = None
        return replace(self, actors=actors, selected=selected, hovered=None)

    def points(self) -> FloatArray:
        """Return points (n, 3) that bound every actor, for framing: the joints and the tips of their surfaces."""
        clouds = [posed_extremes(actor) for actor in self.actors]
        return np.concatenate(clouds) if clouds else np.zeros((0, 3))

    def radius(self) -> float:
        """Return the radius in metres of a sphere about the actors' centre that holds their joints."""
        points = np.concatenate([a.joint_positions() for a in self.actors]) if self.actors else np.zeros((1, 3))
        return float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()) + 0.5


def posed_vertices(actor: Actor, stride: int = 1) -> FloatArray:
    """Return every `stride`-th vertex of the actor's surface in its pose, (n, 3) metres."""
    surface = actor.body.surface
    vertices, _ = skinning.displaced(surface, actor.body.displacers, actor.displacer_weights())
    joints, weights = surface.joints[::stride], surface.weights[::stride]
    blended = skinning.blended_matrices(joints, weights, actor.skin_matrices())
    return np.asarray(np.einsum("vij,vj->vi", blended[:, :, :3], vertices[::stride]) + blended[:, :, 3])


def posed_extremes(actor: Actor) -> FloatArray:
    """Return the joints and a thinned cloud of the posed surface, (n, 3) metres."""
    stride = max(1, len(actor.body.surface.vertices) // 600)
    return np.concatenate([actor.joint_positions(), posed_vertices(actor, stride)])


def limb_points(actor: Actor, joint: int) -> FloatArray:
    """Return points (n, 3) about a joint and all that hangs from it, metres, with some room around them."""
    inside = {joint}
    for index, other in enumerate(actor.body.skeleton.joints):
        if other.parent in inside:
            inside.add(index)
    positions = actor.joint_positions()
    reach = 0.06 * float(np.ptp(positions, axis=0).max())
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * reach
    return np.asarray((positions[sorted(inside)][:, None] + corners).reshape(-1, 3))
