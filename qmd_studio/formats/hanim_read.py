"""An H-Anim figure from a file in any of the scene encodings: skeleton, body, and the motion or pose in the file."""

from __future__ import annotations

from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.hanim_animation import motion_of
from qmd_studio.formats.hanim_displacers import displacers_of, find_displacers
from qmd_studio.formats.hanim_figure import Figure, find_figure
from qmd_studio.formats.hanim_inline import open_inlines
from qmd_studio.formats.hanim_skeleton import bind_of
from qmd_studio.formats.hanim_surface import gather, surface_of
from qmd_studio.formats.hanim_view import View, label
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.formats.scene_file import parse_scene
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion

_SAMPLES = 24
_FLOATS_FROM_M = 0.5
MOST_WARNINGS = 100
"""So many warnings are listed one by one; of more, the number."""


def read_figure(data: bytes, options: ReadOptions) -> Loaded:
    """Read the humanoid of a scene with its body, where it has meshes, and its motion, one frame where it stands still.

    Every rule that the file breaks is a warning where something sensible remains. Raises `FormatError` naming node and
    field where nothing does.
    """
    scene = parse_scene(data)
    view = View(scene, warnings=list(scene.warnings))
    open_inlines(view, options.path)
    figure = find_figure(view, options.metres_per_unit)
    gathered = gather(view, figure)
    found = find_displacers(gathered)
    motion = motion_of(view, figure, found, options.fps)
    if options.path:
        motion = Motion(motion.skeleton, motion.X, motion.fps, name=options.path.name.split(".")[0])
    surface = surface_of(gathered)
    body = None
    if surface is not None:
        skeleton = motion.skeleton
        displacers = displacers_of(gathered, found)
        body = Body(skeleton.name, skeleton, surface, bind_of(figure), _segments(figure), displacers)
    return Loaded(
        motion.skeleton, motion, body, warnings=_listed(view.warnings), notes=(*view.notes, *_height_note(motion))
    )


def _height_note(motion: Motion) -> tuple[str, ...]:
    """Say it where a motion never comes down to the ground: its heights were then meant for another figure."""
    if motion.n_frames == 1:
        return ()
    stride = -(-motion.n_frames // _SAMPLES)
    lowest = float(world_from_joint(motion.skeleton, motion.X[::stride])[..., 1, 3].min())
    if lowest < _FLOATS_FROM_M:
        return ()
    return (f"the motion carries the figure {lowest:.1f} m above the ground all the time, as the file says",)


def _segments(figure: Figure) -> tuple[str, ...]:
    names = [""] * len(figure.joints)
    for joint, segment in figure.segments:
        names[joint] = names[joint] or label(segment)
    return tuple(names) if any(names) else ()


def _listed(warnings: list[str]) -> tuple[str, ...]:
    unique = list(dict.fromkeys(warnings))
    if len(unique) > MOST_WARNINGS:
        unique[MOST_WARNINGS:] = [f"and {len(unique) - MOST_WARNINGS} more warnings"]
    return tuple(unique)
