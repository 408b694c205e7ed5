"""VRML97 (.wrl, packed .wrz): H-Anim figures made of PROTOs, read and written."""

from __future__ import annotations

from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.loaded import Format
from qmd_studio.formats.scene_graph import Encoding
from qmd_studio.formats.vrml_parse import is_vrml
from qmd_studio.motion.motion import Motion


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is VRML97."""
    return is_vrml(head) is Encoding.VRML97


def write_figure(body: Body, motion: Motion | None) -> bytes:
    """Return the file of a body and a motion, that as interpolators; see `hanim_write`."""
    return figure_bytes(body, motion, Encoding.VRML97)


FORMAT = Format(
    name="wrl",
    title="VRML97 figure",
    suffixes=(".wrl", ".wrz"),
    sniff=sniff,
    read=read_figure,
    write_figure=write_figure,
    packed=(".wrz",),
)
