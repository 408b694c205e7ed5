"""A motion wears any body that can follow it, and else one of its own bones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from generated_motion import walker

from qmd_studio import assets
from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.dressed import dress
from qmd_studio.avatar.humanoid import Displacer
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.joint_map import match_joints
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.retarget import retargeting
from qmd_studio.registry import open_body, open_file


def test_body_with_the_motions_joints_takes_its_poses_as_they_are():
    motion = walker(4)
    body = bone_body(motion.skeleton)
    dressed = dress(motion, body)
    assert (dressed.body, dressed.note) == (body, "")
    assert dress(motion, None).body.skeleton == motion.skeleton
    np.testing.assert_array_equal(dressed.poses([2, 3]), world_from_joint(body.skeleton, motion.X[2:4]))


def test_body_with_more_joints_carries_them_along_as_retargeting_does():
    motion, ada = open_file(assets.resource("motions", "wave.bap")).motion, open_body("ada").body
    dressed = dress(motion, ada)
    assert dressed.fit.way is None
    assert len(ada.skeleton.joints) > len(motion.skeleton.joints)
    frames = [0, 40, 90]
    source = world_from_joint(motion.skeleton, motion.X[frames])
    np.testing.assert_allclose(
        dressed.poses(frames), retargeting(motion.skeleton, ada.skeleton).pose(source), atol=1e-9
    )


def test_body_of_another_size_turns_as_the_motion_does_on_bones_of_its_own():
    motion = walker(4)
    dressed = dress(motion, bone_body(motion.skeleton.scaled(1.5)))
    source, worn = world_from_joint(motion.skeleton, motion.X), dressed.poses([0, 1, 2, 3])
    np.testing.assert_allclose(worn[..., :3, :3], source[..., :3, :3], atol=1e-6)
    bones = [(j, joint.parent) for j, joint in enumerate(motion.skeleton.joints) if joint.parent >= 0]
    for joint, parent in bones:
        ours = np.linalg.norm(worn[:, joint, :3, 3] - worn[:, parent, :3, 3], axis=1)
        theirs = np.linalg.norm(source[:, joint, :3, 3] - source[:, parent, :3, 3], axis=1)
        np.testing.assert_allclose(ours, 1.5 * theirs, atol=1e-9)


def test_joints_of_motion_and_body_find_each_other():
    motion = walker(3)
    worn = dress(motion, bone_body(bap_skeleton())).fit
    source = {joint.name: k for k, joint in enumerate(motion.skeleton.joints)}
    body = {joint.name: k for k, joint in enumerate(bap_skeleton().joints)}
    for ours, theirs in match_joints(motion.skeleton, bap_skeleton()).pairs:
        assert worn.shown_by[source[ours]] == min(body[name] for name in theirs)
        for name in theirs:
            assert worn.moved_by[body[name]] == source[ours]
    values = np.arange(len(source), dtype=np.float64)
    shown = worn.on_body(values)
    assert np.isfinite(shown).any()
    assert set(shown[np.isfinite(shown)]) <= set(values)


def test_displacers_take_the_motions_column_of_their_name_and_else_the_files_weight():
    motion = walker(3)
    column = motion.skeleton.columns[4].name
    displacers = tuple(
        Displacer(name, 0, np.array([0]), np.zeros((1, 3), np.float32), 0.25) for name in (column, "smile")
    )
    dressed = dress(motion, replace(bone_body(motion.skeleton), displacers=displacers))
    np.testing.assert_array_equal(dressed.morphs(2), [motion.X[2, 4], 0.25])
