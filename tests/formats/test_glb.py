"""Bodies and motions go out as glTF that other readers understand, come back equal, and hostile files are refused."""

import base64
import json
import struct
from dataclasses import replace

import numpy as np
import pygltflib
import pytest
import trimesh
from hypothesis import given, settings
from scipy.spatial.transform import Rotation

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.errors import FormatError
from qmd_studio.formats.gltf_read import read
from qmd_studio.formats.gltf_write import glb_bytes, gltf_bytes, strongest
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import open_file, save_figure, save_motion
from tests.corpus import corpus_file
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged
from tests.generated_motion import walker

TURNED = tuple(tuple(row) for row in Rotation.from_rotvec([0.3, -0.4, 0.5]).as_matrix().tolist())


def arm(*, influences=4):
    """A body of three joints, one turned at rest, with a skin of ten vertices, two of which smile."""
    random = np.random.default_rng(5)
    columns = [Column(f"t{a}", 0, ColumnKind.TRANSLATION, a, rest=float(a)) for a in range(3)]
    columns += [Column(f"r{j}{a}", j, ColumnKind.ROTATION, a) for j in range(3) for a in range(3)]
    columns.append(Column("smile", 0, ColumnKind.OPAQUE, 0))
    joints = [
        Joint("shoulder", -1, (0.0, 1.0, 2.0), (3, 4, 5)),
        Joint("elbow", 0, (0.0, -0.3, 0.0), (6, 7, 8), TURNED),
        Joint("wrist", 1, (0.0, -0.3, 0.1), (9, 10, 11)),
    ]
    skeleton = Skeleton(
        "arm", SkeletonKind.BVH, tuple(joints), (EndSite("tip", 2, (0.0, -0.1, 0.0)),), tuple(columns), (0, 1, 2, 3)
    )
    weights = random.random((10, influences))
    normals = random.normal(size=(10, 3))
    surface = Surface(
        vertices=random.normal(size=(10, 3)).astype(np.float32),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        faces=np.array([[0, 1, 2], [3, 4, 5], [6, 7, 9]], dtype=np.int64),
        colours=random.random((10, 3)).astype(np.float32),
        joints=random.integers(0, 4, size=(10, influences)),
        weights=(weights / weights.sum(axis=1, keepdims=True)).astype(np.float32),
    )
    smile = Displacer("smile", 1, np.array([2, 7]), np.array([[0, 0.1, 0], [0.2, 0, 0]], dtype=np.float32), 0.25)
    frown = Displacer("frown", 0, np.array([1]), np.array([[0, -0.1, 0]], dtype=np.float32), 0.5)
    bind = world_from_joint(skeleton, rest_values(skeleton)[None] + 0.1)[0]
    return Body("arm", skeleton, surface, bind, ("upper", "lower", "hand"), (smile, frown))


def waving(body, n_frames=20):
    t = np.linspace(0, 3, n_frames)[:, None]
    X = rest_values(body.skeleton) + 0.9 * np.sin(t + np.arange(body.skeleton.n_columns))
    return Motion(body.skeleton, X, 25.0, name="wave")


def load(data, **options):
    return read(data, ReadOptions(**options))


def assert_same_body(found, wanted):
    assert found.name == wanted.name
    assert found.segments == wanted.segments
    assert [(j.name, j.parent) for j in found.skeleton.joints] == [(j.name, j.parent) for j in wanted.skeleton.joints]
    for one, other in zip(found.skeleton.joints, wanted.skeleton.joints, strict=True):
        np.testing.assert_allclose(one.offset, other.offset, atol=1e-6)
        np.testing.assert_allclose(one.orientation, other.orientation, atol=1e-6)
    assert [s.name for s in found.skeleton.end_sites] == [s.name for s in wanted.skeleton.end_sites]
    for name in ("vertices", "normals", "colours", "faces"):
        np.testing.assert_allclose(getattr(found.surface, name), getattr(wanted.surface, name), atol=2e-6)
    np.testing.assert_allclose(shares(found), shares(wanted), atol=1e-6)
    np.testing.assert_allclose(found.bind, wanted.bind, atol=1e-5)
    assert [(d.name, d.joint, d.weight) for d in found.displacers] == [
        (d.name, d.joint, d.weight) for d in wanted.displacers
    ]
    for one, other in zip(found.displacers, wanted.displacers, strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)
        np.testing.assert_array_equal(one.displacements, other.displacements)


def shares(body):
    """How much of each vertex each joint has, whatever the order of the influences."""
    result = np.zeros((len(body.surface.vertices), len(body.skeleton.joints) + 1))
    np.add.at(result, (np.arange(len(result))[:, None], body.surface.joints), body.surface.weights)
    return result


@pytest.mark.parametrize("write", [glb_bytes, gltf_bytes])
def test_a_body_and_its_motion_come_back_equal(write):
    body = arm()
    motion = waving(body)
    loaded = load(write(body, motion))
    assert_same_body(loaded.body, body)
    assert loaded.motion.fps == motion.fps
    np.testing.assert_allclose(
        node_positions(loaded.skeleton, loaded.motion.X), node_positions(body.skeleton, motion.X), atol=1e-4
    )
    smile = [c.name for c in loaded.skeleton.columns].index("smile")
    np.testing.assert_allclose(loaded.motion.X[:, smile], motion.X[:, -1], atol=1e-6)
    assert not loaded.warnings


def test_a_second_trip_changes_nothing():
    body = arm()
    once = load(glb_bytes(body, waving(body)))
    again = load(glb_bytes(once.body, once.motion))
    assert_same_body(again.body, once.body)
    np.testing.assert_allclose(again.motion.X, once.motion.X, atol=1e-5)


def test_more_than_four_influences_become_the_strongest_and_it_is_said():
    body = arm(influences=7)
    _, weights, left_out = strongest(body.surface)
    assert left_out
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6)
    kept = np.sort(body.surface.weights, axis=1)[:, -4:]
    np.testing.assert_allclose(np.sort(weights, axis=1), kept / kept.sum(axis=1, keepdims=True), atol=1e-6)
    loaded = load(glb_bytes(body, None))
    assert loaded.body.surface.joints.shape == (10, 4)
    assert any("at most 4" in note for note in loaded.notes)


def test_trimesh_sees_the_vertices_faces_and_colours():
    body = bone_body(bap_skeleton())
    scene = trimesh.load(trimesh.util.wrap_as_stream(glb_bytes(body, None)), file_type="glb", process=False)
    mesh = scene.to_geometry()
    np.testing.assert_allclose(mesh.vertices, body.surface.vertices, atol=1e-6)
    np.testing.assert_array_equal(mesh.faces, body.surface.faces)


def pygltf_array(file, index):
    """An accessor of pygltflib's as an array, read anew from its blob."""
    entry = file.accessors[index]
    view = file.bufferViews[entry.bufferView]
    kind = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[entry.componentType]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[entry.type]
    start = (view.byteOffset or 0) + (entry.byteOffset or 0)
    return np.frombuffer(file.binary_blob(), kind, entry.count * width, start).reshape(entry.count, width)


def test_pygltflib_and_a_plain_evaluator_find_the_posed_skin():
    body = arm()
    motion = waving(body)
    file = pygltflib.GLTF2.load_from_bytes(glb_bytes(body, motion))
    frame = 13
    local = []
    for node in file.nodes:
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat(node.rotation or [0, 0, 0, 1]).as_matrix()
        matrix[:3, 3] = node.translation or 0
        local.append(matrix)
    weights = np.array(file.meshes[0].weights)
    for channel in file.animations[0].channels:
        values = pygltf_array(file, file.animations[0].samplers[channel.sampler].output)
        if channel.target.path == "rotation":
            local[channel.target.node][:3, :3] = Rotation.from_quat(values[frame]).as_matrix()
        elif channel.target.path == "translation":
            local[channel.target.node][:3, 3] = values[frame]
        else:
            weights = values.reshape(-1, len(weights))[frame]
    world = {}

    def visit(number, outer):
        world[number] = outer @ local[number]
        for child in file.nodes[number].children or []:
            visit(child, world[number])

    for root in file.scenes[file.scene].nodes:
        visit(root, np.eye(4))
    skin = file.skins[0]
    inverse = pygltf_array(file, skin.inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    palette = np.array([world[node] @ inverse[k] for k, node in enumerate(skin.joints)])
    attributes = file.meshes[0].primitives[0].attributes
    joints, shares_ = pygltf_array(file, attributes.JOINTS_0), pygltf_array(file, attributes.WEIGHTS_0)

    def shown(vertices, matrices, joint, weight):
        rows = np.concatenate([vertices, np.ones((len(vertices), 1))], axis=1)
        return np.einsum("vk,vkij,vj->vi", weight, matrices[joint], rows)[:, :3]

    moved = body.surface.vertices.astype(float)
    for displacer, weight in zip(body.displacers, weights, strict=True):
        moved[displacer.vertices] += weight * displacer.displacements
    found = shown(moved, palette, joints, shares_)
    own = world_from_joint(body.skeleton, motion.X[frame : frame + 1])[0] @ np.linalg.inv(body.bind)
    expected = body.surface.vertices.astype(float)
    for displacer, weight in zip(body.displacers, (motion.X[frame, -1], 0.5), strict=True):
        expected[displacer.vertices] += weight * displacer.displacements
    wanted = shown(expected, np.concatenate([own, [np.eye(4)]]), body.surface.joints, body.surface.weights)
    np.testing.assert_allclose(found, wanted, atol=1e-4)


def test_a_motion_without_a_body_goes_out_on_its_bones(tmp_path):
    motion = walker(40)
    for suffix in (".glb", ".gltf"):
        save_motion(tmp_path / f"walk{suffix}", motion)
        loaded = open_file(tmp_path / f"walk{suffix}")
        assert loaded.body is not None
        assert loaded.motion.n_frames == 40
        places = node_positions(loaded.skeleton, loaded.motion.X)
        np.testing.assert_allclose(places, node_positions(motion.skeleton, motion.X), atol=1e-4)


def test_the_registry_writes_a_figure(tmp_path):
    body = arm()
    save_figure(tmp_path / "arm.glb", body, waving(body))
    assert_same_body(open_file(tmp_path / "arm.glb").body, body)


class Made:
    """A file made by hand: JSON beside bytes, in either container."""

    def __init__(self):
        self.data = bytearray()
        self.root = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": [], "buffers": [{}]}

    def add(self, array, kind, **more):
        array = np.asarray(array)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        self.data += array.tobytes() + bytes(-array.nbytes % 4)
        self.root["bufferViews"].append(view)
        code = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        entry = {"bufferView": len(self.root["bufferViews"]) - 1, "componentType": code[array.dtype.name], "type": kind}
        self.root["accessors"].append(entry | {"count": array.size // width} | more)
        return len(self.root["accessors"]) - 1

    def glb(self):
        self.root["buffers"][0] = {"byteLength": len(self.data)}
        text = json.dumps(self.root).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.data))
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(self.data), b"BIN\0")
        return head + chunks + bytes(self.data)

    def gltf(self, uri=None):
        body = "data:application/octet-stream;base64," + base64.b64encode(bytes(self.data)).decode()
        self.root["buffers"][0] = {"byteLength": len(self.data), "uri": uri or body}
        return json.dumps(self.root).encode()


def made(*, interpolation="LINEAR", values=None, with_bind=False):
    """A skinned triangle under a node that scales by two, its second joint turning about z in two seconds."""
    file = Made()
    position = file.add(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32), "VEC3")
    joints = file.add(np.array([[0, 1, 0, 0]] * 3, dtype=np.uint8), "VEC4")
    weights = file.add(
        np.array([[255, 0, 0, 0], [0, 255, 0, 0], [51, 204, 0, 0]], dtype=np.uint8), "VEC4", normalized=True
    )
    colour = file.add(np.array([[65535, 0, 0, 0]] * 3, dtype=np.uint16), "VEC4", normalized=True)
    times = file.add(np.array([0, 2], dtype=np.float32), "SCALAR")
    half = np.sqrt(0.5)
    keys = np.array([[0, 0, 0, 1], [0, 0, half, half]] if values is None else values, dtype=np.float32)
    turns = file.add(keys, "VEC4")
    attributes = {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights, "COLOR_0": colour}
    file.root |= {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "above", "scale": [2, 2, 2], "children": [1, 3]},
            {"name": "a", "translation": [0, 1, 0], "children": [2]},
            {"name": "b", "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0, 0, 1], "children": [4]},
            {"name": "skin", "mesh": 0, "skin": 0},
            {"name": "hat", "mesh": 1, "translation": [0, 0.25, 0]},
        ],
        "meshes": [
            {"primitives": [{"attributes": attributes, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": position}, "mode": 5}]},
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]}}],
        "skins": [{"joints": [1, 2]}],
        "animations": [
            {
                "samplers": [{"input": times, "output": turns, "interpolation": interpolation}],
                "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
            }
        ],
    }
    if with_bind:
        matrices = np.tile(np.eye(4, dtype=np.float32), (2, 1, 1))
        matrices[0, 3, :3], matrices[1, 3, :3] = (0, -1, 0), (-0.5, -1, 0)  # column-major: translations are last
        file.root["skins"][0]["inverseBindMatrices"] = file.add(matrices, "MAT4")
    return file


def skinned(loaded, frame):
    body = loaded.body
    world = world_from_joint(loaded.skeleton, loaded.motion.X[frame : frame + 1])[0] @ np.linalg.inv(body.bind)
    world = np.concatenate([world, [np.eye(4)]])
    rows = np.concatenate([body.surface.vertices, np.ones((len(body.surface.vertices), 1))], axis=1)
    return np.einsum("vk,vkij,vj->vi", body.surface.weights, world[body.surface.joints], rows)[:, :3]


def test_scales_matrices_and_normalised_weights_are_taken_in():
    loaded = load(made(with_bind=True).glb(), fps=1.0)
    places = node_positions(loaded.skeleton, loaded.motion.X)
    np.testing.assert_allclose(places[0], [[0, 2, 0], [1, 2, 0]], atol=1e-6)
    assert loaded.motion.n_frames == 3
    np.testing.assert_allclose(shares(loaded.body)[:3, :2], [[1, 0], [0, 1], [0.2, 0.8]], atol=1e-6)
    np.testing.assert_allclose(loaded.body.surface.colours[:3], [[0.5, 0, 0]] * 3, atol=1e-6)
    # bound where it stands: at first the skin is as it is in the file, twice as large by the node above
    np.testing.assert_allclose(skinned(loaded, 0)[:3], [[0, 0, 0], [2, 0, 0], [0, 2, 0]], atol=1e-5)
    # a quarter turn about b at (1, 2): (2, 0) goes to (1, 2) + Rz(90) (1, -2) = (3, 3)
    np.testing.assert_allclose(skinned(loaded, 2)[1], [3, 3, 0], atol=1e-5)
    # the hat hangs from b: its corner (1, 0) stands at (1, 2) + 2 (1, 0.25) and turns with it
    np.testing.assert_allclose(skinned(loaded, 0)[4], [3, 2.5, 0], atol=1e-5)
    np.testing.assert_allclose(skinned(loaded, 2)[4], [1 - 0.5, 2 + 2, 0], atol=1e-5)


def test_missing_bind_matrices_are_the_identity():
    loaded = load(made().glb(), fps=1.0)
    # v is then in the joint's own frame: vertex 1 follows b at (1, 2), twice as large
    np.testing.assert_allclose(skinned(loaded, 0)[1], [3, 2, 0], atol=1e-5)


def test_a_length_unit_can_be_set():
    loaded = load(made(with_bind=True).glb(), fps=1.0, metres_per_unit=0.01)
    np.testing.assert_allclose(skinned(loaded, 2)[1], [0.03, 0.03, 0], atol=1e-7)


def angle_at(file, second):
    loaded = load(file.glb(), fps=4.0)
    tip = node_positions(loaded.skeleton, loaded.motion.X)
    world = world_from_joint(loaded.skeleton, loaded.motion.X)[round(4 * second), 1]
    assert len(tip) == 9
    return np.degrees(np.arctan2(world[1, 0], world[0, 0]))


def test_ways_to_go_from_key_to_key():
    assert angle_at(made(), 0.5) == pytest.approx(22.5, abs=1e-3)
    assert angle_at(made(interpolation="STEP"), 1.75) == pytest.approx(0, abs=1e-3)
    assert angle_at(made(interpolation="STEP"), 2.0) == pytest.approx(90, abs=1e-3)
    half = np.sqrt(0.5)
    still = [0, 0, 0, 0]
    keys = [still, [0, 0, 0, 1], still, still, [0, 0, half, half], still]
    part = 3 * 0.25**2 - 2 * 0.25**3  # without tangents: smooth step, of the quaternion's numbers
    wanted = np.degrees(2 * np.arctan2(part * half, 1 - part + part * half))
    assert angle_at(made(interpolation="CUBICSPLINE", values=keys), 0.5) == pytest.approx(wanted, abs=1e-3)


def test_the_longer_way_round_is_not_taken():
    half = np.sqrt(0.5)
    assert angle_at(made(values=[[0, 0, 0, 1], [0, 0, -half, -half]]), 1.0) == pytest.approx(45, abs=1e-3)


def test_a_buffer_beside_the_file_is_read_and_one_elsewhere_is_not(tmp_path):
    file = made()
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a b.bin").write_bytes(bytes(file.data))
    (tmp_path / "out.bin").write_bytes(bytes(file.data))
    path = tmp_path / "in" / "it.gltf"
    path.write_bytes(file.gltf("a%20b.bin"))
    assert len(open_file(path).skeleton.joints) == 2
    (tmp_path / "in" / "link.bin").symlink_to(tmp_path / "out.bin")
    elsewhere = [
        "../out.bin",
        str(tmp_path / "out.bin"),
        "http://example.org/out.bin",
        "file:///out.bin",
        "..%2Fout.bin",
    ]
    for uri in [*elsewhere, "link.bin", "none.bin", ".", "..", "C:\\out.bin", ""]:
        path.write_bytes(file.gltf(uri or "data:,"))
        with pytest.raises(FormatError, match=r"buffer|base64"):
            open_file(path)


@pytest.mark.corpus
def test_the_walking_man_opens_with_skin_colours_and_motion():
    loaded = open_file(corpus_file("mesh/cesium_man.gltf"))
    assert len(loaded.skeleton.joints) == 19
    assert len(loaded.body.surface.vertices) == 3273
    assert len(loaded.body.surface.faces) == 14016 // 3
    assert loaded.motion.n_frames > 40
    assert len(np.unique(loaded.body.surface.colours, axis=0)) > 300  # read from the picture
    for frame in range(0, loaded.motion.n_frames, 12):
        places = skinned(loaded, frame)
        assert 1.3 < np.ptp(places[:, 1]) < 1.7  # he walks upright
        assert np.ptp(places, axis=0).max() < 1.7
    scene = trimesh.load(corpus_file("mesh/cesium_man.gltf"), process=False)
    assert len(scene.to_geometry().vertices) == 3273
    again = load(glb_bytes(loaded.body, loaded.motion))
    np.testing.assert_allclose(
        node_positions(again.skeleton, again.motion.X), node_positions(loaded.skeleton, loaded.motion.X), atol=1e-4
    )


def changed(change):
    file = made(with_bind=True)
    change(file.root)
    return file.glb()


def nested(depth):
    return b'{"asset":{"version":"2.0"},"x":' + b"[" * depth + b"]" * depth + b"}"


def put(*path_and_value):
    *path, key, value = path_and_value

    def change(root):
        for step in path:
            root = root[step]
        root[key] = value

    return lambda: changed(change)


HOSTILE = {
    "beyond its buffer": put("accessors", 0, "byteOffset", 30),
    "2^31 vertices": put("accessors", 0, "count", 2**31 - 1),
    "2^31 zeros": put("accessors", 0, {"componentType": 5126, "count": 2**31 - 1, "type": "VEC3"}),
    "a count that overflows": put("accessors", 0, "count", 2**63),
    "a negative count": put("accessors", 0, "count", -1),
    "a view beyond its buffer": put("bufferViews", 0, "byteLength", 10**9),
    "a buffer longer than its chunk": lambda: made().glb().replace(b'"byteLength": ', b'"byteLength":9'),
    "from the network": lambda: made().gltf("http://example.org/x.bin"),
    "no such node": put("skins", 0, "joints", [1, 77]),
    "a joint twice": put("skins", 0, "joints", [1, 1]),
    "cyclic": put("nodes", 2, "children", [0]),
    "itself": put("nodes", 2, "children", [2]),
    "two parents": put("nodes", 0, "children", [1, 3, 2]),
    "a joint out of range": lambda: bytes(_patched_joint()),
    "nan vertices": lambda: made().glb().replace(struct.pack("<3f", 1, 0, 0), struct.pack("<3f", float("nan"), 0, 0)),
    "nan in the JSON": put("nodes", 1, "translation", [float("nan"), 0, 0]),
    "a huge translation": put("nodes", 1, "translation", [1e300, 0, 0]),
    "a rotation of nothing": put("nodes", 1, "rotation", [0, 0, 0, 0]),
    "no scale": put("nodes", 0, "scale", [0, 0, 0]),
    "deep": lambda: nested(100_000),
    "deep in a glb": lambda: _glb_of(nested(100_000)),
    "wrong length": lambda: made().glb()[:-4],
    "wrong version": lambda: made().glb().replace(struct.pack("<4sI", b"glTF", 2), struct.pack("<4sI", b"glTF", 1)),
    "version 1": put("asset", "version", "1.0"),
    "draco": put("extensionsRequired", ["KHR_draco_mesh_compression"]),
    "no node": put("nodes", []),
    "too few bind matrices": put("skins", 0, "joints", [1, 2, 4]),
    "times that fall": put("animations", 0, "samplers", 0, "input", 5),
    "an unknown interpolation": put("animations", 0, "samplers", 0, "interpolation", "MAGIC"),
    "a long animation": lambda: made().glb().replace(struct.pack("<2f", 0, 2), struct.pack("<2f", 0, 9e5)),
    "sparse without a view": put("accessors", 0, "sparse", {"count": 1, "indices": {"componentType": 5123}}),
    "lists for objects": put("nodes", [[]]),
    "words for lists": put("nodes", "abc"),
    "no json": lambda: b"glTF",
    "not gltf": lambda: b"{}",
}


def _patched_joint():
    data = made().glb()
    return data.replace(bytes([0, 1, 0, 0] * 3), bytes([0, 99, 0, 0] * 3))


def _glb_of(text):
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON") + text


@pytest.mark.parametrize("make", HOSTILE.values(), ids=HOSTILE)
def test_what_is_hostile_is_refused(make):
    data = make()
    assert isinstance(assert_ends_well(lambda given: load(given, fps=4.0), data), FormatError)


def test_two_keys_do_not_ask_for_half_a_million_poses():
    data = made().glb().replace(struct.pack("<2f", 0, 2), struct.pack("<2f", 0, 4))
    assert load(data, fps=10_000.0).motion.n_frames == 40_001
    problem = assert_ends_well(lambda given: load(given, fps=60_000.0), data)
    assert isinstance(problem, FormatError)
    assert "too long" in problem.message


def test_one_accessor_named_a_thousand_times_is_refused():
    file = made()
    big = {"componentType": 5126, "count": 1_000_000, "type": "VEC3"}
    file.root["accessors"].append(big)
    primitive = {"attributes": {"POSITION": len(file.root["accessors"]) - 1}}
    file.root["meshes"][1]["primitives"] = [primitive] * 1000
    assert isinstance(assert_ends_well(load, file.glb()), FormatError)


def test_every_prefix_ends_well():
    assert_every_prefix_ends_well(load, made(with_bind=True).glb())
    assert_every_prefix_ends_well(load, made().gltf())


@settings(max_examples=150, deadline=None)
@given(damaged(made(with_bind=True).glb()))
def test_damage_ends_well(data):
    assert_ends_well(load, data)


@settings(max_examples=100, deadline=None)
@given(damaged(made(with_bind=True).gltf()))
def test_damaged_json_ends_well(data):
    assert_ends_well(load, data)


def test_writing_changes_nothing_of_the_body():
    body = arm()
    kept = replace(body.surface, vertices=body.surface.vertices.copy())
    glb_bytes(body, waving(body))
    np.testing.assert_array_equal(body.surface.vertices, kept.vertices)
