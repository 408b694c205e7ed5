"""X3D figures open as bodies, with their own joints only, and what is wrong or hostile in the XML is refused."""

import numpy as np
import pytest

from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.skeleton import SkeletonKind
from qmd_studio.registry import encode_motion, open_file
from tests.corpus import corpus_file, corpus_files
from tests.formats.damage import assert_ends_well

FIGURE = """<?xml version="1.0"?>
<X3D version='4.0'><Scene>
<Shape><IndexedFaceSet coordIndex='0 1 2'>
 <Coordinate DEF='SKIN' point='0 0 0, 1 0 0, 1 2 0, 0 2 0'/></IndexedFaceSet></Shape>
<HAnimHumanoid name='Ann' scale='0.5 0.5 0.5'>
 <HAnimJoint DEF='R' name='humanoid_root' center='0 1 0' containerField='skeleton' translation='0 0.2 0'
   skinCoordIndex='0 1 9 -1' skinCoordWeight='1 0.5'>
  <HAnimSegment name='sacrum'><Transform translation='0 1 0'><Shape>
    <Appearance><Material diffuseColor='1 0 0.5'/></Appearance>
    <IndexedFaceSet DEF='BOX' creaseAngle='3' coordIndex='0, 1, 2, 3, -1 0 3 2'>
     <Coordinate point='0 0 0, 1 0 0, 1 1 0, 0 1 0'/></IndexedFaceSet></Shape></Transform></HAnimSegment>
  <HAnimJoint name='l_elbow' center='0 2 0' rotation='0 0 2 1.5' skinCoordIndex='1 2' skinCoordWeight='0.5'>
   <HAnimSegment><HAnimSite name='l_hand_tip' translation='0 3 0'/><Shape><IndexedFaceSet USE='BOX'/></Shape>
   <Shape><Text/></Shape></HAnimSegment>
  </HAnimJoint>
 </HAnimJoint>
 <HAnimJoint USE='R' containerField='joints'/>
 <HAnimPose><HAnimJoint name='l_elbow' rotation='1 0 0 1'/></HAnimPose>
 <Coordinate USE='SKIN' containerField='skinCoord'/>
 <Group containerField='skin'><Shape>
  <IndexedFaceSet coordIndex='0 1 2 3'><Coordinate USE='SKIN'/></IndexedFaceSet></Shape></Group>
</HAnimHumanoid></Scene></X3D>
"""


def read(data, **options):
    return read_figure(data if isinstance(data, bytes) else data.encode(), ReadOptions(**options))


def test_a_figure_has_its_joints_in_metres_and_its_pose():
    loaded = read(FIGURE)
    skeleton = loaded.skeleton
    assert skeleton.kind is SkeletonKind.HANIM
    assert [joint.name for joint in skeleton.joints] == ["humanoid_root", "l_elbow"]
    names = [column.name.split()[1] for column in skeleton.columns]
    assert names == ["tx", "ty", "tz", "rx", "ry", "rz", "rx", "ry", "rz"]
    assert [column.level for column in skeleton.columns[6:]] == [5, 5, 5]
    np.testing.assert_allclose(
        node_positions(skeleton, rest_values(skeleton)[None])[0], [[0, 0.5, 0], [0, 1, 0], [0, 1.5, 0]]
    )
    # The root moves by half of 0.2, the elbow turns about z, and the hand's tip with it.
    posed = node_positions(skeleton, loaded.motion.X)[0]
    np.testing.assert_allclose(posed[2], [-0.5 * np.sin(1.5), 1.1 + 0.5 * np.cos(1.5), 0], atol=1e-12)


def test_meshes_follow_their_joints():
    surface = read(FIGURE).body.surface
    assert len(surface.vertices) == 4 + 4 + 6  # two shared quads, and the flat skin's two triangles
    assert surface.faces.max() == len(surface.vertices) - 1
    np.testing.assert_allclose(surface.colours[0], [1, 0, 0.5**2.2], rtol=1e-6)
    np.testing.assert_allclose(surface.vertices[2], [0.5, 1, 0])
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1, rtol=1e-6)
    np.testing.assert_array_equal(surface.joints[:8, 0], [0] * 4 + [1] * 4)
    np.testing.assert_allclose(surface.weights.sum(axis=1), 1, rtol=1e-6)


def test_the_skin_is_shared_by_joints_as_the_file_says():
    surface = read(FIGURE).body.surface
    share = {}
    for vertex, joints, weights in zip(surface.vertices[8:], surface.joints[8:], surface.weights[8:], strict=True):
        share[tuple(vertex.tolist())] = sum(w for joint, w in zip(joints, weights, strict=True) if joint == 1)
    assert share == {(0, 0, 0): 0, (0.5, 0, 0): 0.5, (0.5, 1, 0): 1, (0, 1, 0): 0}


def test_what_is_not_shown_is_said():
    assert any("Text" in note for note in read(FIGURE).notes)


def test_a_figure_in_inches_can_be_set():
    assert read(FIGURE, metres_per_unit=0.0254).skeleton.joints[1].offset[1] == pytest.approx(0.5 * 0.0254)


def scene(inside):
    return f"<X3D><Scene>{inside}</Scene></X3D>"


def segment(inside):
    joint = f"<HAnimJoint><HAnimSegment>{inside}</HAnimSegment></HAnimJoint>"
    return scene(f"<HAnimHumanoid>{joint}</HAnimHumanoid>")


def mesh(faces, name="S"):
    coordinate = "<Coordinate point='0 0 0 1 0 0 1 1 0'/>"
    return f"<Shape DEF='{name}'><IndexedFaceSet coordIndex='{faces}'>{coordinate}</IndexedFaceSet></Shape>"


def doubled(level):
    return f"<Group DEF='G{level}'><Group USE='G{level + 1}'/><Group USE='G{level + 1}'/></Group>"


def crowd(n_joints):
    return "<HAnimJoint DEF='R' name='humanoid_root'>" + "<HAnimJoint/>" * (n_joints - 1) + "</HAnimJoint>"


def followed_by_all(n_joints, n_points):
    weights = "<HAnimJoint skinCoordIndex='0 1 2' skinCoordWeight='1 1 1'/>" * (n_joints - 1)
    points = f"<Coordinate DEF='C' containerField='skinCoord' point='{'0 0 0 1 0 0 0 1 0 ' * (n_points // 3)}'/>"
    face = "<IndexedFaceSet coordIndex='0 1 2'><Coordinate USE='C'/></IndexedFaceSet>"
    joint = f"<HAnimJoint DEF='R' name='humanoid_root'>{weights}</HAnimJoint>"
    return scene(f"<HAnimHumanoid>{joint}{points}<Shape containerField='skin'>{face}</Shape></HAnimHumanoid>")


def driven_by_two_keys(cycle_s):
    return (
        f"<TimeSensor DEF='T' cycleInterval='{cycle_s}'/>"
        "<OrientationInterpolator DEF='O' key='0 1' keyValue='0 0 1 0 0 0 1 1'/>"
        "<ROUTE fromNode='T' fromField='fraction_changed' toNode='O' toField='set_fraction'/>"
        "<ROUTE fromNode='O' fromField='value_changed' toNode='R' toField='set_rotation'/>"
    )


HOSTILE = {
    "a long motion of one of many joints": scene(
        f"<HAnimHumanoid>{crowd(1900)}<HAnimMotion joints='humanoid_root' channels='1 Xrotation' "
        f"values='{'0 ' * 500_000}'/></HAnimHumanoid>"
    ),
    "thousands of boxes": segment("<Shape DEF='S'><Box/></Shape>" + "<Shape USE='S'/>" * 9000),
    "not x3d": "<html/>",
    "empty": scene(""),
    "no joints": scene("<HAnimHumanoid/>"),
    "entities": "<!DOCTYPE X3D [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]>" + scene("&b;"),
    "external": "<!DOCTYPE X3D [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>" + scene("&a;"),
    "deep": "<X3D>" + "<Group>" * 10_000 + "</Group>" * 10_000 + "</X3D>",
    "nan": scene("<HAnimHumanoid><HAnimJoint center='0 nan 0'/></HAnimHumanoid>"),
    "huge": scene(f"<HAnimHumanoid><HAnimJoint center='0 {'9' * 10**5} 0'/></HAnimHumanoid>"),
    "two numbers": scene("<HAnimHumanoid><HAnimJoint center='0 1'/></HAnimHumanoid>"),
    "uses itself": segment("<Group DEF='G'><Group USE='G'/></Group>"),
    "doubling": segment("".join(map(doubled, range(60)))),
    "copies": segment(mesh("0 1 2 -1 " * 4000) + "<Shape USE='S'/>" * 900),
    "bad face": segment(mesh("0 1 7")),
    "a joint in itself": scene("<HAnimHumanoid><HAnimJoint DEF='a'><HAnimJoint USE='a'/></HAnimJoint></HAnimHumanoid>"),
    "scales upon scales": segment("<Transform scale='1e9 1e9 1e9'>" * 40 + mesh("0 1 2") + "</Transform>" * 40),
    "a scale too much": segment(
        "<Transform scale='1e9 1 1'><Transform scale='1e4 1 1'>" + mesh("0 1 2") + "</Transform>" * 2
    ),
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_what_is_hostile_or_no_figure_is_refused(text):
    assert isinstance(assert_ends_well(read, text), FormatError)


def limited(fields):
    return read(scene(f"<HAnimHumanoid><HAnimJoint name='l_knee' {fields}/></HAnimHumanoid>"))


def test_limits_of_joints_are_taken_or_said():
    loaded = limited("llimit='-0.2 0 -1' ulimit='2.5 0 1'")
    turns = [column.limits for column in loaded.skeleton.columns if column.name.split()[-1].startswith("r")]
    assert turns == [(-0.2, 2.5), (0.0, 0.0), (-1.0, 1.0)]
    for fields in ("llimit='1 1 1' ulimit='0 0 0'", "llimit='-1 -1' ulimit='1 1'", "llimit='nan 0 0' ulimit='1 1 1'"):
        loaded = limited(fields)
        assert not any(column.limits for column in loaded.skeleton.columns)
        assert any("ulimit" in warning for warning in loaded.warnings), fields
    none = limited("llimit='0 0 0' ulimit='0 0 0'")
    assert not any(column.limits for column in none.skeleton.columns)
    assert not any("ulimit" in warning for warning in none.warnings)


@pytest.mark.parametrize(
    "text",
    [
        scene(f"<HAnimHumanoid>{crowd(1900)}</HAnimHumanoid>{driven_by_two_keys(900_000)}"),
        followed_by_all(1900, 60_000),
    ],
    ids=["two keys far apart", "points that all joints share"],
)
def test_what_asks_for_much_opens_in_little_memory(text):
    assert assert_ends_well(read, text).skeleton.joints[0].name == "humanoid_root"


@pytest.mark.corpus
def test_boxman_is_a_body():
    loaded = open_file(corpus_file("hanim/xite_BoxManC.x3d"))
    assert len(loaded.skeleton.joints) == 17
    body = loaded.body
    low, high = body.surface.vertices.min(axis=0), body.surface.vertices.max(axis=0)
    assert low[1] == pytest.approx(0, abs=0.02)
    assert 1.6 < high[1] < 1.9
    assert high[0] == pytest.approx(-low[0], abs=0.01)
    assert len(np.unique(body.surface.joints[body.surface.weights > 0])) == 17
    rest = world_from_joint(loaded.skeleton, rest_values(loaded.skeleton)[None])[0]
    np.testing.assert_allclose(rest, body.bind, atol=1e-12)


@pytest.mark.parametrize("name", ["xite_HAnimMotion.x3d", "xite_HAnimPose.x3d"])
@pytest.mark.corpus
def test_jin_has_her_own_joints_and_stands_in_her_pose(name):
    loaded = open_file(corpus_file(f"hanim/{name}"))
    assert len(loaded.skeleton.joints) == 18
    assert 1.4 < np.ptp(loaded.body.surface.vertices[:, 1]) < 1.8
    assert np.abs(loaded.motion.X).max() > 0.3
    again = open_file(corpus_file(f"hanim/{name}"))
    assert encode_motion(".bvh", again.motion).startswith(b"HIERARCHY\nROOT humanoid_root\n")


@pytest.mark.parametrize("path", corpus_files("hanim/*"))
def test_every_figure_of_the_corpus_opens_or_says_why_not(path):
    result = assert_ends_well(lambda _: open_file(path), b"")
    assert isinstance(result, FormatError) == (path.name == "castle_hanimmotion_containerfield.x3d")
