"""A motion whose file has another axis up is shown standing; one that only lies down is left lying."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from qmd_studio.avatar.upright import upright
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind
from tests.corpus import corpus_file


def motion_along(axis, first_turn=0.0):
    """A figure that rests along `axis` of its file and is turned about x by `first_turn` in its only frame."""
    up = np.eye(3)[axis]
    left = np.array([1.0, 0.0, 0.0])

    def place(height, aside=0.0):
        return tuple(float(v) for v in height * up + aside * left)

    joints = (
        Joint("Hips", -1, place(0.95), (0,)),
        Joint("Head", 0, place(0.68)),
        Joint("LeftUpLeg", 0, place(-0.04, 0.1)),
        Joint("LeftLeg", 2, place(-0.42)),
        Joint("LeftFoot", 3, place(-0.42)),
        Joint("RightUpLeg", 0, place(-0.04, -0.1)),
        Joint("RightLeg", 5, place(-0.42)),
        Joint("RightFoot", 6, place(-0.42)),
    )
    column = Column("Hips.Xrotation", 0, ColumnKind.ROTATION, 0)
    skeleton = Skeleton("figure", SkeletonKind.BVH, joints, (), (column,), tuple(range(8)))
    return Motion(skeleton, np.array([[first_turn]]), 30.0)


def test_figure_along_y_is_left_alone():
    np.testing.assert_array_equal(upright(motion_along(1)), np.eye(4))


def test_figure_along_z_is_stood_up():
    rotation = upright(motion_along(2))
    np.testing.assert_allclose(rotation[:3, :3] @ (0, 0, 1), (0, 1, 0), atol=1e-12)
    np.testing.assert_allclose(rotation[:3, :3] @ (1, 0, 0), (1, 0, 0), atol=1e-12)


def test_figure_that_lies_down_in_a_file_with_y_up_stays_lying():
    np.testing.assert_array_equal(upright(motion_along(1, first_turn=np.pi / 2)), np.eye(4))


def test_figure_whose_root_turns_it_up_is_left_alone():
    np.testing.assert_array_equal(upright(motion_along(2, first_turn=-np.pi / 2)), np.eye(4))


def test_figure_that_rests_along_y_but_stands_along_z_all_through_is_stood_up():
    standing = motion_along(1, first_turn=np.pi / 2)
    column = Column("Hips.Zposition", 0, ColumnKind.TRANSLATION, 2, rest=0.0)
    lift = Column("Hips.Yposition", 0, ColumnKind.TRANSLATION, 1, rest=0.95)
    skeleton = replace(standing.skeleton, columns=(*standing.skeleton.columns, column, lift))
    rotation = upright(Motion(skeleton, np.array([[np.pi / 2, 0.95, 0.0]] * 3), 30.0))
    np.testing.assert_allclose(rotation[:3, :3] @ (0, 0, 1), (0, 1, 0), atol=1e-12)
    once_risen = Motion(skeleton, np.array([[np.pi / 2, 0.95, 0.0], [0.0, 0.0, 0.95]]), 30.0)
    np.testing.assert_array_equal(upright(once_risen), np.eye(4))


@pytest.mark.corpus
@pytest.mark.parametrize(
    ("name", "turned"),
    [("bvh/pybvh_bvh_example.bvh", True), ("bvh/pybvh_bvh_test3.bvh", True), ("bvh/dme_example.bvh", False)],
)
def test_files_of_the_corpus(name, turned):
    from qmd_studio.registry import open_file

    assert bool((upright(open_file(corpus_file(name)).motion) != np.eye(4)).any()) is turned
