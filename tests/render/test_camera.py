"""The camera's mathematics: what is under the mouse stays there, what is framed is seen, presets look right."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.render.camera import MAX_DISTANCE, PRESETS, Camera

ANGLES = st.floats(-3.0, 3.0)
CAMERAS = st.builds(
    Camera,
    target=st.tuples(*[st.floats(-5, 5)] * 3),
    distance=st.floats(0.3, 50),
    yaw=ANGLES,
    pitch=st.floats(-1.5, 1.5),
    orthographic=st.booleans(),
)
PLACES = st.floats(-0.9, 0.9)
ASPECT = 16 / 9


def on_screen(camera, points):
    """Project by the matrices, as the graphics card does."""
    matrix = camera.projection(ASPECT) @ camera.view()
    clip = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return clip[:, :3] / clip[:, 3:]


@given(CAMERAS, PLACES, PLACES)
def test_ray_through_a_place_projects_back_onto_it(camera, x, y):
    origin, direction = camera.ray(x, y, ASPECT)
    point = origin + camera.distance * direction
    np.testing.assert_allclose(camera.project(point, ASPECT), [[x, y]], atol=1e-7)
    np.testing.assert_allclose(on_screen(camera, point[None])[0, :2], (x, y), atol=1e-6)


@given(CAMERAS, PLACES, PLACES, st.floats(0.5, 2.0))
def test_zoom_keeps_what_is_under_the_mouse(camera, x, y, factor):
    under = np.array(camera.target) + camera.half_height * (x * ASPECT * camera.right + y * camera.up)
    nearer = camera.zoom(factor, (x * ASPECT, y))
    np.testing.assert_allclose(nearer.project(under, ASPECT), [[x, y]], atol=1e-6)
    assert nearer.distance == pytest.approx(camera.distance / factor)


@given(CAMERAS, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_pan_moves_the_target_by_the_drag(camera, right, up):
    moved = camera.pan(right, up).project(np.array(camera.target), ASPECT)
    np.testing.assert_allclose(moved, [[2 * right / ASPECT, 2 * up]], atol=1e-6)


@given(CAMERAS, st.lists(st.tuples(*[st.floats(-3, 3)] * 3), min_size=1, max_size=12), st.floats(0.4, 2.5))
def test_framed_points_are_all_in_the_picture(camera, points, aspect):
    seen = camera.frame(points, aspect).project(points, aspect)
    assert np.abs(seen).max() <= 1.0


def test_frame_of_nothing_or_of_no_numbers_stays():
    camera = Camera()
    assert camera.frame(np.zeros((0, 3)), 1.0) == camera
    assert camera.frame([[np.nan, 0, 0]], 1.0) == camera


@pytest.mark.parametrize(
    ("name", "right", "towards"),
    [("front", (1, 0, 0), (0, 0, 1)), ("side", (0, 0, -1), (1, 0, 0)), ("right", (0, 0, 1), (-1, 0, 0)),
     ("top", (1, 0, 0), (0, 1, 0)), ("back", (-1, 0, 0), (0, 0, -1))],
)  # fmt: skip
def test_preset_looks_where_its_name_says(name, right, towards):
    camera = Camera().preset(name)
    np.testing.assert_allclose(camera.right, right, atol=1e-9)
    np.testing.assert_allclose(camera.backward, towards, atol=2e-3)


@given(CAMERAS)
def test_frame_is_orthonormal_and_depth_is_within_the_planes(camera):
    rotation = camera.view()[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1)
    depth = on_screen(camera, np.array([camera.target]))[0, 2]
    assert -1 < depth < 1
    near, far = camera.clip_planes(5.0)
    assert near < camera.distance < far


@given(CAMERAS, ANGLES, ANGLES)
def test_orbit_keeps_target_and_distance_and_never_turns_over(camera, right, up):
    turned = camera.orbit(right, up)
    assert turned.target == camera.target
    assert abs(turned.pitch) < math.pi / 2
    assert turned.up[1] > 0
    assert np.linalg.norm(turned.eye - camera.target) == pytest.approx(camera.distance)


@given(CAMERAS, CAMERAS)
def test_glide_arrives_and_never_leaves_the_way(start, goal):
    assert start.towards(goal, 1.0) == goal
    half = start.towards(goal, 0.5)
    assert min(start.distance, goal.distance) * 0.999 <= half.distance <= max(start.distance, goal.distance) * 1.001
    assert start.towards(goal, 1 - 1e-9).is_near(goal) or start.distance == goal.distance


def test_orthographic_shows_at_the_target_what_perspective_does():
    point = np.array(Camera().target) + 0.3 * Camera().right
    flat = Camera(orthographic=True)
    np.testing.assert_allclose(flat.project(point, ASPECT), Camera().project(point, ASPECT), atol=1e-9)


def test_zoom_has_an_end():
    assert Camera().zoom(1e-9).distance == MAX_DISTANCE
    assert Camera().zoom(1e9).distance > 0
    assert set(PRESETS) >= {"front", "side", "top"}
