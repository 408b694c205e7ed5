"""H-Anim in VRML97 is known by the names of its PROTOs, in the dialects of its versions; robots are left alone."""

from pathlib import Path

import numpy as np
import pytest

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_file import parse_scene
from qmd_studio.formats.scene_graph import Node
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.registry import open_file

GOLDEN = Path(__file__).parent / "golden"


def test_version_1_has_a_humanoid_body_and_lists_before_the_tree():
    loaded = open_file(GOLDEN / "hanim10.wrl")
    skeleton = loaded.skeleton
    assert [(j.name, j.parent) for j in skeleton.joints] == [("HumanoidRoot", -1), ("l_hip", 0), ("l_knee", 1)]
    assert [site.name for site in skeleton.end_sites] == ["l_foot_tip"]
    assert loaded.body.segments == ("sacrum", "l_thigh", "l_calf")
    assert loaded.warnings == ()
    assert (loaded.motion.n_frames, loaded.motion.fps) == (61, 30)
    tips = node_positions(skeleton, loaded.motion.X)[:, 3]
    # the hip is turned by -0.5 about x all the time, the knee swings to -1 and back
    hip, knee = np.array([0.1, 0.95, 0]), np.array([0, -0.45, 0])
    for frame, swing in ((0, 0.0), (15, -0.5), (30, -1.0), (60, 0.0)):
        expected = hip + turn(-0.5) @ (knee + turn(swing) @ [0, -0.5, 0.2])
        np.testing.assert_allclose(tips[frame], expected, atol=1e-9)


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def test_one_shape_used_in_three_segments_is_three_meshes():
    surface = open_file(GOLDEN / "hanim10.wrl").body.surface
    assert np.bincount(surface.joints[:, 0]).tolist() == [36, 36, 36]
    np.testing.assert_allclose(surface.colours[0], [1, 0.5**2.2, 0], rtol=1e-6)
    heights = [surface.vertices[surface.joints[:, 0] == joint, 1].mean() for joint in range(3)]
    np.testing.assert_allclose(heights, [1, 0.7, 0.25], atol=1e-6)


def test_version_2001_has_a_skin_and_displacers():
    loaded = open_file(GOLDEN / "hanim11.wrl")
    surface = loaded.body.surface
    at_tip = np.flatnonzero(np.isclose(surface.vertices[:, 1], 1.8))
    (nod,) = loaded.body.displacers
    assert (nod.name, nod.joint, nod.weight) == ("nod_action", 1, 0.5)
    assert nod.vertices.tolist() == at_tip.tolist()
    np.testing.assert_allclose(nod.displacements, [[0, 0.05, 0]] * len(at_tip))
    corner = np.flatnonzero(np.isclose(surface.vertices, [0.1, 1.4, 0]).all(axis=1))[0]
    share = dict(zip(surface.joints[corner].tolist(), surface.weights[corner].tolist(), strict=True))
    assert share == {0: 0.25, 1: 0.5, 2: 0.25}  # what is left stays with the figure, whose number is 2
    assert "less than 1" in loaded.warnings[0]
    assert sorted(map(tuple, np.unique(surface.colours, axis=0).tolist())) == [(0, 0, 1), (1, 0, 0)]


def test_extern_protos_are_known_by_name_and_foreign_fields_kept():
    path = GOLDEN / "hanim_extern.wrl"
    loaded = open_file(path)
    assert [joint.name for joint in loaded.skeleton.joints] == ["HumanoidRoot", "l_hip", "l_knee"]
    scene = parse_scene(path.read_bytes())
    humanoid = next(value for _, value in scene.root.fields if isinstance(value, Node))
    joint = humanoid.get("humanoidBody")
    np.testing.assert_array_equal(joint.get("vendorAxis"), [0, 1, 0])
    assert (joint.get("another"), joint.get("third")) == ("text", True)


def test_a_robot_is_a_scene_but_no_figure():
    path = GOLDEN / "robot.wrl"
    assert parse_scene(path.read_bytes()).warnings == []
    with pytest.raises(FormatError, match="robot") as caught:
        open_file(path)
    assert caught.value.path == path
