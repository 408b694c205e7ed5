"""The renderer by its pixels: bodies where they should be, ghosts that blend, marks that show, picks that agree."""

from __future__ import annotations

import numpy as np
import pytest

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.humanoid import Body, Surface
from qmd_studio.motion.skeleton import EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.render.camera import Camera
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.picking import pick
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Scene, posed_vertices

SIZE = (320, 240)
PLAIN = LADDER[3]
ASPECT = SIZE[0] / SIZE[1]
FRONT = Camera(target=(0.0, 1.0, 0.0), distance=3.5).preset("front")


def pillar() -> Body:
    """Two capsule-like joints, one over the other: "low" from 0.4 to 1 m, "high" from 1 to 1.6 m."""
    joints = (Joint("low", -1, (0.0, 0.4, 0.0)), Joint("high", 0, (0.0, 0.6, 0.0)))
    return bone_body(Skeleton("pillar", SkeletonKind.BVH, joints, (EndSite("top", 1, (0.0, 0.6, 0.0)),), (), (0, 1)))


def at(body: Body, x: float = 0.0) -> np.ndarray:
    world = body.bind.copy()
    world[:, 0, 3] += x
    return world


def pixel(x: float, y: float) -> tuple[int, int]:
    """Row and column of a place of the world at z = 0 in a picture through FRONT."""
    place = FRONT.project([x, y, 0.0], ASPECT)[0]
    return int((1 - place[1]) / 2 * SIZE[1]), int((place[0] + 1) / 2 * SIZE[0])


@pytest.fixture(scope="module")
def offscreen():
    with OffscreenRenderer() as renderer:
        yield renderer


@pytest.fixture
def draw(offscreen):
    def picture(scene, camera=FRONT, quality=PLAIN):
        return offscreen.picture(scene, camera, SIZE, quality=quality).astype(int)

    return picture


def differ(a, b, threshold=24):
    return np.abs(a - b).sum(axis=2) > threshold


BARE = {"show_ground": False, "show_axes": False}


def test_body_covers_its_outline_and_nothing_else(draw):
    body = pillar()
    covered = differ(draw(Scene((Actor(body, at(body)),), **BARE)), draw(Scene(**BARE)))
    vertices = body.surface.vertices
    places = FRONT.project(vertices, ASPECT)
    low = ((1 - places[:, 1].max()) / 2 * SIZE[1], (places[:, 0].min() + 1) / 2 * SIZE[0])
    high = ((1 - places[:, 1].min()) / 2 * SIZE[1], (places[:, 0].max() + 1) / 2 * SIZE[0])
    rows, columns = np.nonzero(covered)
    assert rows.min() == pytest.approx(low[0], abs=1.5)
    assert rows.max() == pytest.approx(high[0], abs=1.5)
    assert columns.min() == pytest.approx(low[1], abs=1.5)
    assert columns.max() == pytest.approx(high[1], abs=1.5)
    assert covered[pixel(0, 0.7)]
    assert covered[pixel(0, 1.3)]


def test_skin_follows_its_joints(draw):
    body = pillar()
    moved = at(body)
    moved[1, 0, 3] += 0.5
    picture, empty = draw(Scene((Actor(body, moved),), **BARE)), draw(Scene(**BARE))
    covered = differ(picture, empty)
    assert covered[pixel(0.5, 1.3)]
    assert covered[pixel(0.0, 0.7)]
    assert not covered[pixel(0.0, 1.35)]


def test_vertex_of_two_joints_goes_half_the_way(draw):
    body = pillar()
    surface = body.surface
    both = np.zeros_like(surface.joints)
    both[:, 1] = 1
    weights = np.zeros_like(surface.weights)
    weights[:, :2] = 0.5
    shared = Surface(surface.vertices, surface.normals, surface.faces, surface.colours, both, weights)
    body = Body("shared", body.skeleton, shared, body.bind)
    moved = at(body)
    moved[1, 0, 3] += 0.6
    covered = differ(draw(Scene((Actor(body, moved),), **BARE)), draw(Scene(**BARE)))
    assert covered[pixel(0.3, 1.3)]
    assert not covered[pixel(0.0, 1.3)]
    np.testing.assert_allclose(posed_vertices(Actor(body, moved))[:, 0], surface.vertices[:, 0] + 0.3, atol=1e-5)


def test_ghost_lets_the_body_behind_it_show(draw):
    body = pillar()
    behind = at(body)
    behind[:, 2, 3] -= 0.5
    stage = {"dark": True, **BARE}
    red, ghost = Actor(body, behind, tint=(0.9, 0.05, 0.05)), Actor(body, at(body), ghost=True)
    red_alone, ghost_alone, both, solid = (
        draw(Scene(actors, **stage))[pixel(0, 1.3)]
        for actors in ((red,), (ghost,), (red, ghost), (red, Actor(body, at(body), tint=(0.015, 0.26, 0.85))))
    )
    assert ghost_alone[0] + 20 < both[0] < red_alone[0] - 20
    assert red_alone[2] + 20 < both[2]
    assert solid[0] < both[0]


@pytest.mark.parametrize("apart_m", [0.0, 0.002])
def test_ghost_that_agrees_with_its_original_leaves_it_unspoiled(draw, apart_m):
    body = pillar()
    beside = at(body)
    beside[:, 2, 3] += apart_m
    original = Actor(body, at(body))
    alone = draw(Scene((original,), **BARE))
    assert not differ(alone, draw(Scene((original, Actor(body, beside, ghost=True)), **BARE)))[pixel(0, 1.3)]
    beside[:, 2, 3] += 0.03
    assert differ(alone, draw(Scene((original, Actor(body, beside, ghost=True)), **BARE)))[pixel(0, 1.3)]


def test_ghost_shows_only_its_nearest_skin(draw):
    body = pillar()
    once = draw(Scene((Actor(body, at(body), ghost=True),), **BARE))
    turned = Surface(
        body.surface.vertices,
        body.surface.normals,
        body.surface.faces[::-1],
        body.surface.colours,
        body.surface.joints,
        body.surface.weights,
    )
    again = draw(Scene((Actor(Body("b", body.skeleton, turned, body.bind), at(body), ghost=True),), **BARE))
    assert np.abs(once - again).max() <= 3


def test_selected_joint_stands_out_and_the_other_does_not(draw):
    body = pillar()
    plain = draw(Scene((Actor(body, at(body)),), **BARE))
    marked = draw(Scene((Actor(body, at(body)),), selected=(0, 1), **BARE))
    assert differ(plain, marked)[pixel(0, 1.4)]
    assert not differ(plain, marked)[pixel(0, 0.6)]
    red, _, blue = marked[pixel(0, 1.4)]
    assert red > blue + 40


def test_heat_paints_each_joint_by_the_map_and_spares_the_unknown(draw):
    body = pillar()
    plain = draw(Scene((Actor(body, at(body)),), **BARE))
    hot = draw(Scene((Actor(body, at(body), heat=np.array([np.nan, 1.0])),), **BARE))
    cold = draw(Scene((Actor(body, at(body), heat=np.array([np.nan, 0.0])),), **BARE))
    assert not differ(plain, hot)[pixel(0, 0.6)]
    assert hot[pixel(0, 1.4)][0] > hot[pixel(0, 1.4)][2] + 60
    assert cold[pixel(0, 1.4)][2] > cold[pixel(0, 1.4)][0]


def test_ground_has_lines_and_a_shadow_under_the_body(draw):
    camera = Camera(target=(0.0, 0.4, 0.0), distance=5.0, pitch=0.5, yaw=0.0)
    body = pillar()
    bare = draw(Scene(show_ground=False, show_axes=False), camera)
    ground = draw(Scene(show_axes=False), camera)
    assert 0.01 < differ(ground, bare).mean() < 0.5
    standing = at(body)
    standing[:, 1, 3] -= 0.35
    shaded = draw(Scene((Actor(body, standing),), show_axes=False), camera)
    place = camera.project([0.10, 0.0, -0.08], ASPECT)[0]
    row, column = int((1 - place[1]) / 2 * SIZE[1]), int((place[0] + 1) / 2 * SIZE[0])
    assert shaded[row, column].sum() < ground[row, column].sum() - 12
    ghostly = draw(Scene((Actor(body, standing, ghost=True),), show_axes=False), camera)
    assert abs(int(ghostly[row, column].sum()) - int(ground[row, column].sum())) < 4


def test_dark_stage_is_dark(draw):
    assert draw(Scene(dark=True)).mean() < 70 < 160 < draw(Scene()).mean()


@pytest.mark.parametrize("quality", LADDER, ids=lambda q: f"{q.samples} samples {q.scale}")
def test_every_quality_shows_the_same_picture(draw, quality):
    body = pillar()
    scene = Scene((Actor(body, at(body)),))
    best, other = draw(scene, quality=LADDER[1]), draw(scene, quality=quality)
    assert np.abs(best - other).mean() < 4


def test_drawing_twice_is_the_same_to_the_bit(draw):
    body = pillar()
    scene = Scene((Actor(body, at(body)),), selected=(0, 0))
    np.testing.assert_array_equal(draw(scene), draw(scene))


def test_pick_agrees_with_what_is_drawn(draw):
    body = pillar()
    shift = at(body)
    shift[1, 0, 3] += 0.2
    scene = Scene((Actor(body, shift),), **BARE)
    covered = differ(draw(scene), draw(Scene(**BARE)), threshold=12)
    disagree = total = 0
    for row in range(4, SIZE[1], 7):
        for column in range(100, 220, 5):
            x, y = 2 * (column + 0.5) / SIZE[0] - 1, 1 - 2 * (row + 0.5) / SIZE[1]
            hit = pick(scene, *FRONT.ray(x, y, ASPECT))
            disagree += (hit is not None) != bool(covered[row, column])
            total += 1
    assert disagree / total < 0.01


def test_pick_names_the_nearest_joint():
    body = pillar()
    behind = at(body)
    behind[:, 2, 3] -= 1.0
    scene = Scene((Actor(body, behind), Actor(body, at(body))))
    low = pick(scene, *FRONT.ray(*FRONT.project([0, 0.7, 0], ASPECT)[0], ASPECT))
    high = pick(scene, *FRONT.ray(*FRONT.project([0, 1.3, 0], ASPECT)[0], ASPECT))
    assert (low.actor, low.joint) == (1, 0)
    assert (high.actor, high.joint) == (1, 1)
    assert high.distance == pytest.approx(3.5, abs=0.15)
    assert pick(scene, *FRONT.ray(0.95, 0.9, ASPECT)) is None


def test_too_many_joints_are_refused_with_a_reason(draw):
    from qmd_studio.errors import FormatError

    joints = tuple(Joint(f"j{k}", k - 1, (0.0, 0.01, 0.0)) for k in range(1100))
    body = bone_body(Skeleton("long", SkeletonKind.BVH, joints, (), (), (0,)))
    with pytest.raises(FormatError, match="too many joints"):
        draw(Scene((Actor(body, body.bind),)))
