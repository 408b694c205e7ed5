"""Acclaim motions written as BVH: every node in its place, and the angles that another exporter printed."""

import numpy as np
import pytest

from qmd_studio.formats import bvh
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.rotation import euler_matrix
from qmd_studio.registry import open_file
from tests.corpus import corpus_file

FILES = ["cmu_asfamc/02_01.amc", "cmu_asfamc/49_08.amc", "cmu_asfamc/60_01.amc", "other_asfamc/endorphin_walking.amc"]


def as_bvh(motion):
    return bvh.read(bvh.FORMAT.write(motion), ReadOptions(metres_per_unit=motion.skeleton.metres_per_unit)).motion


@pytest.mark.corpus
@pytest.mark.parametrize("name", FILES)
def test_an_amc_as_bvh_keeps_every_node_in_its_place(name):
    motion = open_file(corpus_file(name), companion(name)).motion
    written = as_bvh(motion)
    order = [written.skeleton.node_names.index(node) for node in motion.skeleton.node_names]
    moved = node_positions(written.skeleton, written.X)[:, order]
    np.testing.assert_allclose(moved, node_positions(motion.skeleton, motion.X), atol=1e-6)


def companion(name):
    skeleton = corpus_file("other_asfamc/endorphin_skeleton.asf") if "endorphin" in name else None
    return ReadOptions(skeleton=skeleton)


@pytest.mark.corpus
def test_an_amc_as_bvh_has_the_angles_of_its_twin():
    ours = as_bvh(open_file(corpus_file("cmu_asfamc/01_01.amc")).motion)
    twin = open_file(corpus_file("bvh/fairmotion_01_01.bvh")).motion
    assert twin.n_frames == ours.n_frames + 1  # the twin begins with a pose of its own
    pairs = {"root": "Hips", "lfemur": "LeftUpLeg", "ltibia": "LeftLeg", "rfoot": "RightFoot", "thorax": "Spine1"}
    pairs |= {"lhumerus": "LeftArm", "rradius": "RightForeArm", "head": "Head"}
    for joint, other in pairs.items():
        mine, theirs = (turns(motion, name) for motion, name in ((ours, joint), (twin, other)))
        np.testing.assert_allclose(mine, theirs[1:], atol=1e-4, err_msg=joint)


def turns(motion, joint):
    """The local rotations of a joint as matrices (n_frames, 9), free of the choice of angles."""
    angles = motion.X[:, list(motion.skeleton.joints[motion.skeleton.joint_index(joint)].product)]
    return euler_matrix(angles, "zyx").reshape(len(angles), 9)
