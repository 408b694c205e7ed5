"""Bodies and motions saved as X3D, ClassicVRML or VRML97 are read back equal, and other programs can take them."""

import gzip

import numpy as np
import pytest

from qmd_studio import registry
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.scene_file import parse_scene
from qmd_studio.formats.scene_graph import Encoding, Node, Use
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import (
    IDENTITY,
    Column,
    ColumnKind,
    EndSite,
    Joint,
    Skeleton,
    SkeletonKind,
)
from tests.corpus import corpus_file
from tests.formats.plain_hanim import PlainFigure

SUFFIXES = (".x3d", ".x3dv", ".wrl", ".x3dz", ".x3dvz", ".wrz")


def skeleton():
    columns = [Column(f"root t{a}", 0, ColumnKind.TRANSLATION, k, rest=(0, 1, 0)[k]) for k, a in enumerate("xyz")]
    for joint, name in enumerate(("root", "l_elbow", "hand & <co> 'x'")):
        limits = [(-2.5, 0.25), (-1.0, 1.0), (-0.125, 0.5)] if joint == 1 else [None] * 3
        columns += [
            Column(f"{name} r{a}", joint, ColumnKind.ROTATION, k, limits=limits[k]) for k, a in enumerate("xyz")
        ]
    columns.append(Column("smile", 1, ColumnKind.OPAQUE, 0))
    joints = (
        Joint("root", -1, (0.0, 1.0, 0.0), (5, 4, 3)),
        Joint("l_elbow", 0, (0.1, 0.3, 0.0), (8, 7, 6)),
        Joint("hand & <co> 'x'", 1, (0.0, 0.25, 0.05), (11, 10, 9)),
    )
    sites = (EndSite("crown", 0, (0.0, 0.5, 0.0)), EndSite("l_hand_tip", 2, (0.0, 0.1, 0.0)))
    return Skeleton("Ann", SkeletonKind.HANIM, joints, sites, tuple(columns), (0, 1, 2, 4))


def body(influences=3, seed=3):
    rng = np.random.default_rng(seed)
    bones = skeleton()
    n = 40
    normals = rng.normal(size=(n, 3))
    joints = np.argsort(rng.random((n, 4)), axis=1)[:, :influences] if influences < 4 else np.tile(np.arange(4), (n, 1))
    surface = Surface(
        vertices=rng.normal(size=(n, 3)).astype(np.float32),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        faces=np.concatenate([np.arange(39).reshape(-1, 3), [[39, 0, 7]]]),
        colours=rng.random((n, 3)).astype(np.float32)[np.arange(n) % 5],
        joints=np.sort(joints, axis=1),
        weights=rng.dirichlet(np.ones(joints.shape[1]), n).astype(np.float32),
    )
    bind = np.tile(np.eye(4), (3, 1, 1))
    bind[:, :3, 3] = [(0, 1, 0), (0.1, 1.3, 0), (0.1, 1.55, 0.05)]
    smile = Displacer("smile", 1, np.array([3, 17]), rng.normal(size=(2, 3)).astype(np.float32), 0.25)
    return Body("Ann", bones, surface, bind, ("pelvis", "", "l_hand"), (smile,))


def motion(frames=7, fps=24.0):
    rng = np.random.default_rng(5)
    bones = skeleton()
    X = rng.uniform(-1, 1, size=(frames, bones.n_columns))
    return Motion(bones, X, fps, name="wave")


def influence_table(surface, n_joints):
    table = np.zeros((len(surface.vertices), n_joints + 1))
    for k in range(surface.joints.shape[1]):
        np.add.at(table, (np.arange(len(table)), surface.joints[:, k]), surface.weights[:, k])
    return table


def assert_same_body(a, b):
    for name in ("vertices", "normals", "faces", "colours"):
        np.testing.assert_array_equal(getattr(a.surface, name), getattr(b.surface, name), err_msg=name)
    n_joints = len(a.skeleton.joints)
    np.testing.assert_allclose(influence_table(b.surface, n_joints), influence_table(a.surface, n_joints), atol=2e-6)
    assert [(j.name, j.parent) for j in a.skeleton.joints] == [(j.name, j.parent) for j in b.skeleton.joints]
    np.testing.assert_allclose(b.bind, a.bind, atol=1e-11)
    limits = [[c.limits for c in x.skeleton.columns if c.kind is ColumnKind.ROTATION] for x in (a, b)]
    assert sorted(filter(None, limits[0])) == sorted(filter(None, limits[1]))
    assert [(s.name, s.joint) for s in a.skeleton.end_sites] == [(s.name, s.joint) for s in b.skeleton.end_sites]
    offsets = [np.array([s.offset for s in x.skeleton.end_sites]).reshape(-1, 3) for x in (a, b)]
    np.testing.assert_allclose(offsets[1], offsets[0], atol=1e-11)
    assert [(d.name, d.joint, d.weight) for d in a.displacers] == [(d.name, d.joint, d.weight) for d in b.displacers]
    for one, other in zip(a.displacers, b.displacers, strict=True):
        assert np.array_equal(one.vertices, other.vertices)
        assert np.array_equal(one.displacements, other.displacements)


def assert_same_motion(a, b):
    assert (a.n_frames, b.fps) == (b.n_frames, pytest.approx(a.fps, rel=1e-9))
    np.testing.assert_allclose(world_from_joint(b.skeleton, b.X), world_from_joint(a.skeleton, a.X), atol=1e-8)
    for number, column in enumerate(a.skeleton.columns):
        if column.kind is ColumnKind.OPAQUE:
            names = [other.name for other in b.skeleton.columns]
            np.testing.assert_allclose(b.X[:, names.index(column.name)], a.X[:, number], atol=1e-9)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_saved_is_read_back_equal(tmp_path, suffix):
    path = tmp_path / f"ann{suffix}"
    registry.save_figure(path, body(), motion())
    loaded = registry.open_file(path)
    assert_same_body(body(), loaded.body)
    assert_same_motion(motion(), loaded.motion)
    assert loaded.body.segments[0] == "pelvis"
    assert all("less than 1" in warning for warning in loaded.warnings)  # what follows no joint is the body's own
    assert (path.read_bytes()[:2] == b"\x1f\x8b") == suffix.endswith("z")
    again = registry.encode_figure(suffix, loaded.body, loaded.motion)
    once_more = registry.encode_figure(suffix, loaded.body, loaded.motion)
    assert again == once_more


@pytest.mark.parametrize("encoding", list(Encoding))
def test_interpolators_hold_the_same_motion(encoding, tmp_path):
    path = tmp_path / "ann.any"
    path.write_bytes(figure_bytes(body(), motion(), encoding, interpolators=True))
    assert_same_motion(motion(), registry.open_file(path).motion)


@pytest.mark.parametrize("suffix", SUFFIXES[:3])
def test_a_body_without_motion_stands_at_rest(tmp_path, suffix):
    path = tmp_path / f"ann{suffix}"
    registry.save_figure(path, body())
    loaded = registry.open_file(path)
    assert loaded.motion.n_frames == 1
    np.testing.assert_allclose(world_from_joint(loaded.skeleton, loaded.motion.X)[0], body().bind, atol=1e-11)


def test_more_than_four_influences_become_the_strongest_four(tmp_path):
    rng = np.random.default_rng(0)
    base = body(influences=4)
    many = Surface(
        base.surface.vertices,
        base.surface.normals,
        base.surface.faces,
        base.surface.colours,
        np.tile(np.arange(6), (40, 1)),
        rng.dirichlet(np.ones(6), 40).astype(np.float32),
    )
    joints = base.skeleton.joints + tuple(Joint(f"j{k}", 0, (0.0, 0.0, 0.1 * k), ()) for k in range(3))
    bones = Skeleton("Ann", SkeletonKind.HANIM, joints, (), base.skeleton.columns, (0,))
    bind = np.concatenate([base.bind, np.tile(np.eye(4), (3, 1, 1))])
    registry.save_figure(tmp_path / "a.x3d", Body("Ann", bones, many, bind))
    loaded = registry.open_file(tmp_path / "a.x3d").body
    assert (loaded.surface.weights > 0).sum(axis=1).max() == 4
    np.testing.assert_allclose(loaded.surface.weights.sum(axis=1), 1, atol=1e-5)
    strongest = np.argsort(-many.weights, axis=1)[:, :4]
    for vertex in range(40):
        used = loaded.surface.joints[vertex][loaded.surface.weights[vertex] > 0]
        assert set(used.tolist()) == set(strongest[vertex].tolist())


def test_a_file_has_what_the_players_need():
    scene = parse_scene(figure_bytes(body(), motion(), Encoding.XML))
    assert (scene.version, scene.components, scene.profile) == ("4.0", [("HAnim", "3")], "Immersive")
    assert "generator" in dict(scene.metas)
    (humanoid,) = [value for _, value in scene.root.fields if isinstance(value, Node) and value.type == "HAnimHumanoid"]
    fields = {}
    for name, value in humanoid.fields:
        fields.setdefault(name, []).append(value)
    listed = [use.node for use in fields["joints"]]
    assert all(isinstance(use, Use) for use in fields["joints"])
    assert [node.get("name") for node in listed] == [joint.name for joint in skeleton().joints]
    mesh = fields["skin"][0].get("geometry")
    assert mesh.get("coord").node is fields["skinCoord"][0]  # the very node: equal copies do not animate elsewhere
    assert fields["motions"][0].get("loop") is True
    counts = np.bincount(np.concatenate([node.get("skinCoordIndex") for node in listed]))
    assert counts.max() <= 4


def test_another_evaluation_of_the_file_finds_the_same_skin():
    data = figure_bytes(body(), None, Encoding.XML)
    plain = PlainFigure(data.decode())
    _, points = plain.pose()
    np.testing.assert_allclose(points, body().surface.vertices, atol=1e-6)


@pytest.mark.parametrize("interpolators", [False, True])
def test_the_consortiums_own_package_accepts_every_field(interpolators):
    x3d = pytest.importorskip("x3d.x3d")
    scene = parse_scene(figure_bytes(body(), motion(), Encoding.XML, interpolators=interpolators))

    def built(node):
        many, arguments = {}, {}
        for name, value in node.fields:
            value = value.node if isinstance(value, Use) else value
            if isinstance(value, Node):
                kind = getattr(x3d, value.type)
                child = kind(USE="elsewhere") if value in done else built(value)
                many.setdefault(name, []).append(child)
            elif isinstance(value, np.ndarray):
                arguments[name] = shaped(node.type, name, value.tolist())
            elif name and isinstance(value, bool | str):
                arguments[name] = value
        single = ("geometry", "appearance", "material", "coord", "normal", "color", "skinCoord", "skinNormal")
        arguments |= {name: values[0] if name in single else values for name, values in many.items()}
        done.append(node)
        return getattr(x3d, node.type)(**arguments)

    done = []
    for _, value in scene.root.fields:
        if isinstance(value, Node):
            assert built(value).XML()


def shaped(node_type, name, values):
    """Numbers as x3d.py wants them: tuples for vectors, whole numbers where indices are due."""
    if name.endswith("Index") or name in ("loa", "endFrame"):
        values = [int(value) for value in values]
    width = {"point": 3, "vector": 3, "displacements": 3, "color": 3}.get(name)
    if name == "keyValue":
        width = {"OrientationInterpolator": 4, "PositionInterpolator": 3}.get(node_type)
    if width:
        return [tuple(values[k : k + width]) for k in range(0, len(values), width)]
    if name in ("loa", "endFrame", "weight", "creaseAngle", "frameDuration", "cycleInterval"):
        return values[0]
    return tuple(values) if name in ("center", "translation", "rotation", "diffuseColor") else values


@pytest.mark.corpus
@pytest.mark.parametrize("suffix", SUFFIXES[:3])
@pytest.mark.parametrize("name", ["BoxManC", "HAnimMotion", "HAnimPose"])
def test_real_figures_are_the_same_in_every_encoding(tmp_path, name, suffix):
    loaded = registry.open_file(corpus_file(f"hanim/xite_{name}.x3d"))
    path = tmp_path / f"figure{suffix}"
    registry.save_figure(path, loaded.body, loaded.motion)
    again = registry.open_file(path)
    assert_same_body(loaded.body, again.body)
    assert_same_motion(loaded.motion, again.motion)
    assert again.warnings == ()


def test_a_body_that_no_reader_would_take_is_refused():
    base = body()
    joints = tuple(Joint(f"j{k}", k - 1, (0.0, 0.1, 0.0), (), IDENTITY) for k in range(200))
    bones = Skeleton("chain", SkeletonKind.HANIM, joints, (), (), (0,))
    chain = Body("chain", bones, base.surface, np.tile(np.eye(4), (200, 1, 1)))
    with pytest.raises(FormatError, match="deeply"):
        figure_bytes(chain, None, Encoding.XML)
    broken = Surface(*(np.full_like(v, np.nan) if k == 0 else v for k, v in enumerate(parts(base.surface))))
    with pytest.raises(FormatError, match="finite"):
        figure_bytes(Body("nan", base.skeleton, broken, base.bind), None, Encoding.XML)


def parts(surface):
    return surface.vertices, surface.normals, surface.faces, surface.colours, surface.joints, surface.weights


def test_packed_content_opens_under_a_plain_name(tmp_path):
    path = tmp_path / "ann.x3d"
    path.write_bytes(gzip.compress(figure_bytes(body(), None, Encoding.CLASSIC)))
    assert_same_body(body(), registry.open_file(path).body)
