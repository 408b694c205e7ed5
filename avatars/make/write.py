"""A figure as an H-Anim humanoid in X3D: one seamless skin, or a mesh for each segment.

The skin's shapes all use the one coordinate node that the humanoid's `skinCoord` is, and every joint stands both in
the tree and in the `joints` list: players differ in which of these they need.
"""

from __future__ import annotations

import csv
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from avatars.make.figure import parents, part_of
from avatars.make.model import ALL_MATERIALS, Model
from avatars.make.segments import Part, parts_of

HERE = Path(__file__).parent
_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE X3D PUBLIC "ISO//Web3D//DTD X3D 4.0//EN" "https://www.web3d.org/specifications/x3d-4.0.dtd">
<X3D profile='Immersive' version='4.0'>
<head>
<component name='HAnim' level='1'/>
<meta name='title' content={title}/>
<meta name='description' content={description}/>
<meta name='license' content='MIT'/>
</head>
<Scene>
"""


def document(model: Model, *, segmented: bool = False) -> str:
    """Return the X3D file's text."""
    return "\n".join(_lines(model, segmented)) + "\n"


def _lines(model: Model, segmented: bool):
    name = model.figure.name
    kind = "a mesh for each segment" if segmented else "one seamless skin"
    title = f"{model.figure.title}, an H-Anim figure of QMD Studio"
    yield _HEAD.format(title=quoteattr(title), description=quoteattr(f"Level of articulation 3, {kind}")).rstrip()
    yield f"<HAnimHumanoid DEF='{name}' name='{name}' version='2.0' loa='3' skeletalConfiguration='BASIC'>"
    if segmented:
        yield from _joint(model, "HumanoidRoot", {part.joint: part for part in parts_of(model)})
    else:
        yield from _joint(model, "HumanoidRoot", None)
        yield f"<Coordinate DEF='{name}_coord' containerField='skinCoord' point='{_triples(model.points, 4)}'/>"
        yield f"<Normal DEF='{name}_normal' containerField='skinNormal' vector='{_triples(model.normals, 2)}'/>"
        yield from _skin(model)
    for joint in model.joints:
        yield f"<HAnimJoint USE='{name}_{joint}' containerField='joints'/>"
    segments = _segments()
    for joint in model.joints:
        yield f"<HAnimSegment USE='{name}_{segments[joint]}' containerField='segments'/>"
    for joint in model.joints:
        for site, _ in _sites(model, joint):
            yield f"<HAnimSite USE='{name}_{site}' containerField='sites'/>"
    yield "</HAnimHumanoid>\n</Scene>\n</X3D>"


def _joint(model: Model, joint: str, parts: dict[str, Part] | None):
    name, centre = model.figure.name, model.figure.centres()[joint]
    skin = ""
    if parts is None:
        weight = model.weights[:, model.joints.index(joint)]
        index = np.flatnonzero(weight)
        if len(index):
            shares = " ".join(_number(w, 4) for w in weight[index])
            skin = f" skinCoordIndex='{' '.join(map(str, index))}' skinCoordWeight='{shares}'"
    place = "" if parents()[joint] else " containerField='skeleton'"
    yield f"<HAnimJoint DEF='{name}_{joint}' name='{joint}' center='{_vector(centre)}'{skin}{place}>"
    segment = _segments()[joint]
    yield f"<HAnimSegment DEF='{name}_{segment}' name='{segment}'>"
    for site, at in _sites(model, joint):
        yield f"<HAnimSite DEF='{name}_{site}' name='{site}' translation='{_vector(at)}'/>"
    if parts is not None and joint in parts:
        yield from _segment_shapes(model, parts[joint], f"{name}_{segment}")
    yield "</HAnimSegment>"
    for child, parent in parents().items():
        if parent == joint:
            yield from _joint(model, child, parts)
    yield "</HAnimJoint>"


def _skin(model: Model):
    name = model.figure.name
    for number, material in enumerate(ALL_MATERIALS):
        faces = model.faces[model.materials == number]
        if len(faces):
            yield from _shape(
                model, material, faces, f"USE='{name}_coord'", f"USE='{name}_normal'", " containerField='skin'"
            )


def _segment_shapes(model: Model, part: Part, name: str):
    coordinate = f"DEF='{name}_coord' point='{_triples(part.points, 4)}'"
    normal = f"DEF='{name}_normal' vector='{_triples(part.normals, 2)}'"
    for number, material in enumerate(ALL_MATERIALS):
        faces = part.faces[part.materials == number]
        if len(faces):
            yield from _shape(model, material, faces, coordinate, normal, "")
            coordinate, normal = f"USE='{name}_coord'", f"USE='{name}_normal'"


def _shape(model: Model, material: str, faces, coordinate: str, normal: str, place: str):
    colour = " ".join(_number(c, 3) for c in colour_of(model, material))
    shine = "0.6 0.6 0.6' shininess='0.6" if material in ("eyes", "irises", "pupils") else "0.05 0.05 0.05"
    index = " ".join(f"{a} {b} {c} -1" for a, b, c in faces)
    yield f"<Shape{place}>"
    yield f"<Appearance><Material diffuseColor='{colour}' specularColor='{shine}'/></Appearance>"
    yield f"<IndexedFaceSet creaseAngle='3.1416' coordIndex='{index}'>"
    yield f"<Coordinate {coordinate}/>\n<Normal {normal}/>"
    yield "</IndexedFaceSet>"
    yield "</Shape>"


def colour_of(model: Model, material: str) -> tuple[float, float, float]:
    """Return a material's colour, sRGB 0 to 1."""
    look = model.figure.look
    fixed = {"eyes": (0.93, 0.92, 0.90), "pupils": (0.03, 0.03, 0.04), "irises": look.iris}
    if material == "nails":
        return tuple(0.7 * s + 0.3 * t for s, t in zip(look.skin, (1.0, 0.80, 0.76), strict=True))
    return fixed.get(material) or getattr(look, material)


def _sites(model: Model, joint: str):
    """Yield the name and the place (3,) of the feature points on a joint's segment."""
    mirrored = joint.startswith("r_")
    left = "l_" + joint[2:] if mirrored else joint
    flip = np.array([-1.0 if mirrored else 1.0, 1.0, 1.0])
    for row in _rows("sites.csv"):
        if row["joint"] == left:
            at = model.figure.place(part_of(left), [float(row[axis]) for axis in ("x_m", "y_m", "z_m")])
            site = "r_" + row["name"][2:] if mirrored else row["name"]
            yield site if site.endswith("_tip") else f"{site}_pt", at * flip


def _segments() -> dict[str, str]:
    return {row["joint"]: row["segment"] for row in _rows("segments.csv")}


def _rows(name: str) -> list[dict[str, str]]:
    with (HERE / name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def _number(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    text = "0" if text in ("-0", "") else text
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def _vector(values) -> str:
    return " ".join(_number(v, 4) for v in values)


def _triples(values, digits: int) -> str:
    return ",".join(" ".join(_number(v, digits) for v in row) for row in values)
