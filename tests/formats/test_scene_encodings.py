"""Scenes in XML, ClassicVRML and VRML97 come back as they were, and hostile or broken files end well."""

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from qmd_studio.errors import FormatError
from qmd_studio.formats.gzip_bytes import unpacked
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.formats.scene_file import parse_scene, write_scene
from qmd_studio.formats.scene_graph import MAX_DEPTH, Encoding, Is, Listed, Node, Proto, Use, same_scene
from tests.corpus import corpus_file, corpus_files
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged, watched

GOLDEN = Path(__file__).parent / "golden"
PROTO_FILES = sorted(GOLDEN.glob("*.wrl"))

XML = """<?xml version="1.0" encoding="UTF-8"?>
<X3D profile='Immersive' version='4.0'><head><component name='HAnim' level='1'/>
<unit category='length' name='inch' conversionFactor='0.0254'/><meta name='title' content='a "b" &lt;c&gt;'/></head>
<!-- made by hand -->
<Scene><ProtoDeclare name='Tip'><ProtoInterface>
<field name='size' type='SFFloat' accessType='inputOutput' value='2'/></ProtoInterface>
<ProtoBody><Sphere><IS><connect nodeField='radius' protoField='size'/></IS></Sphere></ProtoBody></ProtoDeclare>
<ExternProtoDeclare name='Far' url='"far.x3d" "b\\"c"'><field name='x' type='MFString' accessType='inputOnly'/>
</ExternProtoDeclare>
<HAnimHumanoid name='Ann' info='"a" "b c"'><HAnimJoint USE='J' containerField='joints'/>
<HAnimJoint DEF='J' name='humanoid_root' containerField='skeleton' center='0, 1e0 0' future='1 2'
 skinCoordIndex='0 1 2' skinCoordWeight='1 .5 .25'><HAnimSegment name='s'><ProtoInstance name='Tip' DEF='T'>
<fieldValue name='size' value='3'/></ProtoInstance><Shape><IndexedFaceSet coordIndex='0 1 2' solid='false'>
<Coordinate point='0 0 0 1 0 0 0 1 0'/></IndexedFaceSet></Shape></HAnimSegment></HAnimJoint></HAnimHumanoid>
<TimeSensor DEF='C' loop='true'/><Script DEF='S'><field name='f' type='SFBool' accessType='inputOnly'/>
<![CDATA[ecmascript: a < b]]></Script>
<ROUTE fromNode='C' fromField='isActive' toNode='S' toField='f'/></Scene></X3D>
"""
CLASSIC = """#X3D V3.3 utf8
# by hand
PROFILE Immersive COMPONENT HAnim:1 META "title" "a \\"b\\""
PROTO Tip [ inputOutput SFFloat size 2 initializeOnly MFNode extra [ Group { } ] inputOnly SFBool go ]
{ Sphere { radius IS size } }
EXTERNPROTO Far [ inputOnly MFString x ] [ "far.x3d", "b" ]
DEF H HAnimHumanoid { name "Ann" joints [ USE J ]
  skeleton DEF J HAnimJoint { center 0, 1 -0.5e-1 skinCoordIndex [ 0 1 2 ] future [ 1 2 ] other 0.5 third TRUE
    children [ HAnimSegment { name "s" children DEF T Tip { size 3 } } # here
      HAnimJoint { name "l_hip" rotation 0 1 0 .5 children NULL } ] } }
DEF C TimeSensor { loop TRUE }
DEF S Script { inputOnly SFFloat f directOutput TRUE url "javascript: a" }
ROUTE C.fraction_changed TO S.f
"""
SMALL = {"xml": XML.encode(), "classic": CLASSIC.encode(), "vrml97": (GOLDEN / "hanim11.wrl").read_bytes()}


def read(data):
    return read_figure(data, ReadOptions())


@pytest.mark.parametrize("name", SMALL)
def test_a_scene_comes_back_equal_in_its_own_encoding(name):
    scene = parse_scene(SMALL[name])
    again = parse_scene(write_scene(scene, scene.encoding))
    assert same_scene(scene, again)
    assert scene.warnings == []


@pytest.mark.parametrize("path", PROTO_FILES, ids=lambda path: path.stem)
def test_proto_files_come_back_equal(path):
    scene = parse_scene(path.read_bytes())
    assert scene.encoding is Encoding.VRML97
    assert same_scene(scene, parse_scene(write_scene(scene, Encoding.VRML97)))


@pytest.mark.parametrize("path", corpus_files("hanim/*") + corpus_files("mesh/castle_humanoid_pose.x3dv"))
def test_real_scenes_come_back_equal(path):
    scene = parse_scene(path.read_bytes())
    assert same_scene(scene, parse_scene(write_scene(scene, scene.encoding)))


@pytest.mark.corpus
@pytest.mark.parametrize("name", ["BoxManC", "HAnimMotion", "HAnimPose", "Displacers"])
def test_a_figure_is_the_same_in_the_other_encoding(name):
    scene = parse_scene(corpus_file(f"hanim/xite_{name}.x3d").read_bytes())
    one, other = (read(write_scene(scene, encoding)) for encoding in (Encoding.XML, Encoding.CLASSIC))
    assert one.skeleton == other.skeleton
    np.testing.assert_array_equal(one.motion.X, other.motion.X)
    if one.body is not None:
        np.testing.assert_array_equal(one.body.surface.vertices, other.body.surface.vertices)
        np.testing.assert_array_equal(one.body.surface.weights, other.body.surface.weights)


def test_equality_sees_a_copy_in_the_place_of_a_use():
    used = parse_scene(b"<X3D><Scene><Group DEF='a'/><Group USE='a'/></Scene></X3D>")
    copied = parse_scene(b"<X3D><Scene><Group DEF='a'/><Group DEF='a'/></Scene></X3D>")
    renumbered = parse_scene(b"<X3D><Scene><Group DEF='a' bboxSize='1 2 3'/><Group USE='a'/></Scene></X3D>")
    assert not same_scene(used, copied)
    assert not same_scene(used, renumbered)


def test_what_stands_in_a_scene_is_kept():
    scene = parse_scene(SMALL["classic"])
    (proto, far) = (value for _, value in scene.root.fields if isinstance(value, Proto))
    size = proto.interface[0]
    assert (size.access, size.type, size.name) == ("inputOutput", "SFFloat", "size")
    assert isinstance(proto.body.fields[0][1].get("radius"), Is)
    assert far.urls == ("far.x3d", "b")
    (humanoid,) = (value for _, value in scene.root.fields if isinstance(value, Node) and value.name == "H")
    joint = humanoid.get("skeleton")
    assert isinstance(humanoid.get("joints"), Use)
    assert humanoid.get("joints").node is joint
    assert isinstance(joint.get("future"), Listed)
    np.testing.assert_array_equal(joint.get("center"), [0, 1, -0.05])
    assert scene.comments == [" by hand"]
    assert parse_scene(SMALL["xml"]).units == [("length", "inch", "0.0254")]


@pytest.mark.parametrize("name", SMALL)
def test_every_prefix_ends_well(name):
    assert_every_prefix_ends_well(read, SMALL[name])


@pytest.mark.parametrize("name", SMALL)
def test_damage_ends_well(name):
    @settings(max_examples=150, deadline=None)
    @given(damaged(SMALL[name]))
    def check(data):
        assert_ends_well(read, data)

    check()


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("#X3D V3.3 utf8\nGroup {\n  children [ \\", "line 3, column 14"),
        ("#X3D V3.3 utf8\nGroup }", "line 2, column 7"),
        ('#VRML V2.0 utf8\n\n  "text"', "line 3, column 3"),
        ("#VRML V2.0 utf8\nROUTE a b", "line 2, column 9"),
        ("#VRML V2.0 utf8\nShape { geometry Box { 5 } }", "line 2, column 24"),
        ("<X3D><Scene></X3D>", "line 1, column 15"),
    ],
)
def test_an_error_has_line_and_column(text, place):
    with pytest.raises(FormatError) as caught:
        parse_scene(text.encode())
    assert caught.value.at == place


MANY = 1_000_000
HOSTILE = {
    "deep xml": b"<X3D><Scene>" + b"<Group>" * 10_000,
    "deep classic": b"#X3D V3.3 utf8\n" + b"Group { children [ " * 10_000,
    "deep protos": b"#VRML V2.0 utf8\n" + b"PROTO A [ ] { " * 10_000,
    "many xml": b"<X3D><Scene>" + b"<Group/>" * MANY + b"</Scene></X3D>",
    "many classic": b"#X3D V3.3 utf8\n" + b"Group {} " * MANY,
    "many fields": b"#X3D V3.3 utf8\nGroup {" + b"a 1 " * MANY + b"}",
    "cyclic xml": b"<X3D><Scene><Group DEF='a'><Group USE='a'/></Group></Scene></X3D>",
    "cyclic by two": b"<X3D><Scene><A DEF='a'><A USE='b'/></A><A DEF='b'><A USE='a'/></A></Scene></X3D>",
    "cyclic classic": b"#X3D V3.3 utf8\nDEF a Group { children [ Group { children USE a } ] }",
    "entities": b"<!DOCTYPE X3D [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]><X3D><Scene>&b;</Scene></X3D>",
    "external": b"<!DOCTYPE X3D [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><X3D><Scene>&a;</Scene></X3D>",
    "quote without end": b'#VRML V2.0 utf8\n"' + b'\\"' * MANY,
    "numbers that are none": b"#VRML V2.0 utf8\n A { b " + b"1e" * MANY,
    "zip bomb": gzip.compress(b"<X3D>" + b" " * (1 << 27)),
    "cut packing": gzip.compress(XML.encode())[:-40],
    "damaged packing": gzip.compress(XML.encode())[:60] + b"\x00" * 60,
    "not x3d": b"<html/>",
    "nothing": b"",
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_what_is_hostile_is_refused_soon_and_in_little_memory(data):
    with watched(cpu_seconds=2.0, extra_bytes=64 << 20), pytest.raises(FormatError):
        read(data)


def test_nesting_up_to_the_bound_is_written_and_read():
    inside = "<Group>" * (MAX_DEPTH - 4) + "</Group>" * (MAX_DEPTH - 4)
    scene = parse_scene(f"<X3D version='4.0'><Scene>{inside}</Scene></X3D>".encode())
    for encoding in Encoding:
        scene.version = "2.0" if encoding is Encoding.VRML97 else "4.0"
        assert same_scene(parse_scene(write_scene(scene, encoding)), scene)


def test_packing_is_bounded_by_what_it_may_hold():
    assert unpacked(gzip.compress(b"abc" * 1000)) == b"abc" * 1000
    assert unpacked(b"plain") == b"plain"
    with pytest.raises(FormatError, match="too much"):
        unpacked(gzip.compress(bytes(1000)), limit=999)
