"""A clip is shown on any body: chosen in the panel, mapped in the dialog, baked into a clip of its own."""

from dataclasses import replace

import numpy as np
import pytest
from generated_motion import walker
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QDialogButtonBox, QFileDialog

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.skeleton import SkeletonKind
from qmd_studio.project.clip import Alignment
from qmd_studio.registry import DEFAULT_AVATAR, avatar_names, save_motion
from qmd_studio.ui.joint_map_dialog import SOURCE, TARGETS, JointMapDialog


def pixels(widget):
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    return np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1, 4)[..., :3].astype(int)


@pytest.fixture(scope="module")
def avatar():
    return bone_body(replace(bap_skeleton(), name="someone"))


@pytest.fixture
def walking(window, open_clip, tmp_path):
    path = tmp_path / "walk.bvh"
    save_motion(path, walker(30))
    open_clip(window, path)
    window.body_panel.wear(None)
    return window


def test_motion_of_a_person_plays_on_the_default_avatar_at_once(window, open_clip, tmp_path):
    path = tmp_path / "walk.bvh"
    save_motion(path, walker(3))
    assert window.viewport.scene.actors[0].body.name == DEFAULT_AVATAR
    open_clip(window, path)
    assert window.document.state.active_clip.outfit.avatar.name == DEFAULT_AVATAR
    assert window.viewport.scene.actors[0].body.name == DEFAULT_AVATAR
    assert window.body_panel.body.currentText() == DEFAULT_AVATAR.capitalize()


def test_every_avatar_that_ships_can_be_chosen_from_the_list(walking, qtbot):
    panel = walking.body_panel
    for name in avatar_names():
        place = panel.body.findText(name.capitalize())
        panel.body.activated.emit(place)
        qtbot.waitUntil(lambda name=name: _worn(walking) == name, timeout=10_000)


@pytest.mark.parametrize("suffix", [".x3d", ".glb"])
def test_export_with_the_body_that_is_worn_opens_again_in_the_same_pose(
    window, open_clip, qtbot, tmp_path, monkeypatch, suffix
):
    source, target = tmp_path / "walk.bvh", tmp_path / f"out{suffix}"
    save_motion(source, walker(4))
    open_clip(window, source)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_args, **_more: (str(target), ""))
    window.verbs["export_as"].trigger()
    qtbot.waitUntil(target.exists, timeout=20_000)
    window.playhead.seek(3)
    shown = window.viewport.scene.actors[0]
    open_clip(window, target)
    window.playhead.seek(3)
    again = window.viewport.scene.actors[0]
    names = [joint.name for joint in shown.body.skeleton.joints]
    place = [[joint.name for joint in again.body.skeleton.joints].index(name) for name in names]
    np.testing.assert_allclose(again.joint_positions()[place], shown.joint_positions(), atol=2e-3)


def test_another_body_is_seen_and_undo_brings_the_first_back(walking, avatar):
    walking.viewport.finish()
    bones = pixels(walking.viewport)
    walking.body_panel.wear(avatar)
    walking.viewport.finish()
    assert (np.abs(pixels(walking.viewport) - bones).max(axis=2) > 12).mean() > 0.002
    assert walking.body_panel.body.currentText() == "someone"
    walking.verbs["undo"].trigger()
    walking.viewport.finish()
    assert (np.abs(pixels(walking.viewport) - bones).max(axis=2) > 12).mean() < 0.001
    assert walking.body_panel.body.currentIndex() == 0


def test_motion_moves_the_body_that_is_worn(walking, avatar):
    walking.body_panel.wear(avatar)
    walking.viewport.finish()
    first = pixels(walking.viewport)
    walking.playhead.seek(14)
    walking.viewport.finish()
    assert (np.abs(pixels(walking.viewport) - first).max(axis=2) > 12).mean() > 0.002


def test_joint_picked_in_the_outliner_is_marked_on_the_body_and_the_other_way_round(walking, avatar):
    walking.body_panel.wear(avatar)
    names = [joint.name for joint in walking.document.state.active_clip.motion.skeleton.joints]
    walking.outliner.joint_selected.emit(names.index("ltibia"))
    actor, joint = walking.viewport.scene.selected
    assert walking.viewport.scene.actors[actor].body.skeleton.joints[joint].name == "l_knee"
    knee = [joint.name for joint in avatar.skeleton.joints].index("r_knee")
    walking.viewport.joint_picked.emit(knee)
    assert walking.outliner.currentItem().text(0) == "rtibia"


def test_alignment_by_the_shown_frame_remembers_which(walking, avatar):
    walking.body_panel.wear(avatar)
    walking.playhead.seek(7)
    panel = walking.body_panel
    panel.alignment.setCurrentIndex(panel.alignment.findData(Alignment.FRAME.value))
    panel.alignment.activated.emit(panel.alignment.currentIndex())
    outfit = walking.document.state.active_clip.outfit
    assert (outfit.alignment, outfit.frame) == (Alignment.FRAME, 7)
    assert panel.alignment.currentText() == "Frame 7"


def test_panel_invites_nothing_where_no_clip_is_open(window):
    assert not window.body_panel.isEnabled()
    assert not window.verbs["wear_file"].isEnabled()


def test_map_edited_in_the_dialog_is_one_step_and_moves_other_joints(walking, avatar):
    walking.body_panel.wear(avatar)
    dialog = open_map(walking)
    row = next(k for k in range(dialog.table.rowCount()) if dialog.table.item(k, SOURCE).text().strip() == "ltibia")
    assert dialog.table.item(row, TARGETS).text() == "l_knee"
    dialog.table.item(row, TARGETS).setText("")
    dialog.buttons.button(QDialogButtonBox.StandardButton.Ok).click()
    joint_map = walking.document.state.active_clip.outfit.joint_map
    assert "ltibia" not in dict(joint_map.pairs)
    walking.verbs["undo"].trigger()
    assert walking.document.state.active_clip.outfit.joint_map is None


def test_map_with_a_name_that_the_body_lacks_is_told_in_the_dialog_which_stays(walking, avatar):
    walking.body_panel.wear(avatar)
    dialog = open_map(walking)
    dialog.table.item(0, TARGETS).setText("tail")
    dialog.accept()
    assert dialog.isVisible()
    assert "tail" in dialog.notice.text.text()
    dialog.reject()
    assert walking.document.state.active_clip.outfit.joint_map is None


def test_map_goes_to_a_file_and_comes_back_and_a_damaged_file_is_told(walking, avatar, tmp_path):
    walking.body_panel.wear(avatar)
    dialog = open_map(walking)
    dialog.table.item(3, TARGETS).setText("")
    kept = dialog.joint_map
    dialog.save_to(tmp_path / "map.json")
    dialog.automatic.click()
    assert dialog.joint_map != kept
    dialog.load_from(tmp_path / "map.json")
    assert dialog.joint_map == kept
    (tmp_path / "map.json").write_text("{")
    dialog.load_from(tmp_path / "map.json")
    assert "map.json" in dialog.notice.text.text()
    assert dialog.joint_map == kept
    dialog.reject()


def test_baking_adds_a_clip_of_body_animation_parameters(walking, avatar, qtbot):
    walking.body_panel.wear(avatar)
    walking.verbs["bake"].trigger()
    qtbot.waitUntil(lambda: len(walking.document.state.clips) == 2, timeout=30_000)
    clip = walking.document.state.active_clip
    assert clip.name == "walk on someone"
    assert clip.motion.skeleton.kind is SkeletonKind.BAP
    assert any("joints follow" in note for note in clip.notes)


def test_file_without_a_body_is_refused_with_the_reason(walking, tmp_path, qtbot, monkeypatch):
    path = tmp_path / "bare.bvh"
    save_motion(path, walker(2))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_args, **_more: (str(path), ""))
    walking.verbs["wear_file"].trigger()
    qtbot.waitUntil(lambda: bool(walking.banners.banners), timeout=10_000)
    assert "holds no body" in walking.banners.banners[0].title + walking.banners.banners[0].text
    assert walking.document.state.active_clip.outfit.avatar is None


def _worn(window):
    avatar = window.document.state.active_clip.outfit.avatar
    return avatar.name if avatar is not None else ""


def open_map(window):
    window.verbs["joint_map"].trigger()
    return next(child for child in window.children() if isinstance(child, JointMapDialog))
