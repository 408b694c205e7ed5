"""X3D in XML (.x3d, packed .x3dz): H-Anim figures, read and written."""

from __future__ import annotations

import re

from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.loaded import Format
from qmd_studio.formats.scene_graph import Encoding
from qmd_studio.motion.motion import Motion

_SNIFF = re.compile(rb"<(?:!DOCTYPE\s+)?X3D\b")


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is X3D in XML."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<") and _SNIFF.search(head) is not None


def write_figure(body: Body, motion: Motion | None) -> bytes:
    """Return the file of a body and a motion, that as HAnimMotion; see `hanim_write`."""
    return figure_bytes(body, motion, Encoding.XML)


FORMAT = Format(
    name="x3d",
    title="X3D figure",
    suffixes=(".x3d", ".x3dz"),
    sniff=sniff,
    read=read_figure,
    write_figure=write_figure,
    packed=(".x3dz",),
)
