"""A body, and a motion on it, as a scene with an H-Anim figure, in the nodes of X3D 4.

It follows what the players need: the list of joints beside the skeleton, one Coordinate that the skin and its shape
share by USE, at most four influences a vertex, a name for every joint and segment.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from qmd_studio import __version__
from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_build_skin import Skin, displacer_fields, skin_nodes
from qmd_studio.formats.scene_graph import Encoding, Node, Scene, Use
from qmd_studio.motion.hanim_names import level_of_articulation, segment_of_joint

_NOT_A_NAME = re.compile(r"[^A-Za-z0-9_\-]")


@dataclass(slots=True)
class Built:
    """A scene with a figure in it: the nodes that a motion drives, and the DEF of each."""

    scene: Scene
    humanoid: Node
    joints: list[Node]
    displacers: dict[str, Node]


def build_figure(body: Body) -> Built:
    """Return the scene of `body`, standing at rest. Raises `FormatError` where a number of it is not finite."""
    _check(body)
    names = _Names()
    humanoid = Node("HAnimHumanoid", names.new(f"hanim_{body.name or 'humanoid'}"))
    loa = level_of_articulation(joint.name for joint in body.skeleton.joints)
    humanoid.fields += [("name", body.name or "humanoid"), ("version", "2.0"), ("loa", np.array([loa]))]
    skin = skin_nodes(body, names.new)
    joints, segments, sites = _tree(body, names, skin)
    humanoid.fields += [("skeleton", joints[i]) for i, j in enumerate(body.skeleton.joints) if j.parent < 0]
    if skin.coordinate is not None:
        humanoid.fields.append(("skinCoord", skin.coordinate))
    if skin.normal is not None:
        humanoid.fields.append(("skinNormal", skin.normal))
    if skin.shape is not None:
        humanoid.fields.append(("skin", skin.shape))
    for place, nodes in (("joints", joints), ("segments", segments), ("sites", sites)):
        humanoid.fields += [(place, Use(node.name or "", node)) for node in nodes]
    displacers = _displacers(body, names, joints)
    scene = _scene(body)
    scene.root.fields.append(("children", humanoid))
    return Built(scene, humanoid, joints, displacers)


class _Names:
    """Gives every node a DEF of its own, in letters that every encoding takes."""

    def __init__(self) -> None:
        self.taken: set[str] = set()

    def new(self, wanted: str) -> str:
        base = _NOT_A_NAME.sub("_", wanted) or "node"
        base = base if base[0].isalpha() else f"n{base}"
        name, count = base, 1
        while name in self.taken:
            count += 1
            name = f"{base}_{count}"
        self.taken.add(name)
        return name


def _scene(body: Body) -> Scene:
    scene = Scene(Encoding.XML, version="4.0", profile="Immersive", components=[("HAnim", "3")])
    scene.metas = [
        ("title", body.name or "humanoid"),
        ("generator", f"QMD Studio {__version__}"),
        ("specificationSection", "ISO/IEC 19774-1, HAnim 2.0"),
    ]
    return scene


def _check(body: Body) -> None:
    surface = body.surface
    for name, values in (("vertices", surface.vertices), ("weights", surface.weights), ("bind", body.bind)):
        if not np.isfinite(values).all():
            raise FormatError("a body with numbers that are not finite cannot be saved", at=name)
    vertices, joints = len(surface.vertices), len(body.skeleton.joints)
    if surface.faces.size and not 0 <= surface.faces.min() <= surface.faces.max() < vertices:
        raise FormatError("a face has a vertex that does not exist", wanted=f"below {vertices}")
    if surface.joints.size and not 0 <= surface.joints.min() <= surface.joints.max() <= joints:
        raise FormatError("a vertex follows a joint that does not exist", wanted=f"at most {joints}")


def _tree(body: Body, names: _Names, skin: Skin) -> tuple[list[Node], list[Node], list[Node]]:
    skeleton = body.skeleton
    centres = body.bind[:, :3, 3]
    joints: list[Node] = []
    segments: list[Node] = []
    sites: list[Node] = []
    carriers: list[Node] = []
    for number, joint in enumerate(skeleton.joints):
        node = Node("HAnimJoint", names.new(f"hanim_{joint.name}"))
        node.fields += [("name", joint.name), ("center", _tidy(centres[number]))]
        limits = _limits(body, number)
        if limits is not None:
            node.fields += [("llimit", limits[:, 0]), ("ulimit", limits[:, 1])]
        node.fields += skin.influences(number)
        joints.append(node)
        segment = Node("HAnimSegment", names.new(f"hanim_{_segment_name(body, number)}"))
        segment.fields.append(("name", _segment_name(body, number)))
        carriers.append(segment)
    places = _site_places(body)
    for site, place in zip(skeleton.end_sites, places, strict=True):
        node = Node("HAnimSite", names.new(f"hanim_{site.name}"))
        node.fields += [("name", site.name), ("translation", _tidy(place))]
        carriers[site.joint].fields.append(("children", node))
        sites.append(node)
    for number, segment in enumerate(carriers):
        segments.append(segment)
        joints[number].fields.append(("children", segment))
    for number, joint in enumerate(skeleton.joints):
        if joint.parent >= 0:
            joints[joint.parent].fields.append(("children", joints[number]))
    return joints, segments, sites


def _limits(body: Body, joint: int) -> FloatArray | None:
    """Return the limits (3, 2) radians of a joint that turns as Rz · Ry · Rx, where all three have some."""
    columns = [body.skeleton.columns[k] for k in body.skeleton.joints[joint].product]
    if [column.axis for column in columns] != [2, 1, 0]:
        return None
    pairs = [column.limits for column in columns[::-1] if column.limits is not None and column.sign == 1]
    limits = np.array(pairs, dtype=np.float64)
    return limits if len(pairs) == 3 and np.isfinite(limits).all() else None


def _segment_name(body: Body, joint: int) -> str:
    own = body.segments[joint] if body.segments else ""
    name = body.skeleton.joints[joint].name
    return own or segment_of_joint(name) or f"{name}_segment"


def _site_places(body: Body) -> FloatArray:
    """Return the places of the end sites (S, 3) in the binding pose."""
    places = np.zeros((len(body.skeleton.end_sites), 3))
    for row, site in enumerate(body.skeleton.end_sites):
        places[row] = body.bind[site.joint, :3, :3] @ np.array(site.offset) + body.bind[site.joint, :3, 3]
    return places


def _displacers(body: Body, names: _Names, joints: list[Node]) -> dict[str, Node]:
    found: dict[str, Node] = {}
    for displacer in body.displacers:
        node = Node("HAnimDisplacer", names.new(f"hanim_{displacer.name}"))
        node.fields += [("name", displacer.name), *displacer_fields(displacer)]
        joints[displacer.joint].fields.append(("displacers", node))
        found[displacer.name] = node
    return found


def _tidy(values: FloatArray) -> FloatArray:
    """Return lengths without the last digits that sums have left in them, far below a micrometre."""
    return np.asarray(np.round(values, 12) + 0.0, dtype=np.float64)
