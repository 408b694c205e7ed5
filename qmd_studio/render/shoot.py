"""Pictures of a motion on a body, frame by frame, the camera going along with the figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.dressed import Dressed
from qmd_studio.render.camera import Camera
from qmd_studio.render.ground import ground_height
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.quality import FINE, LADDER
from qmd_studio.render.scene import Actor, Look, Scene, posed_extremes

_FRAMED_BY = 24
"""So many of the frames decide how near the camera comes."""


@dataclass(frozen=True, slots=True)
class Shot:
    """How it is to look: `size` in pixels, a view preset, and the choices of a scene."""

    size: tuple[int, int]
    view: str = "three-quarter"
    dark: bool = False
    look: Look = Look.SOLID
    transparent: bool = False


def shoot(dressed: Dressed, frames: Sequence[int], shot: Shot) -> Iterator[NDArray[np.uint8]]:
    """Yield a picture (height, width, 3 or 4) of each of the `frames`, all at one scale.

    Raises `GraphicsError` where the machine has nothing to draw with.
    """
    ground = ground_height(dressed.motion, dressed.fit)
    camera, start = _framed(dressed, frames, shot)
    quality = FINE if len(frames) == 1 else LADDER[1]
    with OffscreenRenderer() as renderer:
        for frame in frames:
            actor = _actor(dressed, frame, shot.look)
            moved = _root(actor) - start
            scene = Scene(
                (actor,),
                dark=shot.dark,
                show_axes=False,
                show_ground=not shot.transparent,
                ground_y=ground,
                backdrop=not shot.transparent,
            )
            ratio = max(1.0, shot.size[1] / 900.0)
            yield renderer.picture(scene, camera.carried(moved), shot.size, quality=quality, pixel_ratio=ratio)


def _framed(dressed: Dressed, frames: Sequence[int], shot: Shot) -> tuple[Camera, FloatArray]:
    """Return the camera that holds every frame when it goes along, and where the figure stands in its picture."""
    some = [frames[k] for k in np.linspace(0, len(frames) - 1, min(len(frames), _FRAMED_BY)).astype(int)]
    actors = [_actor(dressed, frame, shot.look) for frame in some]
    start = _root(actors[0])
    points = np.concatenate([posed_extremes(actor) - (_root(actor) - start) for actor in actors])
    return Camera().preset(shot.view).frame(points, shot.size[0] / shot.size[1]), start


def _actor(dressed: Dressed, frame: int, look: Look) -> Actor:
    world, figure = dressed.poses([frame])[0], dressed.fit.world_from_figure
    return Actor(dressed.body, world, look=look, morphs=dressed.morphs(frame), world_from_figure=figure)


def _root(actor: Actor) -> FloatArray:
    """Where the figure stands on the ground, (3,) with a height of 0."""
    return np.asarray(actor.joint_positions()[0] * (1.0, 0.0, 1.0))
