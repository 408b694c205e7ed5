"""glTF 2.0 in its binary container: bodies with skin, morph targets and motion (Khronos; ISO/IEC 12113)."""

from __future__ import annotations

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.formats.gltf_read import read
from qmd_studio.formats.gltf_write import glb_bytes
from qmd_studio.formats.loaded import Format
from qmd_studio.motion.motion import Motion


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is a binary glTF."""
    return head.startswith(b"glTF")


def write(motion: Motion) -> bytes:
    """Return a .glb file with `motion` on the body that is made from its own bones."""
    return glb_bytes(bone_body(motion.skeleton), motion)


FORMAT = Format(
    name="glb", title="Binary glTF", suffixes=(".glb",), sniff=sniff, read=read, write=write, write_figure=glb_bytes
)
