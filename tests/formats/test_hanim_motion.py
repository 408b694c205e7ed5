"""Motion in H-Anim files plays as the standard says: against a plain evaluation that shares nothing with the reader."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.skeleton import ColumnKind
from qmd_studio.registry import open_file
from tests.corpus import corpus_file
from tests.formats.plain_hanim import PlainFigure, numbers, skinned


def read(inside, after="", **options):
    text = f"<X3D><Scene><HAnimHumanoid DEF='H'>{inside}</HAnimHumanoid>{after}</Scene></X3D>"
    return read_figure(text.encode(), ReadOptions(**options))


def positions(loaded, frame):
    world = world_from_joint(loaded.skeleton, loaded.motion.X[frame : frame + 1])[0]
    return {joint.name: world[k, :3, 3] for k, joint in enumerate(loaded.skeleton.joints)}, world


TREE = (
    "<HAnimJoint DEF='R' name='humanoid_root' center='0 1 0' containerField='skeleton'>"
    "<HAnimJoint DEF='K' name='l_talocrural' center='0 2 0'><HAnimJoint DEF='E' name='end' center='0 3 0'/>"
    "</HAnimJoint></HAnimJoint>"
)
MOTION = "<HAnimMotion joints='HumanoidRoot IGNORED l_ankle' frameDuration='0.05' {} channels='{}' values='{}'/>"
CHANNELS = "3 Xposition Yposition Zposition 1 Xrotation 3 Zrotation Xrotation Yrotation"


@pytest.mark.corpus
def test_boxman_walks_as_his_interpolators_say():
    path = corpus_file("hanim/xite_BoxManC.x3d")
    loaded = open_file(path)
    plain = PlainFigure(path.read_text())
    assert (loaded.motion.n_frames, loaded.motion.fps) == (61, 30)
    skin = np.flatnonzero((loaded.body.surface.weights > 0).sum(axis=1) > 1)
    for frame in (0, 7, 29, 44, 60):
        turns, moves = plain.routed(frame / 60)
        expected, points = plain.pose(turns, moves)
        got, world = positions(loaded, frame)
        for name, place in expected.items():
            np.testing.assert_allclose(got[name], place, atol=1e-9)
        # each vertex that two joints share lies where a point of the plain skin does
        posed = skinned(loaded.body, world)[skin]
        gaps = np.linalg.norm(posed[:, None] - points[None], axis=2).min(axis=1)
        assert gaps.max() < 1e-6
    feet = np.array([positions(loaded, frame)[0]["l_ankle"] for frame in range(61)])
    assert np.ptp(feet[:, 2]) > 0.3  # he walks


@pytest.mark.corpus
def test_jin_moves_as_her_frames_say():
    path = corpus_file("hanim/xite_HAnimMotion.x3d")
    loaded = open_file(path)
    plain = PlainFigure(path.read_text())
    node = plain.root.find(".//HAnimMotion")
    table = numbers(node.get("values")).reshape(392, 57)
    old_names = {"HumanoidRoot": "humanoid_root"}
    assert (loaded.motion.n_frames, loaded.motion.fps) == (392, 10)
    for frame in (0, 100, 391):
        turns, moves = {}, {"humanoid_root": table[frame, :3]}
        for k, name in enumerate(node.get("joints").split()):
            if name != "IGNORED":
                angles = table[frame, 3 + 3 * k : 6 + 3 * k]
                turns[old_names.get(name, name)] = Rotation.from_euler("ZXY", angles, degrees=True)
        expected, _ = plain.pose(turns, moves)
        got, _ = positions(loaded, frame)
        for name, place in expected.items():
            np.testing.assert_allclose(got[name], place, atol=1e-6)


@pytest.mark.corpus
def test_jin_dances_on_a_floor():
    """Channels multiply in their listed order: in any other her lower foot would rise and sink by more than 30 mm."""
    loaded = open_file(corpus_file("hanim/xite_HAnimMotion.x3d"))
    names = [joint.name for joint in loaded.skeleton.joints]
    ankles = [names.index("l_talocrural"), names.index("r_talocrural")]
    height = world_from_joint(loaded.skeleton, loaded.motion.X)[:, ankles, 1, 3].min(axis=1)
    assert height.std() < 0.02
    assert any("above the ground" in note for note in loaded.notes)  # her heights are another figure's


def test_frames_name_joints_of_either_generation_and_ignore_some():
    loaded = read(TREE + MOTION.format("", CHANNELS, "1 2 3 9 0 0 0, 1 2 3 9 90 0 0"))
    assert (loaded.motion.n_frames, loaded.motion.fps) == (2, 20)
    np.testing.assert_allclose(positions(loaded, 0)[0]["end"], [1, 5, 3])
    np.testing.assert_allclose(positions(loaded, 1)[0]["end"], [0, 4, 3], atol=1e-12)


@pytest.mark.parametrize("flags", ["true false true true false true true", "TRUE, FALSE, TRUE, TRUE, FALSE"])
def test_channels_that_are_not_enabled_stay_at_rest(flags):
    motion = MOTION.format(f"channelsEnabled='{flags}'", CHANNELS, "1 2 3 9 90 0 0")
    np.testing.assert_allclose(positions(read(TREE + motion), 0)[0]["end"], [1, 3, 3], atol=1e-12)


def test_channels_are_enabled_by_flags_in_classic_vrml_too():
    text = """#X3D V4.0 utf8
    PROFILE Immersive
    HAnimHumanoid {
      skeleton [ HAnimJoint { name "humanoid_root" center 0 1 0 } ]
      motions [ HAnimMotion { joints "humanoid_root" channels "3 Xposition Yposition Zposition" values [ 1 2 3 ]
                              channelsEnabled [ TRUE FALSE TRUE ] } ]
    }"""
    loaded = read_figure(text.encode(), ReadOptions())
    np.testing.assert_allclose(loaded.motion.X[0, :3], [1, 1, 3])


def test_rotations_multiply_in_the_order_of_the_channels():
    loaded = read(TREE + MOTION.format("", CHANNELS, "0 0 0 0 30 40 50"))
    turn = Rotation.from_euler("ZXY", [30, 40, 50], degrees=True).as_matrix()
    np.testing.assert_allclose(positions(loaded, 0)[0]["end"], np.array([0, 2, 0]) + turn @ [0, 1, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("fields", "frames"),
    [("startFrame='1' endFrame='3'", [1, 2, 3]), ("frameIncrement='2'", [0, 2, 4]), ("frameIncrement='-1'", None)],
)
def test_the_frames_asked_for_are_played(fields, frames):
    values = " ".join(f"{k} 0 0 0 0 0 0" for k in range(5))
    loaded = read(TREE + MOTION.format(fields, CHANNELS, values))
    assert loaded.motion.X[:, 0].tolist() == (frames or [4, 3, 2, 1, 0])


def test_too_few_values_leave_the_figure_standing_and_say_so():
    loaded = read(TREE + MOTION.format("", CHANNELS, "1 2 3"))
    assert loaded.motion.n_frames == 1
    assert any("too few for a frame" in warning for warning in loaded.warnings)
    loaded = read(TREE + MOTION.format("", CHANNELS, "1 2 3 0 0 0 0 5"))
    assert loaded.motion.X[0, 0] == 1
    assert any("no multiple" in warning for warning in loaded.warnings)


def test_poses_follow_the_one_that_the_figure_stands_in_and_add_no_joint():
    poses = "<HAnimPose name='T'><HAnimJoint name='l_ankle' rotation='1 0 0 1.5708'/></HAnimPose><HAnimPose name='I'/>"
    loaded = read(TREE + poses)
    assert (len(loaded.skeleton.joints), loaded.motion.n_frames, loaded.motion.duration_s) == (3, 15, 3.0)
    ends = world_from_joint(loaded.skeleton, loaded.motion.X[[4, 5, 10]])[:, 2, :3, 3]
    np.testing.assert_allclose(ends, [[0, 3, 0], [0, 2, 1], [0, 3, 0]], atol=1e-4)
    assert any("T, I" in note for note in loaded.notes)


def test_poses_of_a_figure_that_moves_are_named():
    loaded = read(TREE + "<HAnimPose name='T'/>" + MOTION.format("", CHANNELS, "1 2 3 0 0 0 0"))
    assert loaded.motion.n_frames == 1
    assert any(note.endswith("T") for note in loaded.notes)


def routed(interpolator, target, clock="cycleInterval='2' loop='true'"):
    return (
        f"<TimeSensor DEF='C' {clock}/>{interpolator}"
        "<ROUTE fromNode='C' fromField='fraction_changed' toNode='I' toField='set_fraction'/>"
        f"<ROUTE fromNode='I' fromField='value_changed' toNode='{target[0]}' toField='{target[1]}'/>"
    )


def test_rotations_are_interpolated_the_short_way():
    keys = "<OrientationInterpolator DEF='I' key='0 1' keyValue='0 0 1 0.1 0 0 1 6.1831853'/>"
    loaded = read(TREE, routed(keys, ("K", "rotation")))
    column = [c.name for c in loaded.skeleton.columns].index("l_talocrural rz")
    assert loaded.motion.n_frames == 61
    assert np.abs(loaded.motion.X[:, column]).max() < 0.1001
    assert loaded.motion.X[30, column] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("name", ["translation", "set_translation"])
def test_joints_and_the_humanoid_itself_are_moved(name):
    keys = "<PositionInterpolator DEF='I' key='0 0.5 1' keyValue='0 0 0 4 0 0 0 0 0'/>"
    for target, ends in (("K", (0, 4)), ("R", (4, 4)), ("H", (4, 4))):
        loaded = read(TREE, routed(keys, (target, name)))
        places = positions(loaded, 30)[0]
        assert (places["humanoid_root"][0], places["end"][0]) == pytest.approx(ends)


def test_a_humanoid_that_turns_takes_its_root_along():
    keys = "<OrientationInterpolator DEF='I' key='0 1' keyValue='0 0 1 0 0 0 1 1.5707963'/>"
    loaded = read(TREE, routed(keys, ("H", "set_rotation")))
    np.testing.assert_allclose(positions(loaded, 60)[0]["end"], [-3, 0, 0], atol=1e-6)


def test_weights_of_displacers_are_columns_of_the_motion():
    tree = TREE.replace("<HAnimJoint DEF='E'", "<HAnimDisplacer DEF='D' name='smile'/><HAnimJoint DEF='E'")
    keys = "<ScalarInterpolator DEF='I' key='0 1' keyValue='0 0.5'/>"
    loaded = read(tree, routed(keys, ("D", "set_weight")))
    column = loaded.skeleton.columns[-1]
    assert (column.name, column.kind, column.joint) == ("smile", ColumnKind.OPAQUE, 1)
    np.testing.assert_allclose(loaded.motion.X[[0, 30, 60], -1], [0, 0.25, 0.5])


def test_routes_to_nothing_and_scripts_are_said():
    after = "<ROUTE fromNode='X' fromField='a' toNode='R' toField='rotation'/><Script/><TouchSensor/>"
    loaded = read(TREE, after)
    assert any("'X'" in warning for warning in loaded.warnings)
    assert "ignored: Script, TouchSensor" in loaded.notes
