"""Limits on H-Anim bodies of free joints: the parameters' own, whatever a joint stands for, reported and kept."""

from dataclasses import replace

import numpy as np
import pytest

from qmd_studio.motion.anatomical_limits import beyond_limits, limited_joints
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.hanim import hanim_end_sites, hanim_joints
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.retarget import retargeting
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind


def free_figure(left_out=()):
    """The standard's joints without those of `left_out`, each turning freely, as H-Anim files have them."""
    rows = [joint for joint in hanim_joints() if joint.name not in left_out]
    centres = {joint.name: np.array(joint.centre) for joint in hanim_joints()}
    above = {joint.name: joint.parent for joint in hanim_joints()}
    names = [joint.name for joint in rows]
    columns = [Column(f"root t{a}", 0, ColumnKind.TRANSLATION, k) for k, a in enumerate("xyz")]
    joints = []
    for number, name in enumerate(names):
        parent = above[name]
        while parent in left_out:
            parent = above[parent]
        first = len(columns)
        columns += [Column(f"{name} r{a}", number, ColumnKind.ROTATION, k) for k, a in enumerate("xyz")]
        offset = centres[name] - (centres[parent] if parent else 0)
        joints.append(
            Joint(name, names.index(parent) if parent else -1, tuple(offset.tolist()), (first + 2, first + 1, first))
        )
    whole = [joint.name for joint in hanim_joints()]
    ends = [replace(e, joint=names.index(whole[e.joint])) for e in hanim_end_sites() if whole[e.joint] in names]
    points = tuple(range(len(joints) + len(ends)))
    return Skeleton("free", SkeletonKind.HANIM, tuple(joints), tuple(ends), tuple(columns), points)


def bap_motion(size, frames=20):
    """Parameters within `size` of their limits, the root at rest."""
    skeleton = bap_skeleton()
    random = np.random.default_rng(2)
    X = np.zeros((frames, skeleton.n_columns))
    for k, column in enumerate(skeleton.columns):
        if column.limits and column.joint:
            low, high = column.limits
            X[:, k] = (low + high) / 2 + size * random.uniform(-0.5, 0.5, frames) * (high - low)
    return Motion(skeleton, X, 30.0)


def test_parameters_within_their_limits_are_so_on_a_free_body():
    figure = free_figure()
    inside = bap_motion(0.99)
    result = retargeting(inside.skeleton, figure).motion(inside)
    assert result.mean_angle_error_deg < 1e-3
    assert result.clamped_share == 0


@pytest.mark.parametrize("limits", ["report", "keep"])
def test_what_lies_outside_is_counted_and_brought_back_if_wished(limits):
    figure, far = free_figure(), bap_motion(1.3)
    counted = far.X[:, [k for k, c in enumerate(far.skeleton.columns) if c.limits and c.joint]]
    assert counted.size
    result = retargeting(far.skeleton, figure, limits=limits).motion(far)
    assert 0.05 < result.clamped_share < 0.4
    again = retargeting(figure, figure).motion(result.motion)
    assert again.clamped_share == pytest.approx(result.clamped_share if limits == "report" else 0, abs=1e-9)
    assert (result.mean_angle_error_deg > 0.1) == (limits == "keep")


def test_kept_angles_are_the_parameters_clipped():
    figure, far = free_figure(), bap_motion(1.3)
    result = retargeting(far.skeleton, figure, limits="keep").motion(far)
    clipped = far.X.copy()
    for k, column in enumerate(far.skeleton.columns):
        if column.limits and column.joint:
            clipped[:, k] = np.clip(far.X[:, k], *column.limits)
    names = [joint.name for joint in far.skeleton.joints]
    own = [joint.name for joint in figure.joints]
    wanted, found = world_from_joint(far.skeleton, clipped), world_from_joint(figure, result.motion.X)
    for name in ("l_knee", "r_elbow", "l_hip"):
        parent = figure.joints[own.index(name)].parent
        above = names.index(own[parent])
        local = np.swapaxes(found[:, parent, :3, :3], 1, 2) @ found[:, own.index(name), :3, :3]
        plain = np.swapaxes(wanted[:, above, :3, :3], 1, 2) @ wanted[:, names.index(name), :3, :3]
        np.testing.assert_allclose(local, plain, atol=1e-6, err_msg=name)


def test_one_vertebra_may_turn_as_far_as_all_that_it_stands_for():
    spine = [j.name for j in hanim_joints() if j.name.startswith("v") and j.name != "vl5"]
    whole = {f.joints[j.joint].name: j for f in [free_figure()] for j in limited_joints(f)}
    few = free_figure(left_out=spine)
    short = {few.joints[j.joint].name: j for j in limited_joints(few)}
    trunk = [name for name in spine if not name.startswith("vc")]
    np.testing.assert_allclose(short["vl5"].high, whole["vl5"].high + sum(whole[name].high for name in trunk))
    assert (short["skullbase"].high > whole["skullbase"].high + 0.1).any()
    np.testing.assert_array_equal(short["l_knee"].low, whole["l_knee"].low)


def test_a_skeleton_with_limits_of_its_own_keeps_those():
    assert limited_joints(bap_skeleton()) == ()


def test_a_joint_at_rest_is_left_as_it_is():
    figure = free_figure()
    X = np.zeros((3, figure.n_columns))
    for joint in limited_joints(figure):
        outside, values = beyond_limits(joint, X)
        assert not outside.any()
        assert not values.any()
