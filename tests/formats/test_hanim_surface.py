"""Surfaces of H-Anim figures: every geometry, colours, skins by the standard's formula, and what files do wrong."""

import warnings

import numpy as np
import pytest

from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_read import read_figure
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from tests.formats.plain_hanim import PlainFigure, skinned


def document(inside, fields=""):
    return f"<X3D><Scene><HAnimHumanoid {fields}>{inside}</HAnimHumanoid></Scene></X3D>"


def read(text, **options):
    return read_figure(text.encode(), ReadOptions(**options))


def in_segment(inside):
    joint = "<HAnimJoint DEF='J' name='humanoid_root' containerField='skeleton' center='0 1 0'>"
    listed = "<HAnimJoint USE='J' containerField='joints'/>"
    return document(f"{joint}<HAnimSegment>{inside}</HAnimSegment></HAnimJoint>{listed}")


def surface(inside):
    return read(in_segment(f"<Shape>{inside}</Shape>")).body.surface


def area_and_volume(mesh):
    a, b, c = (mesh.vertices.astype(float)[mesh.faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    return np.linalg.norm(cross, axis=1).sum() / 2, (a * cross).sum() / 6


@pytest.mark.parametrize(
    ("node", "volume", "share"),
    [
        ("<Box size='1 2 3'/>", 6, 1e-6),
        ("<Sphere radius='0.5'/>", np.pi / 6, 0.1),
        ("<Cylinder radius='0.5' height='3'/>", 0.75 * np.pi, 0.05),
        ("<Cone bottomRadius='0.5' height='3'/>", 0.25 * np.pi, 0.05),
    ],
)
def test_solids_are_closed_and_face_outwards(node, volume, share):
    mesh = surface(node)
    assert area_and_volume(mesh)[1] == pytest.approx(volume, rel=share)
    outward = (mesh.vertices * mesh.normals).sum(axis=1)
    assert (outward > 0).all()
    edges = {}
    places = [tuple(np.round(v, 5)) for v in mesh.vertices.tolist()]
    for face in mesh.faces.tolist():
        for k in range(3):
            edge = (places[face[k]], places[face[(k + 1) % 3]])
            edges[edge] = edges.get(edge, 0) + 1
    assert all(count == 1 and edges.get((b, a)) == 1 for (a, b), count in edges.items())


def test_parts_of_solids_can_be_left_off():
    whole = len(surface("<Cylinder/>").faces)
    assert len(surface("<Cylinder top='false' bottom='false'/>").faces) == whole - 32
    assert len(surface("<Cone side='false'/>").faces) == 16


POINTS = "<Coordinate point='0 0 0 1 0 0 0 1 0 1 1 0 0 2 0'/>"


@pytest.mark.parametrize(
    "node",
    [
        f"<IndexedFaceSet coordIndex='0 1 3 2 -1 2 3 4'>{POINTS}</IndexedFaceSet>",
        f"<IndexedFaceSet ccw='false' coordIndex='2 3 1 0 -1 4 3 2 -1'>{POINTS}</IndexedFaceSet>",
        f"<IndexedTriangleSet index='0 1 3 0 3 2 2 3 4'>{POINTS}</IndexedTriangleSet>",
        f"<IndexedTriangleStripSet index='0 1 2 3 4 -1'>{POINTS}</IndexedTriangleStripSet>",
        f"<TriangleStripSet stripCount='5'>{POINTS}</TriangleStripSet>",
        f"<IndexedTriangleFanSet index='3 4 2 0 1 -1'>{POINTS}</IndexedTriangleFanSet>",
        "<TriangleFanSet fanCount='5'><Coordinate point='1 1 0 0 2 0 0 1 0 0 0 0 1 0 0'/></TriangleFanSet>",
        "<TriangleSet><Coordinate point='0 0 0 1 0 0 1 1 0 0 0 0 1 1 0 0 1 0 0 1 0 1 1 0 0 2 0'/></TriangleSet>",
    ],
)
def test_every_face_set_covers_the_same_area_and_faces_forward(node):
    mesh = surface(node)
    assert area_and_volume(mesh)[0] == pytest.approx(1.5)
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * len(mesh.normals), atol=1e-6)


FACES = "<IndexedFaceSet coordIndex='0 1 2 -1 1 3 2 -1' creaseAngle='3' {}>{}{}</IndexedFaceSet>"
TWO = "<Color color='1 0 0 0 0 1'/>"


def test_colours_are_taken_by_face_and_by_vertex():
    by_face = surface(FACES.format("colorPerVertex='false'", POINTS, TWO))
    corner = by_face.colours[by_face.faces]
    np.testing.assert_allclose(corner, [[[1, 0, 0]] * 3, [[0, 0, 1]] * 3])
    picked = surface(FACES.format("colorPerVertex='false' colorIndex='1 0'", POINTS, TWO))
    np.testing.assert_allclose(picked.colours[picked.faces][0], [[0, 0, 1]] * 3)
    by_vertex = surface(FACES.format("colorIndex='0 1 0 -1 1 1 0 -1'", POINTS, TWO))
    assert len(by_vertex.vertices) == 4  # every point has one colour, so the mesh stays whole
    np.testing.assert_allclose(by_vertex.colours, [[1, 0, 0], [0, 0, 1], [1, 0, 0], [0, 0, 1]])
    rgba = "<ColorRGBA color='0.5 0.5 0.5 0.1  1 0 0 1  0 1 0 1  0 0 1 1  1 1 1 1'/>"
    np.testing.assert_allclose(surface(FACES.format("", POINTS, rgba)).colours[0], [0.5**2.2] * 3, rtol=1e-6)


def test_materials_of_every_kind_give_a_colour():
    for material in ("Material diffuseColor", "PhysicalMaterial baseColor", "UnlitMaterial emissiveColor"):
        node = f"<Appearance><{material}='0.5 0 1'/></Appearance><Box/>"
        np.testing.assert_allclose(surface(node).colours[0], [0.5**2.2, 0, 1], rtol=1e-6)


def test_normals_of_the_file_are_used():
    normal = "<Normal vector='0 3 4 0 0 1 0 0 1 0 1 0'/>"
    np.testing.assert_allclose(surface(FACES.format("", POINTS, normal)).normals[0], [0, 0.6, 0.8], rtol=1e-6)
    short_normal = "<Normal vector='0 0 1'/>"
    short = read(in_segment("<Shape>" + FACES.format("", POINTS, short_normal) + "</Shape>"))
    assert any("fewer entries" in warning for warning in short.warnings)
    np.testing.assert_allclose(short.body.surface.normals, [[0, 0, 1]] * 4, atol=1e-6)


def test_normals_beyond_all_numbers_are_reckoned_anew_and_said():
    # The length of such a vector overflows: that is for the warnings about the file, not for the terminal.
    normal = "<Normal vector='1e300 0 0 0 0 1 0 0 1 0 1 0'/>"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        loaded = read(in_segment("<Shape>" + FACES.format("", POINTS, normal) + "</Shape>"))
    assert any("no direction" in warning for warning in loaded.warnings)


def test_groups_transforms_switches_and_levels_are_walked():
    box = "<Shape><Box size='1 1 1'/></Shape>"
    inside = (
        f"<Group><Transform translation='5 0 0' scale='2 2 2'>{box}</Transform></Group>"
        f"<Switch whichChoice='1'><Group/><Transform translation='9 0 0'>{box}</Transform></Switch>"
        f"<Switch whichChoice='-1'>{box}</Switch>"
        f"<LOD><Transform translation='20 0 0'>{box}</Transform>{box}</LOD>"
    )
    vertices = read(in_segment(inside)).body.surface.vertices
    centres = sorted(vertices.reshape(3, -1, 3).mean(axis=1)[:, 0].tolist())
    np.testing.assert_allclose(centres, [5, 9, 20], atol=1e-6)


SKIN = "0 0 0, 1 0 0, 1 2 0, 0 2 0, .5 3 .5"


def figure(root="", arm="", *, humanoid="", skin=None, points=SKIN):
    shape = skin or "<Coordinate USE='P'/>"
    return document(
        f"<Coordinate DEF='P' containerField='skinCoord' point='{points}'/>"
        f"<HAnimJoint DEF='R' name='humanoid_root' containerField='skeleton' center='0.5 0.5 0' {root}>"
        f"<HAnimJoint DEF='A' name='arm' center='0.5 1.5 0.1' {arm}/></HAnimJoint>"
        "<HAnimJoint USE='R' containerField='joints'/><HAnimJoint USE='A' containerField='joints'/>"
        "<Shape containerField='skin'><IndexedFaceSet creaseAngle='3' coordIndex='0 1 2 3 -1 3 2 4 -1'>"
        f"{shape}</IndexedFaceSet></Shape>",
        humanoid,
    )


POSED = {
    "turned": ("rotation='1 2 3 0.7' skinCoordIndex='0 1 2' skinCoordWeight='1 1 .5'", "rotation='0 0 1 1.2'", ""),
    "moved": ("translation='1 2 3'", "translation='0 .5 0' rotation='1 1 0 -2'", ""),
    "scaled evenly": (
        "scale='2 2 2' rotation='0 1 0 1' skinCoordIndex='0 1 3'",
        "scale='3 3 3' rotation='1 0 0 1'",
        "",
    ),
    "scaled along axes, at rest": ("scale='1 2 1'", "scale='1 .5 3' scaleOrientation='0 0 1 .4'", ""),
    "humanoid turned": ("rotation='1 0 0 1'", "rotation='0 0 1 .5'", "rotation='0 1 0 1.1' translation='1 0 2'"),
    "humanoid in inches": ("rotation='1 0 0 1'", "translation='0 0 1'", "scale='.0254 .0254 .0254' center='0 1 0'"),
    "axes of any length": ("rotation='0 0 0 2'", "rotation='0 0 9 1.5'", ""),
}


@pytest.mark.parametrize("name", POSED)
def test_a_posed_skin_lies_where_the_formula_puts_it(name):
    root, arm, humanoid = POSED[name]
    if "skinCoordIndex" not in root:
        root += " skinCoordIndex='0 1 2 3' skinCoordWeight='1 1 .25 .5'"
    if name == "scaled evenly":
        arm += " skinCoordIndex='2 4'"  # what follows several joints at once is only nearly right
    else:
        arm += " skinCoordIndex='2 3 4' skinCoordWeight='.5 .5 1'"
    text = figure(root, arm, humanoid=humanoid)
    loaded = read(text, metres_per_unit=1)
    _, expected = PlainFigure(text).pose()
    world = world_from_joint(loaded.skeleton, loaded.motion.X)[0]
    body = loaded.body
    # what stays with the figure itself is at rest in the humanoid's space: the identity of the binding pose
    np.testing.assert_allclose(skinned(body, world), expected, atol=2e-6)
    rest = world_from_joint(loaded.skeleton, rest_values(loaded.skeleton)[None])[0]
    np.testing.assert_allclose(rest, body.bind, atol=1e-12)


def influences(loaded):
    weights = loaded.body.surface.weights
    table = np.zeros((len(weights), 3))
    for k in range(weights.shape[1]):
        np.add.at(table, (np.arange(len(weights)), loaded.body.surface.joints[:, k]), weights[:, k])
    return table


def warned(loaded, words):
    return any(words in warning for warning in loaded.warnings)


def test_weights_that_do_not_sum_to_one_are_put_right_and_said():
    loaded = read(figure("skinCoordIndex='0 1 2'", "skinCoordIndex='1 3' skinCoordWeight='3 .25'"))
    np.testing.assert_allclose(influences(loaded), [[1, 0, 0], [0.25, 0.75, 0], [1, 0, 0], [0, 0.25, 0.75], [0, 0, 1]])
    assert warned(loaded, "more than 1")
    assert warned(loaded, "less than 1")
    assert warned(loaded, "follow no joint")


def test_indices_out_of_range_are_left_out_and_said():
    loaded = read(figure("skinCoordIndex='0 1 2 3 4 99 -1' skinCoordWeight='1 1 1 1 1 1 1'"))
    np.testing.assert_allclose(influences(loaded), [[1, 0, 0]] * 5)
    assert warned(loaded, "2 skinCoordIndex are not among the 5 points")


def test_ten_joints_can_share_a_point():
    arms = "".join(
        f"<HAnimJoint name='j{k}' skinCoordIndex='0 1 2 3 4' skinCoordWeight='.1 .1 .1 .1 .1'/>" for k in range(10)
    )
    text = figure().replace("center='0.5 1.5 0.1' />", f"center='0.5 1.5 0.1'>{arms}</HAnimJoint>")
    loaded = read(text)
    assert loaded.body.surface.joints.shape == (5, 10)
    np.testing.assert_allclose(loaded.body.surface.weights.sum(axis=1), 1, rtol=1e-6)


def test_a_point_follows_the_strongest_of_too_many_joints_and_it_is_said():
    arms = "".join(
        f"<HAnimJoint name='j{k}' skinCoordIndex='0' skinCoordWeight='{0.5 if k == 20 else 0.01}'/>" for k in range(40)
    )
    loaded = read(figure().replace("center='0.5 1.5 0.1' />", f"center='0.5 1.5 0.1'>{arms}</HAnimJoint>"))
    surface, names = loaded.body.surface, [joint.name for joint in loaded.skeleton.joints]
    assert surface.joints.shape[1] <= 17  # the figure itself may have a share too
    assert surface.joints[0, 0] == names.index("j20")
    assert surface.weights[0].sum() == pytest.approx(1)
    assert warned(loaded, "strongest are kept")


def test_an_equal_copy_of_the_skins_points_is_taken_for_them_and_said():
    weights = "skinCoordIndex='0 1 2 3 4' skinCoordWeight='1 1 1 1 1'"
    copy = read(figure(weights, skin=f"<Coordinate point='{SKIN}'/>"))
    np.testing.assert_allclose(influences(copy), [[1, 0, 0]] * 5)
    assert warned(copy, "not that very node")
    other = read(figure(weights, skin=f"<Coordinate point='{SKIN.replace('3', '4')}'/>"))
    np.testing.assert_allclose(influences(other), [[0, 0, 1]] * 5)
    assert warned(other, "other points than skinCoord")


def test_points_that_are_not_finite_are_left_out_and_said():
    loaded = read(figure(points=SKIN.replace(".5 3", "nan 3")))
    assert len(loaded.body.surface.faces) == 2
    assert np.isfinite(loaded.body.surface.vertices).all()
    assert warned(loaded, "not finite")


def test_a_face_too_far_is_left_out_but_a_mesh_of_them_is_refused():
    one = read(in_segment("<Shape>" + FACES.replace("1 3 2", "1 3 9").format("", POINTS, "") + "</Shape>"))
    assert len(one.body.surface.faces) == 1
    assert warned(one, "does not exist")
    with pytest.raises(FormatError, match="does not exist"):
        read(in_segment(f"<Shape><IndexedFaceSet coordIndex='0 1 9'>{POINTS}</IndexedFaceSet></Shape>"))


def test_displacers_count_in_the_skins_points_and_in_their_segments():
    displacer = "<HAnimDisplacer name='raise' coordIndex='4 99' displacements='0 1 0 5 5 5' weight='.5'/>"
    end = "center='0.5 1.5 0.1' />"
    text = figure(humanoid="scale='2 2 2'").replace(end, end[:-2] + f">{displacer}</HAnimJoint>")
    (found,) = read(text, metres_per_unit=1).body.displacers
    assert (found.name, found.joint, found.weight, found.vertices.tolist()) == ("raise", 1, 0.5, [4])
    np.testing.assert_allclose(found.displacements, [[0, 2, 0]])
    inside = f"<Transform rotation='0 0 1 1.5707963'><Shape>{FACES.format('', POINTS, '')}</Shape></Transform>"
    smile = "<HAnimDisplacer coordIndex='1' displacements='1 0 0'/>"
    (found,) = read(in_segment(inside + smile)).body.displacers
    np.testing.assert_allclose(found.displacements, [[0, 1, 0]], atol=1e-6)


@pytest.mark.parametrize(("scale", "name"), [(100, "centimetre"), (39.37, "inch"), (1 / 0.0225, "0.0225")])
def test_the_unit_is_guessed_from_the_stature(scale, name):
    chain = "".join(
        f"<HAnimJoint name='j{k}' containerField='{'children' if k else 'skeleton'}' center='0 {scale * 0.34 * k} 0'>"
        for k in range(6)
    )
    loaded = read(document(chain + "</HAnimJoint>" * 6))
    top = world_from_joint(loaded.skeleton, rest_values(loaded.skeleton)[None])[0, -1, 1, 3]
    assert top == pytest.approx(1.7, rel=0.02)
    assert name in loaded.notes[0]
    assert warned(loaded, "lists no joints")
    set_unit = read(document(chain + "</HAnimJoint>" * 6), metres_per_unit=1)
    assert world_from_joint(set_unit.skeleton, set_unit.motion.X)[0, -1, 1, 3] == pytest.approx(scale * 1.7)


def test_a_skeleton_that_only_stands_in_the_list_is_found():
    text = document(
        "<HAnimJoint DEF='R' name='r' containerField='joints'>"
        "<HAnimJoint DEF='A' name='a' center='0 1 0'/></HAnimJoint>"
        "<HAnimJoint USE='A' containerField='joints'/>"
    )
    loaded = read(text)
    assert [(j.name, j.parent) for j in loaded.skeleton.joints] == [("r", -1), ("a", 0)]
    assert warned(loaded, "no skeleton")
