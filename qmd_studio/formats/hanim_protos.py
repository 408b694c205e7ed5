"""H-Anim in VRML97, which has no nodes for it: the scene with PROTOs Humanoid, Joint, Segment, Site and Displacer.

The PROTOs are those of H-Anim 1.1 and 2001 by name and fields; a browser without H-Anim shows the skin at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from qmd_studio.formats.scene_fields import HANIM_PROTOS
from qmd_studio.formats.scene_graph import Declared, Encoding, Is, Node, Proto, Scene

_OLD_NAMES = {new: old for old, new in HANIM_PROTOS.items()}
_FIELDS = {"skeleton": "humanoidBody"}
_NOT_OLD = frozenset({"motions", "loa"})
_TRANSFORM = "SFVec3f center 0 0 0|SFRotation rotation 0 0 1 0|SFVec3f scale 1 1 1|" + (
    "SFRotation scaleOrientation 0 0 1 0|SFVec3f translation 0 0 0|SFString name"
)
_INTERFACES = {
    "Humanoid": f"{_TRANSFORM}|SFString version|MFString info|MFNode humanoidBody|MFNode joints|MFNode segments|"
    "MFNode sites|MFNode viewpoints|MFNode skin|SFNode skinCoord|SFNode skinNormal",
    "Joint": f"{_TRANSFORM}|SFRotation limitOrientation 0 0 1 0|MFFloat llimit|MFFloat ulimit|MFFloat stiffness|"
    "MFInt32 skinCoordIndex|MFFloat skinCoordWeight|MFNode displacers|MFNode children",
    "Segment": "SFString name|SFFloat mass 0|SFVec3f centerOfMass 0 0 0|MFFloat momentsOfInertia|SFNode coord|"
    "MFNode displacers|MFNode children",
    "Site": f"{_TRANSFORM}|MFNode children",
    "Displacer": "SFString name|MFInt32 coordIndex|MFVec3f displacements|SFFloat weight 0",
}
_BODIES = {
    "Humanoid": ("Transform", ("center", "rotation", "scale", "scaleOrientation", "translation")),
    "Joint": ("Transform", ("center", "rotation", "scale", "scaleOrientation", "translation", "children")),
    "Segment": ("Group", ("children",)),
    "Site": ("Transform", ("center", "rotation", "scale", "scaleOrientation", "translation", "children")),
    "Displacer": ("Group", ()),
}


def as_vrml97(scene: Scene) -> Scene:
    """Return a scene that `hanim_build` has made with its nodes as PROTOs of VRML97; the scene given is not kept."""
    result = Scene(Encoding.VRML97, version="2.0")
    result.comments = [f" {name}: {content}" for name, content in scene.metas]
    result.root.fields = [("", _proto(name)) for name in ("Displacer", "Site", "Segment", "Joint", "Humanoid")]
    waiting: list[Node] = [scene.root]
    while waiting:
        node = waiting.pop()
        node.type = _OLD_NAMES.get(node.type, node.type)
        node.fields = [
            (_FIELDS.get(key, key), value)
            for key, value in node.fields
            if not (node.type == "Humanoid" and key in _NOT_OLD)
        ]
        waiting.extend(value for _, value in node.fields if isinstance(value, Node))
    result.root.fields += scene.root.fields
    return result


def _proto(name: str) -> Proto:
    proto = Proto(name, [_declared(line) for line in _INTERFACES[name].split("|")])
    kind, fields = _BODIES[name]
    body = Node(kind, None, [(field, Is(field)) for field in fields])
    if name == "Humanoid":
        skin = Node("Group", None, [("children", Is("skin"))])
        tree = Node("Group", None, [("children", Is("humanoidBody"))])
        body.fields += [("children", tree), ("children", skin)]
    proto.body = Node("ProtoBody", None, [("children", body)])
    return proto


def _declared(line: str) -> Declared:
    kind, name, *rest = line.split()
    value: Any = np.array([float(word) for word in rest]) if rest else None
    if kind == "SFString":
        value = ""
    elif kind == "MFString":
        value = ()
    elif kind.startswith("MF") and value is None:
        value = np.zeros(0)
    return Declared("inputOutput", kind, name, [] if kind.endswith("Node") else [value])
