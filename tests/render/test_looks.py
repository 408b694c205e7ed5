"""The renderer's skinning, looks, shadow and picking, each against something worked out another way."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from qmd_studio.arrays import FloatArray
from qmd_studio.assets import resource
from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.avatar.skinning import skin_matrices, skinned
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.bap_ease import at_ease
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.skeleton import Joint, Skeleton, SkeletonKind
from qmd_studio.render.bones import bone_ends
from qmd_studio.render.camera import Camera
from qmd_studio.render.gl import palette_rows
from qmd_studio.render.heat import linear
from qmd_studio.render.mesh import Mesh, UniformBlock, influences
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.panes import Layout, Pane, panes_of
from qmd_studio.render.picking import pick
from qmd_studio.render.quality import LADDER, Quality
from qmd_studio.render.scene import Actor, Look, Scene, posed_vertices
from qmd_studio.render.segment_colours import segment_colours

SIZE = (320, 240)
ASPECT = SIZE[0] / SIZE[1]
PLAIN = LADDER[3]
BARE = {"show_ground": False, "show_axes": False}


@pytest.fixture(scope="module")
def offscreen():
    with OffscreenRenderer() as renderer:
        yield renderer


@pytest.fixture
def draw(offscreen):
    def picture(scene, camera, quality=PLAIN):
        return offscreen.picture(scene, camera, SIZE, quality=quality).astype(int)

    return picture


@pytest.fixture(scope="module")
def human():
    skeleton = bap_skeleton()
    return Actor(bone_body(skeleton), world_from_joint(skeleton, at_ease()[None])[0])


def framed(*actors: Actor) -> Camera:
    return Camera().preset("front").frame(Scene(actors).points(), ASPECT)


def tangled(n_influences: int, n_vertices: int = 200, seed: int = 5) -> Actor:
    """A cloud of triangles whose vertices follow so many joints at random, one of them the figure itself."""
    rng = np.random.default_rng(seed)
    n_joints = 20
    joints = tuple(Joint(f"j{k}", k - 1, (0.0, 0.1, 0.0)) for k in range(n_joints))
    skeleton = Skeleton("tangle", SkeletonKind.BVH, joints, (), (), (0,))
    follows = np.stack([rng.permutation(n_joints + 1)[:n_influences] for _ in range(n_vertices)])
    weights = rng.random((n_vertices, n_influences)).astype(np.float32)
    weights /= weights.sum(axis=1, keepdims=True)
    normals = rng.normal(size=(n_vertices, 3)).astype(np.float32)
    surface = Surface(
        rng.normal(size=(n_vertices, 3)).astype(np.float32),
        normals / np.linalg.norm(normals, axis=1, keepdims=True),
        np.arange(n_vertices // 3 * 3).reshape(-1, 3),
        np.ones((n_vertices, 3), np.float32),
        follows,
        weights,
    )
    displacers = tuple(
        Displacer(f"d{k}", 0, rng.choice(n_vertices, 30, replace=False), rng.normal(size=(30, 3)).astype(np.float32))
        for k in range(2)
    )
    bind = np.tile(np.eye(4), (n_joints, 1, 1))
    bind[:, :3, 3] = rng.normal(size=(n_joints, 3))
    world = bind.copy()
    world[:, :3, :3] += 0.5 * rng.normal(size=(n_joints, 3, 3))
    body = Body("tangle", skeleton, surface, bind, displacers=displacers)
    return Actor(body, world, morphs=np.array([0.7, -1.3]), world_from_figure=np.diag([1.0, -1.0, -1.0, 1.0]))


def fed_back(actor: Actor) -> tuple[FloatArray, FloatArray]:
    """The posed vertices and unit normals (V, 3) that the body's vertex shader itself works out."""
    from OpenGL import GL
    from OpenGL.raw.GL.VERSION.GL_1_5 import glGetBufferSubData as get_buffer

    surface = actor.body.surface
    mesh = Mesh(surface, actor.body.displacers)
    mesh.displace(actor.displacer_weights())
    head, rest = resource("shaders", "body.vert").read_text(encoding="utf-8").split("\n", 1)
    program, shader = GL.glCreateProgram(), GL.glCreateShader(GL.GL_VERTEX_SHADER)
    GL.glShaderSource(shader, f"{head}\n#define ROWS 120\n#define MARKS 40\n#define GROUPS {mesh.n_groups}\n{rest}")
    GL.glCompileShader(shader)
    GL.glAttachShader(program, shader)
    names = (ctypes.c_char_p * 2)(b"world", b"facing")
    GL.glTransformFeedbackVaryings(
        program, 2, ctypes.cast(names, ctypes.POINTER(ctypes.POINTER(GL.GLchar))), GL.GL_INTERLEAVED_ATTRIBS
    )
    GL.glLinkProgram(program)
    assert GL.glGetProgramiv(program, GL.GL_LINK_STATUS)
    GL.glUniformBlockBinding(program, GL.glGetUniformBlockIndex(program, "Palette"), 0)
    palette = UniformBlock(0, 120)
    palette.write(palette_rows(actor.skin_matrices()))
    n_vertices = len(surface.vertices)
    result = np.zeros((n_vertices, 6), np.float32)
    buffer = GL.glGenBuffers(1)
    GL.glBindBuffer(GL.GL_TRANSFORM_FEEDBACK_BUFFER, buffer)
    GL.glBufferData(GL.GL_TRANSFORM_FEEDBACK_BUFFER, result.nbytes, None, GL.GL_STREAM_READ)
    GL.glBindBufferBase(GL.GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer)
    GL.glUseProgram(program)
    GL.glBindVertexArray(mesh._array)
    GL.glEnable(GL.GL_RASTERIZER_DISCARD)
    GL.glBeginTransformFeedback(GL.GL_POINTS)
    GL.glDrawArrays(GL.GL_POINTS, 0, n_vertices)
    GL.glEndTransformFeedback()
    GL.glDisable(GL.GL_RASTERIZER_DISCARD)
    get_buffer(GL.GL_TRANSFORM_FEEDBACK_BUFFER, 0, result.nbytes, ctypes.c_void_p(result.ctypes.data))
    GL.glUseProgram(0)
    for thing in (mesh, palette):
        thing.release()
    GL.glDeleteBuffers(1, [buffer])
    GL.glDeleteProgram(program)
    normals = result[:, 3:].astype(np.float64)
    return result[:, :3].astype(np.float64), normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("n_influences", [1, 3, 4, 5, 8, 10, 12])
def test_shader_and_processor_skin_alike(offscreen, n_influences):
    offscreen._context.make_current()
    actor = tangled(n_influences)
    vertices, normals = fed_back(actor)
    body = actor.body
    wanted, turned = skinned(body.surface, actor.skin_matrices(), body.displacers, actor.displacer_weights())
    np.testing.assert_allclose(vertices, wanted, atol=2e-4)
    assert np.quantile(np.einsum("vi,vi->v", normals, turned), 0.01) > 0.999
    np.testing.assert_allclose(posed_vertices(actor), wanted)


def test_of_more_than_twelve_joints_the_strongest_are_followed():
    actor = tangled(16)
    joints, weights = influences(actor.body.surface)
    assert joints.shape == weights.shape == (200, 12)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6)
    given = actor.body.surface.weights
    for v in range(200):
        strongest = set(actor.body.surface.joints[v][np.argsort(-given[v])[:12]])
        assert set(joints[v]) == strongest


def test_displaced_vertices_move_in_the_picture_and_back(draw, human):
    surface = human.body.surface
    head = np.flatnonzero(surface.vertices[:, 1] > surface.vertices[:, 1].max() - 0.15)
    hat = Displacer("hat", 0, head, np.tile(np.float32([0, 0.25, 0]), (len(head), 1)))
    actor = replace(human, body=replace(human.body, displacers=(hat,)))
    camera = framed(human).zoom(0.7)
    plain, tall, again = (draw(Scene((replace(actor, morphs=np.array([w])),), **BARE), camera) for w in (0.0, 1.0, 0.0))
    sky = draw(Scene(**BARE), camera)

    def top(picture):
        return np.flatnonzero((np.abs(picture - sky).sum(axis=2) > 24).any(axis=1)).min()

    per_metre = SIZE[1] / 2 / camera.half_height
    assert top(plain) - top(tall) == pytest.approx(0.25 * per_metre, abs=2)
    np.testing.assert_array_equal(plain, again)
    both = draw(Scene((actor, replace(actor, morphs=np.array([1.0]))), **BARE), camera)
    assert top(both) == top(tall)  # one surface in two shapes


def test_skin_of_the_figure_itself_goes_with_the_figure():
    actor = tangled(1)
    own = replace(actor.body.surface, joints=np.full((200, 1), 20))
    body = replace(actor.body, surface=own, displacers=())
    posed = posed_vertices(replace(actor, body=body, morphs=None))
    np.testing.assert_allclose(posed, own.vertices * (1, -1, -1), atol=1e-6)
    assert len(skin_matrices(body, actor.world_from_joint)) == 21


def test_segments_that_touch_can_be_told_apart_by_the_colour_blind():
    body = bone_body(bap_skeleton())
    colours = segment_colours(body)
    assert colours.shape == (len(body.skeleton.joints) + 1, 3)
    # Vienot, Brettel and Mollon 1999: linear RGB to cones, the missing one filled in from the others, and back
    cones = np.array([[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]])
    red_blind = np.array([[0, 2.02344, -2.52581], [0, 1, 0], [0, 0, 1]])
    green_blind = np.array([[1, 0, 0], [0.494207, 0, 1.24827], [0, 0, 1]])
    for eye in (np.eye(3), red_blind, green_blind):
        seen = np.cbrt(np.clip(colours @ (np.linalg.inv(cones) @ eye @ cones).T, 0, 1))
        for index, joint in enumerate(body.skeleton.joints):
            if joint.parent >= 0:
                assert np.linalg.norm(seen[index] - seen[joint.parent]) > 0.12, joint.name


def test_segment_look_paints_each_joint_in_its_colour(draw, human):
    camera = framed(human)
    plain = draw(Scene((human,), **BARE), camera)
    painted = draw(Scene((replace(human, look=Look.SEGMENTS),), **BARE), camera)
    colours = segment_colours(human.body)
    names = [joint.name for joint in human.body.skeleton.joints]
    for knee, hip in (("l_knee", "l_hip"), ("r_knee", "r_hip")):
        middle = human.joint_positions()[[names.index(knee), names.index(hip)]].mean(axis=0)
        x, y = camera.project(middle, ASPECT)[0]
        row, column = int((1 - y) / 2 * SIZE[1]), int((x + 1) / 2 * SIZE[0])
        got = linear(painted[row, column] / 255)
        wanted = colours[names.index(hip)]
        assert got @ wanted / np.linalg.norm(got) / np.linalg.norm(wanted) > 0.93
        assert np.abs(plain - painted)[row, column].sum() > 40


def test_xray_shows_joints_over_the_skin_and_what_is_behind_it(draw, human):
    camera = framed(human)
    seen = replace(human, look=Look.XRAY)
    behind = human.world_from_joint.copy()
    behind[:, 2, 3] -= 1.0
    red = replace(human, world_from_joint=behind, tint=(0.9, 0.02, 0.02))
    alone, through = draw(Scene((seen,), **BARE), camera), draw(Scene((red, seen), **BARE), camera)
    assert (np.abs(through - alone).sum(axis=2) > 60).mean() > 0.02
    start, end, _ = bone_ends(seen)
    at = camera.project(np.concatenate([start, end]), ASPECT)
    rows, columns = ((1 - at[:, 1]) / 2 * SIZE[1]).astype(int), ((at[:, 0] + 1) / 2 * SIZE[0]).astype(int)
    solid = draw(Scene((human,), **BARE), camera)
    changed = np.abs(alone - solid).sum(axis=2)[rows, columns]
    assert np.median(changed) > 120


def test_wireframe_has_edges_on_the_same_outline(draw, human):
    camera = framed(human).zoom(3)
    sky, solid, wire = (
        draw(Scene(actors, **BARE), camera) for actors in ((), (human,), (replace(human, look=Look.WIRE),))
    )
    covered, wired = (np.abs(p - sky).sum(axis=2) > 24 for p in (solid, wire))
    assert (covered != wired).mean() < 0.01
    grain = [np.abs(np.diff(p.sum(axis=2), axis=1))[covered[:, 1:]].mean() for p in (solid, wire)]
    assert grain[1] > 3 * grain[0]


def test_sun_throws_a_shadow_on_the_ground_away_from_it_and_on_the_body(draw, human):
    camera = Camera(target=(0.3, 0.3, -0.2), distance=6.0, pitch=0.6, yaw=0.0)
    sunny, soft = Quality(0, 1.0, False, shadow=512), Quality(0, 1.0, False)
    stage = {"show_axes": False}
    empty = draw(Scene(**stage), camera, sunny)
    darker = empty.sum(axis=2) - draw(Scene((human,), **stage), camera, sunny).sum(axis=2)

    def at(x, z):
        u, v = camera.project([x, 0.0, z], ASPECT)[0]
        return darker[int((1 - v) / 2 * SIZE[1]), int((u + 1) / 2 * SIZE[0])]

    assert at(0.6, -0.62) > 30  # where the line from the sun through the chest meets the ground
    assert abs(at(-0.8, 0.5)) < 9
    assert abs(at(0.9, 0.7)) < 9
    high = draw(Scene((human,), **BARE), framed(human), sunny)
    low = draw(Scene((human,), **BARE), framed(human), soft)
    assert np.abs(high - low).sum(axis=2).max() > 2
    assert np.abs(high - low).mean() < 12


@pytest.mark.parametrize("look", list(Look))
def test_numbers_under_the_mouse_agree_with_rays_through_the_skin(offscreen, human, look):
    other = human.world_from_joint.copy()
    other[:, 0, 3] += 0.8
    scene = Scene((replace(human, look=look), replace(human, world_from_joint=other, look=look, ghost=True)))
    camera = framed(*scene.actors)
    rng = np.random.default_rng(1)
    agreed = met = 0
    for x, y in rng.uniform((60, 10), (260, 230), (120, 2)).astype(int) + 0.5:
        hit = offscreen.pick(scene, camera, SIZE, (x, y))
        ray = pick(scene, *camera.ray(2 * x / SIZE[0] - 1, 1 - 2 * y / SIZE[1], ASPECT))
        if ray is None or hit is None:
            continue
        met += 1
        same = (hit.actor, hit.joint) == (ray.actor, ray.joint)
        assert hit.actor == ray.actor
        if look is not Look.XRAY:
            assert hit.distance == pytest.approx(ray.distance, rel=0.05)
        agreed += same
    assert met > 20
    assert agreed / met > (0.6 if look is Look.XRAY else 0.85)


def test_xray_picks_the_joint_that_is_drawn_on_top(offscreen, human):
    scene = Scene((replace(human, look=Look.XRAY),))
    camera = framed(human)
    names = [joint.name for joint in human.body.skeleton.joints]
    for name in ("l_knee", "r_shoulder", "l_elbow", "skullbase"):
        joint = names.index(name)
        x, y = camera.project(human.joint_positions()[joint], ASPECT)[0]
        assert offscreen.pick(scene, camera, SIZE, ((x + 1) / 2 * SIZE[0], (1 - y) / 2 * SIZE[1])).joint == joint


def test_a_near_miss_meets_the_nearest_and_a_far_one_nothing(offscreen, human):
    scene, camera = Scene((human,)), framed(human)
    bare = offscreen.picture(Scene(backdrop=False, **BARE, actors=(human,)), camera, SIZE, quality=PLAIN)
    row = 120
    left = int(np.flatnonzero(bare[row, :, 3])[0])
    assert offscreen.pick(scene, camera, SIZE, (left - 1.5, row + 0.5)) is not None
    assert offscreen.pick(scene, camera, SIZE, (left - 6.5, row + 0.5)) is None


def test_pick_beside_each_other_names_the_side(offscreen, human):
    panes = panes_of(Scene((human, human)), Layout.BESIDE)
    camera = framed(human)
    for side in range(2):
        hit = offscreen.renderer.pick(panes, camera, (640, 240), (160 + 320 * side, 120))
        assert hit.actor == side
    assert offscreen.renderer.pick((Pane(Scene()),), camera, SIZE, (5, 5)) is None


def test_skin_without_heat_is_neither_seen_nor_met(offscreen, human):
    cold = replace(human, heat=np.full(len(human.body.skeleton.joints), np.nan), only_hot=True)
    assert offscreen.pick(Scene((cold,)), framed(human), SIZE, (160, 110)) is None
    hot = replace(cold, heat=np.ones(len(human.body.skeleton.joints)))
    assert offscreen.pick(Scene((hot,)), framed(human), SIZE, (160, 110)) is not None
