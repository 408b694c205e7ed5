"""Writing glTF 2.0: a body with its skin and morph targets, and a motion as an animation of its joints."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.formats.gltf_document import Record
from qmd_studio.formats.gltf_nodes import quaternion_of
from qmd_studio.motion.kinematics import chain_of, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind, Skeleton

GENERATOR = "QMD Studio"
MAX_INFLUENCES = 4
_FIGURE = 0
_CODES = {"int8": 5120, "uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963


@dataclass(slots=True)
class _Buffer:
    """The bytes so far, with the views and accessors that say what they are."""

    data: bytearray = field(default_factory=bytearray)
    views: list[Record] = field(default_factory=list)
    accessors: list[Record] = field(default_factory=list)

    def view(self, values: NDArray[Any], target: int | None = None) -> int:
        """Append an array, aligned to four bytes; return the number of its view."""
        self.data.extend(bytes(-len(self.data) % 4))
        raw = np.ascontiguousarray(values).tobytes()
        entry: Record = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)}
        if target is not None:
            entry["target"] = target
        self.data.extend(raw)
        self.views.append(entry)
        return len(self.views) - 1

    def accessor(self, values: NDArray[Any], target: int | None = None, *, bounds: bool = False) -> int:
        """Append an array (n,) or (n, w) as an accessor, with its least and greatest values if `bounds`."""
        columns = values.reshape(len(values), -1)
        entry: Record = {
            "bufferView": self.view(columns, target),
            "componentType": _CODES[values.dtype.name],
            "count": len(columns),
            "type": _TYPES[columns.shape[1]],
        }
        if bounds:
            entry |= {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def sparse(self, displacer: Displacer, n_vertices: int) -> int:
        """Append what a displacer adds to each of `n_vertices` as an accessor that names only the vertices it moves."""
        vertices, shifts = _summed(displacer, n_vertices)
        entry: Record = {"componentType": 5126, "count": n_vertices, "type": "VEC3"}
        low, high = np.zeros(3, dtype=np.float32), np.zeros(3, dtype=np.float32)
        if len(vertices):
            low, high = shifts.min(axis=0), shifts.max(axis=0)
            if len(vertices) < n_vertices:
                low, high = np.minimum(low, 0), np.maximum(high, 0)
            entry["sparse"] = {
                "count": len(vertices),
                "indices": {"bufferView": self.view(vertices.astype(np.uint32)), "componentType": 5125},
                "values": {"bufferView": self.view(shifts)},
            }
        self.accessors.append(entry | {"min": low.tolist(), "max": high.tolist()})
        return len(self.accessors) - 1


def glb_bytes(body: Body, motion: Motion | None) -> bytes:
    """Return a .glb file with `body`, and with `motion` on its skeleton where one is given."""
    root, data = _document(body, motion)
    text = json.dumps(root, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    head = struct.pack("<4sII", b"glTF", 2, length) + struct.pack("<I4s", len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(data), b"BIN\0") + data


def gltf_bytes(body: Body, motion: Motion | None) -> bytes:
    """Return a .gltf file with `body` and `motion`, its numbers within it in base64."""
    root, data = _document(body, motion)
    root["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps(root, indent=1, allow_nan=False).encode()


def strongest(surface: Surface) -> tuple[IntArray, Float32Array, bool]:
    """Return joints and weights (V, 4) of the four strongest influences, summing to 1, and whether any was left out."""
    joints, weights = surface.joints, surface.weights.astype(np.float64)
    short = MAX_INFLUENCES - joints.shape[1]
    if short >= 0:
        return np.pad(joints, ((0, 0), (0, short))), _whole(np.pad(weights, ((0, 0), (0, short)))), False
    order = np.argsort(-weights, axis=1, kind="stable")
    kept = order[:, :MAX_INFLUENCES]
    left_out = bool(np.take_along_axis(weights, order[:, MAX_INFLUENCES:], axis=1).any())
    return np.take_along_axis(joints, kept, axis=1), _whole(np.take_along_axis(weights, kept, axis=1)), left_out


def _whole(weights: FloatArray) -> Float32Array:
    total = weights.sum(axis=1, keepdims=True)
    exact = np.abs(total - 1) < 1e-6
    return np.where(exact, weights, weights / np.where(total > 0, total, 1.0)).astype(np.float32)


def _document(body: Body, motion: Motion | None) -> tuple[Record, bytes]:
    buffer = _Buffer()
    skeleton, surface = body.skeleton, body.surface
    nodes = _nodes(skeleton)
    own: Record = {"name": body.name, "joints": [joint.name for joint in skeleton.joints]}
    root: Record = {"asset": {"version": "2.0", "generator": GENERATOR, "extras": {"qmd_studio": own}}, "scene": 0}
    if body.segments:
        own["segments"] = list(body.segments)
    mesh_node = None
    skin_joints = list(range(1, len(skeleton.joints) + 1))
    if len(surface.faces):
        if int(surface.joints.max()) >= len(skeleton.joints):
            own["figure"] = _FIGURE
            skin_joints.append(_FIGURE)
        mesh_node = len(nodes)
        nodes.append({"name": f"{body.name} skin", "mesh": 0, "skin": 0})
        root["meshes"] = [_mesh(buffer, body, own)]
        root["materials"] = [{"name": "vertex colours", "pbrMetallicRoughness": {"metallicFactor": 0.0}}]
    inverse = np.tile(np.eye(4), (len(skin_joints), 1, 1))
    inverse[: len(skeleton.joints)] = np.linalg.inv(body.bind)
    bind = buffer.accessor(inverse.swapaxes(1, 2).reshape(-1, 16).astype(np.float32))
    root["skins"] = [
        {"name": body.name, "joints": skin_joints, "skeleton": _FIGURE, "inverseBindMatrices": bind},
    ]
    root["scenes"] = [{"name": body.name, "nodes": [_FIGURE] if mesh_node is None else [_FIGURE, mesh_node]}]
    root["nodes"] = nodes
    if motion is not None:
        own["fps"] = motion.fps
        root["animations"] = [_animation(buffer, body, motion, mesh_node)]
    root["accessors"], root["bufferViews"] = buffer.accessors, buffer.views
    root["buffers"] = [{"byteLength": len(buffer.data)}]
    return root, bytes(buffer.data)


def _nodes(skeleton: Skeleton) -> list[Record]:
    """Return the figure, its joints at rest, and its end sites as nodes, in that order."""
    nodes: list[Record] = [{"name": "figure"}]
    turns = quaternion_of(np.array([joint.orientation for joint in skeleton.joints], dtype=np.float64))
    for joint, turn in zip(skeleton.joints, turns, strict=True):
        nodes.append({"name": joint.name, "translation": list(joint.offset)})
        if abs(turn[3]) < 1 - 1e-12:
            nodes[-1]["rotation"] = turn.tolist()
        nodes[joint.parent + 1].setdefault("children", []).append(len(nodes) - 1)
    for site in skeleton.end_sites:
        nodes.append({"name": site.name, "translation": [float(x) for x in site.offset]})
        nodes[site.joint + 1].setdefault("children", []).append(len(nodes) - 1)
    return nodes


def _mesh(buffer: _Buffer, body: Body, own: Record) -> Record:
    surface = body.surface
    joints, weights, left_out = strongest(surface)
    if left_out:
        own["notes"] = [f"vertices follow at most {MAX_INFLUENCES} joints here; weaker ones were left out"]
    joints = np.where(weights > 0, joints, 0)
    small = len(body.skeleton.joints) < 255
    attributes = {
        "POSITION": buffer.accessor(surface.vertices.astype(np.float32), _ARRAY_BUFFER, bounds=True),
        "NORMAL": buffer.accessor(surface.normals.astype(np.float32), _ARRAY_BUFFER),
        "COLOR_0": buffer.accessor(surface.colours.astype(np.float32), _ARRAY_BUFFER),
        "JOINTS_0": buffer.accessor(joints.astype(np.uint8 if small else np.uint16), _ARRAY_BUFFER),
        "WEIGHTS_0": buffer.accessor(weights, _ARRAY_BUFFER),
    }
    faces = buffer.accessor(surface.faces.ravel().astype(np.uint32), _ELEMENT_BUFFER)
    primitive: Record = {"attributes": attributes, "indices": faces, "material": 0, "mode": 4}
    mesh: Record = {"name": body.name, "primitives": [primitive]}
    if body.displacers:
        n_vertices = len(surface.vertices)
        primitive["targets"] = [{"POSITION": buffer.sparse(d, n_vertices)} for d in body.displacers]
        mesh["weights"] = [float(displacer.weight) for displacer in body.displacers]
        mesh["extras"] = {"targetNames": [displacer.name for displacer in body.displacers]}
        own["displacer_joints"] = [int(displacer.joint) for displacer in body.displacers]
    return mesh


def _animation(buffer: _Buffer, body: Body, motion: Motion, mesh_node: int | None) -> Record:
    skeleton = body.skeleton
    world = world_from_joint(skeleton, motion.X)
    times = buffer.accessor((np.arange(motion.n_frames) / motion.fps).astype(np.float32), bounds=True)
    moved = {skeleton.columns[column].joint for column in chain_of(skeleton).move_column.tolist()}
    samplers: list[Record] = []
    channels: list[Record] = []

    def add(node: int, path: str, values: FloatArray) -> None:
        output = buffer.accessor(values.astype(np.float32))
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})

    for number, joint in enumerate(skeleton.joints):
        turn, place = world[:, number, :3, :3], world[:, number, :3, 3]
        if joint.parent >= 0:
            outer = world[:, joint.parent]
            turn = outer[:, :3, :3].swapaxes(1, 2) @ turn
            place = np.einsum("fji,fj->fi", outer[:, :3, :3], place - outer[:, :3, 3])
        add(number + 1, "rotation", quaternion_of(turn))
        if number in moved:
            add(number + 1, "translation", place)
    weights = _weights(body, motion)
    if mesh_node is not None and weights is not None:
        add(mesh_node, "weights", weights.reshape(-1, 1))
    return {"name": motion.name or body.name, "samplers": samplers, "channels": channels}


def _weights(body: Body, motion: Motion) -> FloatArray | None:
    """Return the displacers' weights (n_frames, n_displacers), None where no opaque column has the name of one."""
    columns = {c.name: k for k, c in enumerate(body.skeleton.columns) if c.kind is ColumnKind.OPAQUE}
    if not any(displacer.name in columns for displacer in body.displacers):
        return None
    still = np.ones(motion.n_frames)
    rows = [motion.X[:, columns[d.name]] if d.name in columns else d.weight * still for d in body.displacers]
    return np.stack(rows, axis=1)


def _summed(displacer: Displacer, n_vertices: int) -> tuple[IntArray, Float32Array]:
    """Return the vertices that move, rising, each once, and what is added to them."""
    good = (displacer.vertices >= 0) & (displacer.vertices < n_vertices)
    vertices, place = np.unique(displacer.vertices[good], return_inverse=True)
    shifts = np.zeros((len(vertices), 3), dtype=np.float32)
    np.add.at(shifts, place, displacer.displacements[good].astype(np.float32))
    return vertices.astype(np.int64), shifts
