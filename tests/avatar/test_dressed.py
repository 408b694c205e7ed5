"""A motion wears the body that fits it, and else one of its own bones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from generated_motion import walker

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.dressed import dress
from qmd_studio.avatar.humanoid import Displacer
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import world_from_joint


def test_body_with_the_motions_joints_is_worn_with_its_own_bones():
    motion = walker(4)
    body = bone_body(motion.skeleton.scaled(1.5))
    dressed = dress(motion, body)
    assert (dressed.body, dressed.note) == (body, "")
    np.testing.assert_array_equal(dressed.poses([2, 3]), world_from_joint(body.skeleton, motion.X[2:4]))


def test_body_of_other_joints_is_not_worn_and_the_note_says_so():
    motion = walker(3)
    dressed = dress(motion, bone_body(bap_skeleton()))
    assert dressed.body.skeleton == motion.skeleton
    assert "other joints" in dressed.note
    assert dress(motion, None).note == ""


def test_displacers_take_the_motions_column_of_their_name_and_else_the_files_weight():
    motion = walker(3)
    column = motion.skeleton.columns[4].name
    displacers = tuple(
        Displacer(name, 0, np.array([0]), np.zeros((1, 3), np.float32), 0.25) for name in (column, "smile")
    )
    dressed = dress(motion, replace(bone_body(motion.skeleton), displacers=displacers))
    np.testing.assert_array_equal(dressed.morphs(2), [motion.X[2, 4], 0.25])
