"""Skinning on the processor against the formula, evaluated vertex by vertex."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.humanoid import Body, Displacer, Surface
from qmd_studio.avatar.skinning import displaced, rest_weights, skin_matrices, skinned
from qmd_studio.motion.bap import bap_skeleton

N_JOINTS = 5


def random_surface(rng, n_influences, n_vertices=24):
    weights = rng.random((n_vertices, n_influences)).astype(np.float32)
    weights[rng.random(weights.shape) < 0.3] = 0
    weights[:, 0] += 0.05
    weights /= weights.sum(axis=1, keepdims=True)
    normals = rng.normal(size=(n_vertices, 3))
    return Surface(
        rng.normal(size=(n_vertices, 3)).astype(np.float32),
        (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        rng.integers(0, n_vertices, (30, 3)),
        np.ones((n_vertices, 3), np.float32),
        rng.integers(0, N_JOINTS + 1, (n_vertices, n_influences)),
        weights,
    )


def random_matrices(rng):
    matrices = np.tile(np.eye(4), (N_JOINTS + 1, 1, 1))
    matrices[:N_JOINTS, :3, :3] += 0.4 * rng.normal(size=(N_JOINTS, 3, 3))
    matrices[:N_JOINTS, :3, 3] = rng.normal(size=(N_JOINTS, 3))
    return matrices


@given(st.integers(0, 2**32 - 1), st.integers(1, 13))
def test_every_vertex_and_normal_follows_the_formula(seed, n_influences):
    rng = np.random.default_rng(seed)
    surface, matrices = random_surface(rng, n_influences), random_matrices(rng)
    vertices, normals = skinned(surface, matrices)
    for v in range(len(vertices)):
        blend = sum(float(w) * matrices[j] for j, w in zip(surface.joints[v], surface.weights[v], strict=True))
        np.testing.assert_allclose(vertices[v], (blend @ [*surface.vertices[v], 1.0])[:3], atol=1e-6)
        if abs(np.linalg.det(blend[:3, :3])) < 1e-3:
            continue
        normal = np.linalg.inv(blend[:3, :3]).T @ surface.normals[v]
        np.testing.assert_allclose(normals[v], normal / np.linalg.norm(normal), atol=1e-5)


def test_a_body_in_its_binding_pose_is_its_surface_and_what_follows_no_joint_stays():
    body = bone_body(bap_skeleton())
    vertices, normals = skinned(body.surface, skin_matrices(body, body.bind))
    np.testing.assert_allclose(vertices, body.surface.vertices, atol=1e-6)
    assert np.einsum("vi,vi->v", normals, body.surface.normals).min() > 0.999
    moved = body.bind.copy()
    moved[:, :3, 3] += 5.0
    matrices = skin_matrices(body, moved)
    assert len(matrices) == len(body.skeleton.joints) + 1
    np.testing.assert_array_equal(matrices[-1], np.eye(4))
    np.testing.assert_array_equal(skin_matrices(body, moved, np.diag([2.0, 2, 2, 1]))[-1], np.diag([2.0, 2, 2, 1]))


def plate(n=9):
    """A level square of n × n vertices, 1 m wide, that looks up."""
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n))
    vertices = np.stack([x.ravel(), np.zeros(n * n), z.ravel()], axis=1).astype(np.float32)
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel()
    faces = np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    up = np.tile(np.float32([0, 1, 0]), (n * n, 1))
    return Surface(vertices, up, faces, np.ones_like(vertices), np.zeros((n * n, 1), int), np.ones((n * n, 1)))


def test_displacers_add_up_before_skinning():
    surface = plate()
    lift = Displacer("lift", 0, np.array([40, 41]), np.float32([[0, 0.1, 0], [0, 0.2, 0]]))
    push = Displacer("push", 0, np.array([41]), np.float32([[0.3, 0, 0]]), weight=0.5)
    turn = np.tile(np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), (2, 1, 1))
    vertices, _ = skinned(surface, turn, (lift, push), (2.0, 0.5))
    wanted = surface.vertices.astype(float)
    wanted[40] += (0, 0.2, 0)
    wanted[41] += (0.15, 0.4, 0)
    np.testing.assert_allclose(vertices, wanted @ turn[0, :3, :3].T, atol=1e-6)
    body = Body("b", bap_skeleton(), surface, np.eye(4)[None], displacers=(lift, push))
    np.testing.assert_array_equal(rest_weights(body), [0.0, 0.5])


def test_normals_lean_where_a_displacer_makes_a_slope_and_only_there():
    surface = plate()
    slope = Displacer("slope", 0, np.arange(81), surface.vertices * np.float32(0) + np.float32([0, 1, 0]))
    slope.displacements[:] *= surface.vertices[:, :1]  # y = x: a slope of 45 degrees
    _, normals = displaced(surface, (slope,), (1.0,))
    np.testing.assert_allclose(normals, np.tile([-(0.5**0.5), 0.5**0.5, 0], (81, 1)), atol=1e-6)
    _, normals = displaced(surface, (Displacer("one", 0, np.array([0]), np.float32([[0, 1, 0]])),), (1.0,))
    assert (normals[20:] == (0, 1, 0)).all()
    assert normals[0] @ (0, 1, 0) < 0.9


@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_the_surface_itself_is_never_changed(weight):
    surface = plate()
    before = surface.vertices.copy(), surface.normals.copy()
    displaced(surface, (Displacer("d", 0, np.array([3]), np.float32([[1, 1, 1]])),), (weight,))
    np.testing.assert_array_equal(surface.vertices, before[0])
    np.testing.assert_array_equal(surface.normals, before[1])
