"""An H-Anim figure in XML evaluated straight from the standard's formulas, node by node, with SciPy's rotations.

It shares nothing with the studio's reader: xml.etree, recursion, one matrix after the other.
"""

from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation, Slerp


def numbers(text):
    return np.array([float(word) for word in (text or "").replace(",", " ").split()])


def rotation(values):
    axis, angle = np.array(values[:3]), values[3]
    length = np.linalg.norm(axis)
    return Rotation.from_rotvec(axis / length * angle) if length else Rotation.identity()


def affine(linear=None, shift=None):
    matrix = np.eye(4)
    if linear is not None:
        matrix[:3, :3] = linear
    if shift is not None:
        matrix[:3, 3] = shift
    return matrix


def transform(element, turn=None, move=None):
    """T · C · R · SR · S · -SR · -C of an element, its rotation (a `Rotation`) or translation given instead."""

    def field(name, default):
        return numbers(element.get(name)) if element.get(name) else np.array(default, dtype=float)

    centre = field("center", [0, 0, 0])
    turned = turn if turn is not None else rotation(field("rotation", [0, 0, 1, 0]))
    moved = move if move is not None else field("translation", [0, 0, 0])
    scale_turn = rotation(field("scaleOrientation", [0, 0, 1, 0])).as_matrix()
    parts = [
        affine(shift=moved),
        affine(shift=centre),
        affine(turned.as_matrix()),
        affine(scale_turn),
        affine(np.diag(field("scale", [1, 1, 1]))),
        affine(scale_turn.T),
        affine(shift=-centre),
    ]
    return np.linalg.multi_dot(parts)


class PlainFigure:
    """The first humanoid of a file: `pose` gives joint positions and skin points for turns and moves by joint name."""

    def __init__(self, text):
        self.root = ElementTree.fromstring(text)
        self.humanoid = self.root.find(".//HAnimHumanoid")
        self.space = transform(self.humanoid)
        coordinate = self.humanoid.find("Coordinate[@containerField='skinCoord']")
        if coordinate is not None and coordinate.get("USE"):
            coordinate = self.root.find(f".//Coordinate[@DEF='{coordinate.get('USE')}']")
        self.points = numbers(coordinate.get("point")).reshape(-1, 3) if coordinate is not None else None

    def pose(self, turns=None, moves=None):
        places, matrices, joints = {}, {}, {}

        def visit(joint, outer):
            name = joint.get("name") or joint.get("DEF")
            own = outer @ transform(joint, (turns or {}).get(name), (moves or {}).get(name))
            centre = np.append(numbers(joint.get("center") or "0 0 0"), 1)
            places[name] = (self.space @ own @ centre)[:3]
            matrices[name], joints[name] = own, joint
            for child in joint.findall("HAnimJoint"):
                if child.get("USE") is None:
                    visit(child, own)

        for child in self.humanoid.findall("HAnimJoint"):
            if child.get("containerField") in (None, "skeleton", "children") and child.get("USE") is None:
                visit(child, np.eye(4))
        return places, self._skin(matrices, joints)

    def _skin(self, matrices, joints):
        if self.points is None:
            return None
        moved = self.points.copy()
        for name, joint in joints.items():
            index = numbers(joint.get("skinCoordIndex")).astype(int)
            weight = numbers(joint.get("skinCoordWeight"))
            for k, point in enumerate(index):
                w = weight[k] if k < len(weight) else 1.0
                if 0 <= point < len(self.points):
                    at_rest = self.points[point]
                    moved[point] += w * ((matrices[name] @ np.append(at_rest, 1))[:3] - at_rest)
        return moved @ self.space[:3, :3].T + self.space[:3, 3]

    def routed(self, fraction):
        """Turns and moves by joint name that the file's interpolators give at `fraction` of the cycle."""
        named = {e.get("DEF"): e for e in self.root.iter() if e.get("DEF")}
        turns, moves = {}, {}
        for route in self.root.iter("ROUTE"):
            source, target = named.get(route.get("fromNode")), named.get(route.get("toNode"))
            if source is None or target is None or target.tag != "HAnimJoint" or source.get("key") is None:
                continue
            keys, values = numbers(source.get("key")), numbers(source.get("keyValue"))
            if source.tag == "OrientationInterpolator":
                spin = Rotation.concatenate([rotation(row) for row in values.reshape(-1, 4)])
                turns[target.get("name")] = Slerp(keys, spin)(fraction)
            else:
                table = values.reshape(-1, 3)
                moves[target.get("name")] = np.array([np.interp(fraction, keys, table[:, k]) for k in range(3)])
        return turns, moves


def skinned(body, world):
    """Vertices (V, 3) of a body posed by world_from_joint (J, 4, 4), summed vertex by vertex."""
    surface = body.surface
    matrices = [world[j] @ np.linalg.inv(body.bind[j]) for j in range(len(body.bind))] + [np.eye(4)]
    result = np.zeros((len(surface.vertices), 3))
    for vertex, (joints, weights) in enumerate(zip(surface.joints, surface.weights, strict=True)):
        home = np.append(surface.vertices[vertex].astype(float), 1)
        for joint, weight in zip(joints, weights, strict=True):
            result[vertex] += weight * (matrices[joint] @ home)[:3]
    return result
