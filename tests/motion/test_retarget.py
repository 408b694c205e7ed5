"""Motions keep their poses on other bodies: by equal bones, by one take in two formats, from T- and from A-poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from corpus import corpus_file, corpus_files
from scipy.spatial.transform import Rotation

from qmd_studio.avatar.upright import upright
from qmd_studio.errors import FormatError
from qmd_studio.motion.as_euler import as_euler
from qmd_studio.motion.bap import bap_skeleton, column_of
from qmd_studio.motion.bap_body import bap_skeleton_like
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.foot_pinning import contacts, two_bone_turns
from qmd_studio.motion.joint_map import CMU_62_BAPS, JointMap, cmu_62_map
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.reference_pose import ZERO, Reference, choose_reference, frame_reference
from qmd_studio.motion.retarget import retargeting
from qmd_studio.registry import open_file
from tests.motion.retarget_figures import figure, swinging, turn_z

EQUAL_BONES_M = 0.005
BAP_UNIT = 1e-5


def bap_motion(n_frames=30, share=0.4, seed=5):
    """Poses well within the anatomical limits."""
    skeleton = bap_skeleton()
    random = np.random.default_rng(seed)
    X = np.zeros((n_frames, skeleton.n_columns))
    for k, column in enumerate(skeleton.columns):
        low, high = column.limits or (-0.5, 0.5)
        X[:, k] = random.uniform(share * low, share * high, n_frames) if column.unit == "rad" else 0.1
    return Motion(skeleton, X, 25.0)


def moved(way, motion):
    """The places of the target's joints, through `pose`."""
    return way.pose(world_from_joint(motion.skeleton, motion.X))[:, :, :3, 3]


def test_body_on_itself_keeps_every_value():
    motion = bap_motion()
    result = retargeting(motion.skeleton, motion.skeleton).motion(motion)
    np.testing.assert_allclose(result.motion.X, motion.X, atol=BAP_UNIT / 2)
    assert result.clamped_share == 0
    assert result.mean_angle_error_deg < 1e-3
    assert not result.unmapped


def test_parameters_go_to_free_joints_and_back():
    motion = bap_motion()
    free = as_euler(motion)
    there = retargeting(motion.skeleton, free.skeleton).motion(motion).motion
    ours, theirs = node_positions(motion.skeleton, motion.X), node_positions(free.skeleton, there.X)
    order = [free.skeleton.node_names.index(name) for name in motion.skeleton.node_names]
    assert np.linalg.norm(ours - theirs[:, order], axis=2).max() < EQUAL_BONES_M
    back = retargeting(free.skeleton, motion.skeleton).motion(there).motion
    turning = [j for j, joint in enumerate(motion.skeleton.joints) if len(joint.product) == 3]
    columns = [
        c for c, column in enumerate(motion.skeleton.columns) if column.joint in turning and column.unit == "rad"
    ]
    np.testing.assert_allclose(back.X[:, columns], motion.X[:, columns], atol=BAP_UNIT)


def test_other_axes_and_equal_bones_agree_in_place():
    source, target = figure("xsens"), figure("mixamo")
    motion = swinging(source)
    places = moved(retargeting(source, target), motion)
    ours = world_from_joint(source, motion.X)[..., :3, 3]
    order = [parts_of(source).part_of()[j] for j in range(len(source.joints))]
    theirs = [parts_of(target).part_of()[j] for j in range(len(target.joints))]
    assert order == theirs
    assert np.linalg.norm(places - ours, axis=2).max() < EQUAL_BONES_M


@pytest.mark.parametrize("arms_down", [0.3, 0.8, np.pi / 2])
def test_t_pose_and_lowered_arms_show_the_same(arms_down):
    straight, lowered = figure(), figure(arms_down=arms_down)
    motion = swinging(straight)
    way = retargeting(straight, lowered)
    # the same poses, written on the lowered file by other arithmetic: G' = G times the rest's turn back
    world = world_from_joint(straight, motion.X)
    again = way.pose(world)
    np.testing.assert_allclose(again[..., :3, 3], world[..., :3, 3], atol=1e-9)
    for side, sign in (("l_", 1.0), ("r_", -1.0)):
        for part in ("shoulder", "elbow", "wrist"):
            joint = parts_of(straight).named[side + part]
            expected = world[:, joint, :3, :3] @ turn_z(-sign * arms_down).T
            np.testing.assert_allclose(again[:, joint, :3, :3], expected, atol=1e-9)
    onto_bap = [retargeting(s, bap_skeleton()).pose(w) for s, w in ((straight, world), (lowered, again))]
    np.testing.assert_allclose(*onto_bap, atol=1e-9)


def test_half_the_size_walks_half_as_far_on_its_own_feet():
    big, small = figure(), figure("neuron", scale=0.5)
    motion = swinging(big)
    ours, theirs = world_from_joint(big, motion.X)[..., :3, 3], moved(retargeting(big, small), motion)
    np.testing.assert_allclose(theirs, 0.5 * ours, atol=1e-9)


def test_one_frame_is_what_all_frames_have():
    motion = bap_motion()
    way = retargeting(motion.skeleton, figure())
    world = world_from_joint(motion.skeleton, motion.X)
    every = way.pose(world)
    for frame in (0, 7, 29):
        np.testing.assert_array_equal(way.pose(world[frame : frame + 1])[0], every[frame])
    X = way.motion(motion).motion.X
    np.testing.assert_allclose(world_from_joint(way.target, X), every, atol=1e-9)


def test_figure_that_stands_along_z_comes_out_standing():
    stand = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # y up to z up
    level, tall = figure("mixamo"), figure("mixamo", up=stand)
    rest = Motion(tall, rest_values(tall)[None].repeat(3, 0), 30.0)
    way = retargeting(tall, bap_skeleton(), upright=upright(rest))
    expected = retargeting(level, bap_skeleton()).pose(world_from_joint(level, rest_values(level)[None]))
    np.testing.assert_allclose(way.pose(world_from_joint(tall, rest.X))[:1], expected, atol=1e-9)


def test_hinge_elbow_gets_its_plane_from_the_shoulder():
    source = figure()
    walker = open_file(corpus_file("cmu_asfamc/01_01.amc")).motion
    motion = swinging(source, reach=0.9)
    result = retargeting(source, walker.skeleton).motion(motion)
    world = world_from_joint(walker.skeleton, result.motion.X)
    ours = world_from_joint(source, motion.X)
    for side in ("l_", "r_"):
        ends = [parts_of(s).named for s in (source, walker.skeleton)]
        ways = [
            w[:, e[side + "wrist"], :3, 3] - w[:, e[side + "elbow"], :3, 3]
            for w, e in zip((ours, world), ends, strict=True)
        ]
        ways = [w / np.linalg.norm(w, axis=1, keepdims=True) for w in ways]
        angle = np.arccos(np.clip((ways[0] * ways[1]).sum(axis=1), -1, 1))
        assert np.degrees(np.median(angle)) < 2.0


def test_limits_are_counted_or_kept():
    motion = bap_motion()
    far = motion.with_values(motion.X * 6)
    way = retargeting(far.skeleton, far.skeleton)
    assert way.motion(far).clamped_share > 0.2
    kept = retargeting(far.skeleton, far.skeleton, limits="keep").motion(far)
    assert kept.clamped_share > 0.2
    for k, column in enumerate(far.skeleton.columns):
        if column.limits:
            assert kept.motion.X[:, k].min() >= column.limits[0] - 1e-9, column.name
            assert kept.motion.X[:, k].max() <= column.limits[1] + 1e-9, column.name


def test_spine_turn_is_shared_by_all_vertebrae():
    source = figure()
    X = rest_values(source)[None].copy()
    turn = next(k for k, c in enumerate(source.columns) if c.name == "mixamorig:Spine Yrotation")
    X[0, turn] = 0.6
    values = retargeting(source, bap_skeleton()).motion(Motion(source, X, 30.0)).motion.X[0]
    torsions = [
        values[k]
        for k, c in enumerate(bap_skeleton().columns)
        if c.name.endswith("_torsion") and c.name[:2] in ("vl", "vt")
    ]
    shared = [t for t in torsions if abs(t) > 1e-9]
    assert 8 <= len(shared) <= 9
    np.testing.assert_allclose(shared, 0.6 / len(shared), atol=1e-9)


def test_zero_takes_turns_as_they_stand():
    source, target = figure(arms_down=0.9), figure("neuron")
    motion = swinging(source)
    world = world_from_joint(source, motion.X)
    turned = retargeting(source, target, reference=ZERO).pose(world)
    np.testing.assert_allclose(turned[..., :3, :3], world[..., :3, :3], atol=1e-9)


def test_t_pose_put_first_is_found_and_said():
    skeleton = figure(arms_down=1.2)
    X = np.repeat(rest_values(skeleton)[None], 5, axis=0)
    for k, column in enumerate(skeleton.columns):
        if column.name.endswith("Arm Zrotation") and "Fore" not in column.name:
            X[0, k] = 1.2 if "Left" in column.name else -1.2
    chosen = choose_reference(Motion(skeleton, X, 30.0))
    assert chosen.kind == "frame"
    assert "T-pose" in chosen.note
    assert choose_reference(Motion(skeleton, X[1:], 30.0)).kind == "rest"


def test_frame_that_is_not_there_is_refused():
    with pytest.raises(FormatError, match="no such frame"):
        frame_reference(bap_motion(), 30)


def test_motion_of_another_skeleton_is_refused():
    with pytest.raises(FormatError, match="not on the skeleton"):
        retargeting(figure(), bap_skeleton()).motion(bap_motion())


def test_frame_rate_is_changed_on_the_way():
    motion = swinging(figure(), 61)
    result = retargeting(motion.skeleton, bap_skeleton()).motion(motion, fps=20.0)
    assert (result.motion.fps, result.motion.n_frames) == (20.0, 21)
    whole = retargeting(motion.skeleton, bap_skeleton()).motion(motion)
    worlds = [world_from_joint(bap_skeleton(), x) for x in (result.motion.X, whole.motion.X[::3])]
    np.testing.assert_allclose(*worlds, atol=1e-9)


def test_two_bones_reach_where_they_can():
    random = np.random.default_rng(2)
    joints = np.zeros((50, 3, 3))
    joints[:, 1] = random.normal(size=(50, 3)) * 0.1 + (0, -0.4, 0.05)
    joints[:, 2] = joints[:, 1] + random.normal(size=(50, 3)) * 0.1 + (0, -0.4, -0.05)
    goal = joints[:, 2] + random.normal(size=(50, 3)) * 0.03
    goal *= np.minimum(1, 0.97 * np.linalg.norm(np.diff(joints, axis=1), axis=2).sum(1) / np.linalg.norm(goal, axis=1))[
        :, None
    ]
    upper, lower = two_bone_turns(joints, goal)
    knee = np.einsum("fij,fj->fi", upper, joints[:, 1])
    ankle = knee + np.einsum("fij,fj->fi", lower, joints[:, 2] - joints[:, 1])
    np.testing.assert_allclose(ankle, goal, atol=1e-9)


def test_pinned_feet_slide_less():
    motion = open_file(corpus_file("cmu_asfamc/02_01.amc")).motion
    target = bap_skeleton()
    way = retargeting(motion.skeleton, target)
    free, pinned = way.motion(motion), way.motion(motion, pin_feet=True)
    named = parts_of(motion.skeleton).named
    stands = contacts(node_positions(motion.skeleton, motion.X)[:, [named["l_ankle"], named["l_toe"]]], motion.fps)
    both = stands[1:] & stands[:-1]
    ankle = parts_of(target).named["l_ankle"]
    slides = [
        np.linalg.norm(np.diff(world_from_joint(target, r.motion.X)[:, ankle, :3, 3], axis=0), axis=1)[both]
        for r in (free, pinned)
    ]
    assert slides[1].mean() < 0.4 * slides[0].mean()
    assert np.median(slides[1]) < 0.05 * np.median(slides[0])


def test_one_take_in_two_formats_moves_the_body_alike():
    amc, bvh = (open_file(corpus_file(f)).motion for f in ("cmu_asfamc/01_01.amc", "bvh/fairmotion_01_01.bvh"))
    ours, theirs = (
        retargeting(m.skeleton, bap_skeleton(), reference=choose_reference(m)).motion(m).motion.X[::50] for m in
        (amc, bvh.with_values(bvh.X[1:]))
    )  # fmt: skip
    worlds = [world_from_joint(bap_skeleton(), X) for X in (ours, theirs)]
    turned = Rotation.from_matrix((np.swapaxes(worlds[0], 2, 3) @ worlds[1])[..., :3, :3].reshape(-1, 3, 3)).magnitude()
    assert np.degrees(turned).max() < 0.5
    assert np.linalg.norm(worlds[0][..., :3, 3] - worlds[1][..., :3, 3], axis=2).max() < 0.02


def test_cmu_to_62_parameters_moves_those_and_no_others():
    motion = open_file(corpus_file("cmu_asfamc/02_01.amc")).motion
    way = retargeting(motion.skeleton, bap_skeleton(), joint_map=cmu_62_map(motion.skeleton, bap_skeleton()))
    X = way.motion(motion).motion.X
    moving = {
        column.bap_id for column, values in zip(bap_skeleton().columns, X.T, strict=True) if np.ptp(values) > 1e-9
    }
    assert len(CMU_62_BAPS) == len(set(CMU_62_BAPS)) == 62
    assert moving <= set(CMU_62_BAPS)
    assert len(moving) >= 54  # in this take fingers and collar bones keep still
    knee = X[:, column_of(10)]
    assert knee.min() < -0.8 < 0.4 > knee.max()  # bends backward


@pytest.mark.parametrize(
    "path", [*corpus_files("bvh/*.bvh"), *corpus_files("cmu_asfamc/*.amc"), *corpus_files("other_asfamc/*.amc")]
)
def test_limbs_of_every_corpus_file_point_where_they_did(path):
    motion = open_file(path).motion
    motion = motion.with_values(motion.X[:: max(1, motion.n_frames // 24)])
    stand = upright(motion)
    target = bap_skeleton()
    way = retargeting(motion.skeleton, target, reference=choose_reference(motion), upright=stand)
    result = way.motion(motion)
    assert result.mean_angle_error_deg < 3.0
    ours = stand @ world_from_joint(motion.skeleton, motion.X)
    theirs = world_from_joint(target, result.motion.X)
    named, parts = parts_of(motion.skeleton).named, parts_of(target).named
    for side in ("l_", "r_"):
        for near, far in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist")):
            if side + far not in named:
                continue
            ways = [
                w[:, n[side + far], :3, 3] - w[:, n[side + near], :3, 3] for w, n in ((ours, named), (theirs, parts))
            ]
            ways = [w / np.linalg.norm(w, axis=1, keepdims=True) for w in ways]
            angle = np.degrees(np.arccos(np.clip((ways[0] * ways[1]).sum(axis=1), -1, 1)))
            assert angle.max() < 3.0, (side + near, angle.max())


def test_parameters_take_another_bodys_proportions():
    tall = bap_skeleton().scaled(1.2)
    body = replace(tall, joints=tuple(replace(j, name=j.name) for j in tall.joints))
    like = bap_skeleton_like(body)
    assert like.n_columns == 186
    ours, theirs = (node_positions(s, rest_values(s)[None])[0] for s in (like, body))
    np.testing.assert_allclose(ours, theirs, atol=1e-9)


def test_body_of_few_joints_still_carries_all_parameters():
    few = figure("H-Anim 1", arms_down=np.pi / 2)
    like = bap_skeleton_like(few)
    ours, theirs = (node_positions(s, rest_values(s)[None])[0] for s in (like, few))
    for name in ("l_knee", "r_elbow", "skullbase", "l_metatarsal"):
        np.testing.assert_allclose(ours[like.joint_index(name)], theirs[few.joint_index(name)], atol=1e-9)


def test_map_that_pairs_nothing_is_refused():
    with pytest.raises(FormatError, match="pairs no joint"):
        retargeting(figure(), bap_skeleton(), joint_map=JointMap(()))


def test_reference_row_of_a_frame_settles_the_second_direction():
    motion = swinging(figure())
    reference = Reference("frame", rest_values(motion.skeleton))
    world = world_from_joint(motion.skeleton, motion.X)
    ways = [
        retargeting(motion.skeleton, bap_skeleton(), reference=r).pose(world) for r in (reference, Reference("rest"))
    ]
    np.testing.assert_array_equal(*ways)
