"""Turns about a joint's axes that make a rotation, against another library's and against trying all angles."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from qmd_studio.motion.joint_fit_kernels import fit, follow

FREE = (np.full(3, -1e12), np.full(3, 1e12))
THREE = ["".join(p) for p in permutations("xyz")] + ["xyx", "xzx", "yxy", "yzy", "zxz", "zyz"]


def fitted(matrix, axes, n, *, bone=(0.0, 0.0, 0.0), limits=FREE):
    angles = np.zeros(3)
    numbers = np.array(["xyz".index(a) for a in axes], dtype=np.int64)
    fit(matrix, n, numbers, np.array(bone, dtype=float), *limits, np.empty((2, 3, 3)), angles)
    return angles[:n]


def turned(axes, angles):
    return Rotation.from_euler(axes[: len(angles)].upper(), angles).as_matrix()


@pytest.mark.parametrize("axes", THREE)
def test_three_axes_hold_any_rotation(axes):
    for matrix in Rotation.random(40, random_state=1).as_matrix():
        np.testing.assert_allclose(turned(axes, fitted(matrix, axes, 3)), matrix, atol=1e-12)


@pytest.mark.parametrize("axes", THREE)
def test_three_axes_hold_rotations_where_two_of_them_agree(axes):
    for middle in (0.0, np.pi / 2, -np.pi / 2, np.pi):
        matrix = turned(axes, [0.3, middle, -0.8])
        np.testing.assert_allclose(turned(axes, fitted(matrix, axes, 3)), matrix, atol=1e-7)


def test_branch_within_the_limits_is_taken():
    limits = (np.array([-0.5, -3.1, -0.5]), np.array([0.5, 3.1, 0.5]))
    angles = fitted(turned("xyz", [0.2, 2.5, -0.3]), "xyz", 3, limits=limits)
    np.testing.assert_allclose(angles, [0.2, 2.5, -0.3], atol=1e-12)


@pytest.mark.parametrize("axes", ["yxy", "xyx", "zxz", "xzx"])
def test_two_axes_keep_the_way_of_the_bone(axes):
    random = np.random.default_rng(4)
    bone = 0.15 * random.normal(size=3)
    bone["xyz".index(axes[0])] = -1.0
    bone /= np.linalg.norm(bone)
    for _ in range(60):
        matrix = turned(axes, [random.uniform(-1.4, 1.4), random.uniform(0.6, 2.0), random.uniform(-1, 1)])
        shown = turned(axes, fitted(matrix, axes, 2, bone=bone)) @ bone
        reachable = np.hypot(bone["xyz".index(axes[0])], bone[3 - "xyz".index(axes[0]) - "xyz".index(axes[1])])
        if abs((matrix @ bone)["xyz".index(axes[0])]) < reachable:
            assert np.arccos(min(1.0, shown @ matrix @ bone)) < 2e-3


def test_two_axes_hold_what_they_made():
    for bend in (1e-3, 0.01, 0.3, 1.5):
        angles = fitted(turned("yx", [0.7, bend]), "yxy", 2, bone=(-0.01, -0.999, 0.03))
        np.testing.assert_allclose(angles, [0.7, bend], atol=1e-6)


def test_one_axis_is_the_nearest_turn():
    grid = np.linspace(-np.pi, np.pi, 20001)
    for matrix in Rotation.random(20, random_state=2).as_matrix():
        nearest = [np.trace(turned("y", [a]).T @ matrix) for a in grid]
        assert abs(grid[int(np.argmax(nearest))] - fitted(matrix, "y", 1)[0]) < 1e-3


@pytest.mark.parametrize("axes", ["xyz", "zyx", "yxy"])
def test_angles_go_on_without_jumps(axes):
    t = np.linspace(0, 1, 200)
    true = np.stack([9 * t, 0.9 * np.sin(12 * t), -7 * t], axis=1)
    true[:, 1] += 1.2 if axes == "yxy" else 0.3
    X = np.array([fitted(turned(axes, row), axes, 3) for row in true])
    numbers = np.array(["xyz".index(a) for a in axes], dtype=np.int64)
    follow(X, np.arange(3), np.ones(3, dtype=np.int64), numbers, *FREE, False)
    assert np.abs(np.diff(X, axis=0)).max() < 0.2
    for row, wanted in zip(X, true, strict=True):
        np.testing.assert_allclose(turned(axes, row), turned(axes, wanted), atol=1e-9)
