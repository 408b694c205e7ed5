"""glTF 2.0 as JSON: the same bodies and motions as in `formats/glb.py`, their numbers within the file or beside it."""

from __future__ import annotations

import re

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.formats.gltf_read import read
from qmd_studio.formats.gltf_write import gltf_bytes
from qmd_studio.formats.loaded import Format
from qmd_studio.motion.motion import Motion

_SNIFF = re.compile(rb'"(?:asset|accessors|bufferViews)"\s*:')


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is glTF in JSON."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") and _SNIFF.search(head) is not None


def write(motion: Motion) -> bytes:
    """Return a .gltf file with `motion` on the body that is made from its own bones."""
    return gltf_bytes(bone_body(motion.skeleton), motion)


FORMAT = Format(
    name="gltf", title="glTF", suffixes=(".gltf",), sniff=sniff, read=read, write=write, write_figure=gltf_bytes
)
