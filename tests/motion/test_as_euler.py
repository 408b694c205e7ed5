"""A motion in joint channels moves every node exactly as it moved before."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.motion.as_euler import as_euler, euler_zyx
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.channels import has_channels
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.rotation import euler_matrix
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind


def matrix(*angles):
    return tuple(tuple(row) for row in euler_matrix(np.array(angles), "zyx").tolist())


def tilted_skeleton():
    """Bones with axes of their own, children out of depth-first order, a slider, and signs, as ASF and others have."""
    return Skeleton(
        name="tilted",
        kind=SkeletonKind.ASF,
        joints=(
            Joint("root", -1, (0.1, 0.9, 0.0), product=(5, 4, 3), orientation=matrix(0.3, -0.2, 0.1)),
            Joint("left", 0, (0.2, 0.0, 0.1), product=(6,), orientation=matrix(1.0, 0.5, -0.7)),
            Joint("right", 0, (-0.2, 0.0, 0.1), product=(8, 7), orientation=matrix(-1.0, 0.5, 0.7)),
            Joint("left foot", 1, (0.0, -0.4, 0.05), orientation=matrix(0.0, 1.2, 0.0)),
            Joint("right foot", 2, (0.0, -0.4, 0.0), product=(10,), orientation=matrix(0.4, 0.0, 0.9)),
        ),
        end_sites=(EndSite("right toe", 4, (0.0, 0.0, 0.2)), EndSite("left toe", 3, (0.0, 0.1, 0.2))),
        columns=(
            Column("tx", 0, ColumnKind.TRANSLATION, 0),
            Column("ty", 0, ColumnKind.TRANSLATION, 1, rest=0.9),
            Column("tz", 0, ColumnKind.TRANSLATION, 2, sign=-1),
            Column("rx", 0, ColumnKind.ROTATION, 0),
            Column("ry", 0, ColumnKind.ROTATION, 1),
            Column("rz", 0, ColumnKind.ROTATION, 2),
            Column("left rx", 1, ColumnKind.ROTATION, 0),
            Column("right ry", 2, ColumnKind.ROTATION, 1, sign=-1),
            Column("right rz", 2, ColumnKind.ROTATION, 2),
            Column("right foot slide", 4, ColumnKind.TRANSLATION, 1),
            Column("right foot rx", 4, ColumnKind.ROTATION, 0),
            Column("extra", 0, ColumnKind.OPAQUE, 0),
        ),
        points=(0, 1, 2, 3, 4, 5, 6),
    )


def largest_distance(before, after):
    """The largest distance in metres between nodes of the same name."""
    order = [after.skeleton.node_names.index(name) for name in before.skeleton.node_names]
    moved = node_positions(after.skeleton, after.X)[:, order]
    return np.linalg.norm(moved - node_positions(before.skeleton, before.X), axis=2).max()


@pytest.mark.parametrize("skeleton", [tilted_skeleton(), bap_skeleton()], ids=["tilted", "bap"])
def test_every_node_stays_where_it_was(skeleton):
    X = np.random.default_rng(5).uniform(-3, 3, (40, skeleton.n_columns))
    motion = Motion(skeleton, X, 30.0)
    euler = as_euler(motion)
    assert has_channels(euler.skeleton)
    assert sorted(euler.skeleton.node_names) == sorted(skeleton.node_names)
    assert largest_distance(motion, euler) < 1e-9


def test_a_motion_in_channels_already_moves_the_same_again():
    euler = as_euler(Motion(tilted_skeleton(), np.zeros((2, 12)), 30.0))
    again = as_euler(euler)
    assert again.skeleton.node_names == euler.skeleton.node_names
    assert largest_distance(euler, again) < 1e-12


angles = st.lists(
    st.tuples(*[st.sampled_from([0, np.pi / 2, -np.pi / 2]) | st.floats(-9, 9)] * 3), min_size=1, max_size=6
)


@settings(max_examples=150, deadline=None)
@given(angles)
def test_angles_give_the_rotation_back_even_at_the_gimbal_lock(triples):
    rotation = euler_matrix(np.array(triples), "zyx")
    np.testing.assert_allclose(euler_matrix(euler_zyx(rotation), "zyx"), rotation, atol=1e-8)


def test_each_triple_is_the_nearest_to_the_one_before():
    random = np.random.default_rng(3)
    for size in (0.05, 0.5, 2.0):
        rotation = euler_matrix(np.cumsum(random.normal(0, size, (300, 3)), axis=0), "zyx")
        found = euler_zyx(rotation)
        assert np.abs(found[0]).sum() <= np.abs(other_way(found[0], np.zeros(3))).sum()
        for before, angles in itertools.pairwise(found):
            assert np.abs(angles - before).max() <= np.pi + 1e-9
            assert np.abs(angles - before).sum() <= np.abs(other_way(angles, before) - before).sum() + 1e-9


def other_way(angles, near):
    other = np.array([angles[0] + np.pi, np.pi - angles[1], angles[2] + np.pi])
    return other - 2 * np.pi * np.round((other - near) / (2 * np.pi))


def test_angles_go_on_over_full_turns_and_past_the_lock():
    turning = np.linspace(0, 6 * np.pi, 200)
    given_angles = np.stack([turning, np.full(200, 0.4), -turning], axis=1)
    np.testing.assert_allclose(euler_zyx(euler_matrix(given_angles, "zyx")), given_angles, atol=1e-9)
    tumbling = np.stack([np.full(200, 0.3), turning + 0.01, np.full(200, 0.2)], axis=1)
    np.testing.assert_allclose(euler_zyx(euler_matrix(tumbling, "zyx")), tumbling, atol=1e-6)
