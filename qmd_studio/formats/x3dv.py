"""X3D in ClassicVRML (.x3dv, packed .x3dvz): H-Anim figures, read and written."""

from __future__ import annotations

from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.loaded import Format
from qmd_studio.formats.scene_graph import Encoding
from qmd_studio.formats.vrml_parse import is_vrml
from qmd_studio.motion.motion import Motion


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is X3D in ClassicVRML."""
    return is_vrml(head) is Encoding.CLASSIC


def write_figure(body: Body, motion: Motion | None) -> bytes:
    """Return the file of a body and a motion, that as HAnimMotion; see `hanim_write`."""
    return figure_bytes(body, motion, Encoding.CLASSIC)


FORMAT = Format(
    name="x3dv",
    title="X3D figure, ClassicVRML",
    suffixes=(".x3dv", ".x3dvz"),
    sniff=sniff,
    read=read_figure,
    write_figure=write_figure,
    packed=(".x3dvz",),
)
