"""A body and its motion to the bytes of an H-Anim file, in any of the three encodings."""

from __future__ import annotations

from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_build import build_figure
from qmd_studio.formats.hanim_build_motion import add_hanim_motion, add_interpolators
from qmd_studio.formats.hanim_protos import as_vrml97
from qmd_studio.formats.scene_file import write_scene
from qmd_studio.formats.scene_graph import Encoding
from qmd_studio.motion.motion import Motion

MAX_VALUES = 20_000_000
"""Motions of more numbers are not written as text."""


def figure_bytes(body: Body, motion: Motion | None, encoding: Encoding, *, interpolators: bool = False) -> bytes:
    """Return the file of `body` with `motion` as an HAnimMotion, or as interpolators if wished.

    VRML97 has no HAnimMotion and takes interpolators. Raises `FormatError` for a body that cannot be written, such as
    one of joints nested more deeply than any reader takes.
    """
    built = build_figure(body)
    if motion is not None:
        if motion.X.size > MAX_VALUES:
            got = f"{motion.X.size} numbers"
            raise FormatError("the motion is too long for a file of text", wanted=f"at most {MAX_VALUES}", got=got)
        if interpolators or encoding is Encoding.VRML97 or motion.n_frames == 1:
            add_interpolators(built, body, motion)
        else:
            add_hanim_motion(built, body, motion)
    scene = as_vrml97(built.scene) if encoding is Encoding.VRML97 else built.scene
    return write_scene(scene, encoding)
