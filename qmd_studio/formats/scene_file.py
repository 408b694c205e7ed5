"""A scene's file, whichever of the three encodings it is in, packed by gzip or not."""

from __future__ import annotations

from qmd_studio.formats.gzip_bytes import unpacked
from qmd_studio.formats.scene_graph import Encoding, Scene
from qmd_studio.formats.vrml_parse import is_vrml, parse_vrml
from qmd_studio.formats.vrml_write import write_vrml
from qmd_studio.formats.x3d_xml import parse_xml
from qmd_studio.formats.x3d_xml_write import write_xml


def parse_scene(data: bytes) -> Scene:
    """Parse an X3D or VRML97 file; raises `FormatError` with the place where it is broken."""
    data = unpacked(data)
    return parse_vrml(data) if is_vrml(data[:64]) else parse_xml(data)


def write_scene(scene: Scene, encoding: Encoding) -> bytes:
    """Return `scene` in `encoding`. VRML97 has no H-Anim nodes: those must have become PROTOs before."""
    return write_xml(scene) if encoding is Encoding.XML else write_vrml(scene, encoding)
