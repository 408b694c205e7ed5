"""What a clip wears is a change of the document like any other, and its motion can be made the body's own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from generated_motion import walker

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.errors import EditError, FormatError
from qmd_studio.formats.loaded import Loaded
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.joint_map import JointMap
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.skeleton import SkeletonKind
from qmd_studio.project.baking import bake, figure_of, motion_for
from qmd_studio.project.clip import BONES, Alignment, Clip, Outfit, clip_from
from qmd_studio.project.commands import AddClip, SetLengthUnit, WearBody
from qmd_studio.project.document import Document


@pytest.fixture(scope="module")
def avatar():
    return bone_body(replace(bap_skeleton(), name="someone"))


def opened(clip):
    document = Document()
    document.execute(AddClip(clip))
    return document


def test_motion_of_a_person_wears_the_avatar_and_a_box_its_own_bones(avatar):
    motion = walker(3)
    assert clip_from(Loaded(motion.skeleton, motion), Path("walk.bvh"), avatar).outfit.avatar is avatar
    trunk = motion.skeleton.joints[:1]
    columns = tuple(c for c in motion.skeleton.columns if c.joint == 0)
    box = replace(motion.skeleton, joints=trunk, end_sites=(), columns=columns, points=(0,))
    assert clip_from(Loaded(box), Path("box.bvh"), avatar).outfit.avatar is None


def test_body_of_the_file_is_worn_before_any_avatar(avatar):
    motion = walker(3)
    own = bone_body(motion.skeleton)
    clip = clip_from(Loaded(motion.skeleton, motion, own), Path("own.x3d"), avatar)
    assert clip.outfit.avatar is clip.body is own


def test_wearing_leaves_the_motion_alone_and_undo_takes_it_back(avatar):
    document = opened(Clip("walk", walker(3)))
    motion = document.state.active_clip.motion
    document.execute(WearBody(1, Outfit(avatar)))
    assert document.state.active_clip.outfit.avatar is avatar
    assert document.state.active_clip.motion is motion
    assert document.undo_text == "Wear someone"
    document.undo()
    assert document.state.active_clip.outfit == BONES


@pytest.mark.parametrize(
    ("outfit", "problem"),
    [
        ({"joint_map": JointMap((("no such joint", ("vl5",)),))}, "no such joint"),
        ({"joint_map": JointMap(())}, "pairs no joint"),
        ({"alignment": Alignment.FRAME, "frame": 99}, "no such frame"),
    ],
)
def test_outfit_that_does_not_fit_is_refused_and_nothing_changes(avatar, outfit, problem):
    document = opened(Clip("walk", walker(3)))
    before = document.state
    with pytest.raises(FormatError, match=problem):
        document.execute(WearBody(1, Outfit(avatar, **outfit)))
    assert document.state is before


def test_length_unit_scales_the_files_own_body_where_it_is_worn():
    motion = walker(3)
    own = bone_body(motion.skeleton)
    document = opened(Clip("own", motion, own, Outfit(own)))
    document.execute(SetLengthUnit(1, 2 * motion.skeleton.metres_per_unit))
    clip = document.state.active_clip
    assert clip.outfit.avatar is clip.body
    assert clip.body.skeleton == clip.motion.skeleton


def test_baked_clip_has_the_parameters_that_move_the_body_as_the_motion_did(avatar):
    clip = Clip("walk", walker(5), outfit=Outfit(avatar))
    baked = bake(clip)
    assert baked.name == "walk on someone"
    assert baked.motion.skeleton.kind is SkeletonKind.BAP
    assert baked.outfit.avatar is avatar
    ours = {joint.name: k for k, joint in enumerate(baked.motion.skeleton.joints)}
    source = walker(5)
    theirs = {joint.name: k for k, joint in enumerate(source.skeleton.joints)}
    a = world_from_joint(baked.motion.skeleton, baked.motion.X)[..., :3, 3]
    b = world_from_joint(source.skeleton, source.X)[..., :3, 3]
    thighs = _direction(a, ours["l_hip"], ours["l_knee"]), _direction(b, theirs["lfemur"], theirs["ltibia"])
    np.testing.assert_allclose(*thighs, atol=0.03)


def test_a_clip_on_its_own_bones_cannot_be_baked():
    with pytest.raises(EditError, match="own bones"):
        bake(Clip("walk", walker(3)))


def test_figure_of_a_clip_is_a_body_with_a_motion_of_its_own_columns(avatar):
    for outfit in (BONES, Outfit(avatar)):
        body, motion = figure_of(Clip("walk", walker(3), outfit=outfit))
        assert motion.skeleton == body.skeleton
        assert motion.n_frames == 3


def test_parameters_are_written_for_a_clip_without_them_and_other_files_take_it_as_it_is(avatar):
    clip = Clip("walk", walker(3), outfit=Outfit(avatar))
    assert motion_for(clip, ".bap").skeleton.kind is SkeletonKind.BAP
    assert motion_for(clip, ".bvh") is clip.motion


def _direction(positions, start, end):
    bone = positions[:, end] - positions[:, start]
    return bone / np.linalg.norm(bone, axis=1, keepdims=True)
