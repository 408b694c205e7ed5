import threading

import numpy as np
from PySide6.QtCore import QMimeData, QPoint, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractSlider, QAbstractSpinBox, QComboBox, QFileDialog, QWidget

from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.ui import furnishing
from qmd_studio.ui.app import FaultReporter, parser
from qmd_studio.ui.focus_ring import FocusRing
from qmd_studio.ui.theme import DARK, LIGHT, Theme


def pixels(widget):
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    return np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1, 4)[..., :3].astype(int)


def test_open_by_dialog_when_a_file_is_chosen_then_it_plays(window, bvh_file, qtbot, monkeypatch):
    monkeypatch.setattr(QFileDialog, "getOpenFileNames", lambda *_args, **_more: ([str(bvh_file)], ""))
    window.verbs["open"].trigger()
    qtbot.waitUntil(lambda: window.document.state.active_clip is not None, timeout=10_000)
    assert window.playhead.playing
    assert window.windowTitle().startswith("nod")
    assert window.outliner.topLevelItem(0).text(0) == "nod"
    assert window.settings.recent == [bvh_file.resolve()]
    qtbot.waitUntil(lambda: window.playhead.index > 0)


def test_a_body_is_seen_when_a_motion_is_open(window, open_clip, bvh_file, qtbot):
    open_clip(window, bvh_file)
    window.viewport.finish()
    first = pixels(window.viewport)
    window.playhead.seek(59)
    window.viewport.finish()
    assert (np.abs(pixels(window.viewport) - first).max(axis=2) > 12).mean() > 0.002


def test_several_files_dropped_are_one_step_of_the_history(window, bvh_file, drop, qtbot, tmp_path):
    second = tmp_path / "second.bvh"
    second.write_bytes(bvh_file.read_bytes())
    assert drop(window, bvh_file, second)
    qtbot.waitUntil(lambda: len(window.document.state.clips) == 2, timeout=10_000)
    window.verbs["undo"].trigger()
    assert window.document.state.clips == ()
    window.verbs["redo"].trigger()
    assert len(window.document.state.clips) == 2


def test_a_drag_of_files_is_invited_and_a_folder_among_them_is_named(window, bvh_file, drop, qtbot):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(bvh_file))])
    middle, copy, left = window.rect().center(), Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
    window.viewport.finish()
    before = pixels(window)
    window.dragEnterEvent(QDragEnterEvent(middle, copy, data, left, Qt.KeyboardModifier.NoModifier))
    assert bvh_file.name in window.drop_highlight.words
    assert np.abs(pixels(window) - before).mean() > 1
    window.dragLeaveEvent(QDragLeaveEvent())
    assert window.drop_highlight.isHidden()
    assert drop(window, bvh_file, bvh_file.parent)
    qtbot.waitUntil(lambda: len(window.document.state.clips) == 1, timeout=10_000)
    assert str(bvh_file.parent) in window.banners.banners[0].text
    assert window.drop_highlight.isHidden()


def test_messages_beyond_three_wait_behind_until_those_are_dismissed(window):
    for number in range(5):
        window.show_message("info", f"Message {number}", [])
    shown = [banner.title for banner in window.banners.banners if banner.isVisible()]
    assert shown == ["Message 4", "Message 3", "Message 2"]
    window.verbs["dismiss"].trigger()
    assert "Message 1" in [banner.title for banner in window.banners.banners if banner.isVisible()]


def test_the_default_body_is_framed_again_when_the_last_clip_is_closed(window, open_clip, bvh_file):
    before = window.viewport.camera
    open_clip(window, bvh_file)
    assert not before.is_near(window.viewport.camera)
    window.verbs["close_clip"].trigger()
    assert before.is_near(window.viewport.camera)


def test_a_unit_that_a_format_has_fixed_cannot_be_chosen(window, open_clip, bvh_file, qtbot):
    window.files.open_sample()
    qtbot.waitUntil(lambda: len(window.document.state.clips) == 1, timeout=10_000)
    assert not window.clip_panel.unit.isEnabled()
    assert "millimetres" in window.clip_panel.unit.toolTip()
    open_clip(window, bvh_file)
    assert window.clip_panel.unit.isEnabled()


def test_a_drag_without_a_file_is_refused(window, drop, tmp_path):
    assert not drop(window, tmp_path)
    assert not drop(window, tmp_path / "no such file.bvh")


def test_a_bad_file_leaves_the_document_and_says_why(window, open_clip, bvh_file, bad_file, qtbot):
    open_clip(window, bvh_file)
    before = window.document.state
    window.open_paths([bad_file])
    qtbot.waitUntil(lambda: bool(window.banners.banners), timeout=10_000)
    banner = window.banners.banners[0]
    assert banner.isVisible()
    assert str(bad_file) in banner.text
    assert "line" in banner.text
    assert "forty" in banner.text
    assert window.document.state is before
    window.verbs["dismiss"].trigger()
    assert window.banners.isHidden()


def test_of_two_files_the_good_one_opens(window, bvh_file, bad_file, qtbot):
    window.open_paths([bad_file, bvh_file])
    qtbot.waitUntil(lambda: bool(window.document.state.clips and window.banners.banners), timeout=10_000)
    assert [clip.name for clip in window.document.state.clips] == ["nod"]


def test_a_request_that_is_cancelled_changes_nothing(window, bvh_file, qtbot):
    window.open_paths([bvh_file])
    window.files.cancel()
    with qtbot.waitSignal(window.files.added):
        window.open_paths([bvh_file])
    assert len(window.document.state.clips) == 1


def test_transport_keys(window, open_clip, bvh_file, qtbot):
    open_clip(window, bvh_file)
    shift, ctrl = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier
    window.viewport.setFocus()
    for key, modifier, frame in (
        (Qt.Key.Key_Right, Qt.KeyboardModifier.NoModifier, 1),
        (Qt.Key.Key_Right, ctrl, 31),
        (Qt.Key.Key_Left, Qt.KeyboardModifier.NoModifier, 30),
        (Qt.Key.Key_Right, shift, 59),
        (Qt.Key.Key_Home, Qt.KeyboardModifier.NoModifier, 0),
        (Qt.Key.Key_End, Qt.KeyboardModifier.NoModifier, 59),
        (Qt.Key.Key_Left, shift, 0),
    ):
        qtbot.keyClick(window.viewport, key, modifier)
        assert window.playhead.index == frame, key
    qtbot.keyClick(window.viewport, Qt.Key.Key_Space)
    assert window.playhead.playing
    qtbot.keyClick(window.viewport, Qt.Key.Key_Space)
    assert not window.playhead.playing
    qtbot.keyClick(window.viewport, Qt.Key.Key_Space, ctrl | shift)
    assert window.playhead.speed < 0


def test_clip_properties_are_set_through_the_document(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    panel, motion = window.clip_panel, lambda: window.document.state.active_clip.motion
    panel.fps.setValue(60.0)
    assert motion().fps == 60.0
    assert window.playhead.fps == 60.0
    guessed = panel.unit.currentText()
    row = panel.unit.findText("foot")
    panel.unit.setCurrentIndex(row)
    panel.unit.activated.emit(row)
    assert np.isclose(motion().skeleton.joints[1].offset[1], 40 * 0.3048)
    window.verbs["undo"].trigger()
    assert panel.unit.currentText() == guessed
    window.verbs["undo"].trigger()
    assert np.isclose(panel.fps.value(), 30.0, atol=0.01)


def test_selection_is_the_same_in_outliner_and_viewport(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    window.viewport.joint_picked.emit(2)
    assert window.outliner.currentItem().text(0) == "Head"
    spine = window.outliner.currentItem().parent()
    window.outliner.setCurrentItem(spine)
    assert window.viewport.scene.selected == (0, 1)
    assert window.verbs["frame_selection"].isEnabled()


def test_renaming_in_the_outliner_can_be_undone(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    window.outliner.topLevelItem(0).setText(0, "bow")
    assert window.document.state.active_clip.name == "bow"
    window.outliner.topLevelItem(0).setText(0, "   ")
    assert window.outliner.topLevelItem(0).text(0) == "bow"
    assert window.banners.banners
    window.verbs["undo"].trigger()
    assert window.outliner.topLevelItem(0).text(0) == "nod"


def test_light_and_dark_differ_in_the_pixels(window):
    window.themes.choose(Theme.LIGHT)
    light = pixels(window.menuBar()).mean()
    window.verbs["theme_dark"].trigger()
    dark = pixels(window.menuBar()).mean()
    assert light > 200
    assert dark < 80
    assert window.settings.theme == "dark"


def test_text_has_contrast_enough_in_both_themes():
    def luminance(colour):
        channels = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
        return linear @ [0.2126, 0.7152, 0.0722]

    def contrast(one, other):
        bright, dim = sorted((luminance(one), luminance(other)), reverse=True)
        return (bright + 0.05) / (dim + 0.05)

    for theme in (LIGHT, DARK):
        pairs = [(theme.text, ground) for ground in (theme.window, theme.base, theme.raised)]
        pairs += [(theme.muted, ground) for ground in (theme.window, theme.base, theme.raised)]
        pairs += [(getattr(theme, k), getattr(theme, f"{k}_ground")) for k in ("error", "warning", "info")]
        pairs += [(theme.on_accent, theme.accent), (theme.text, theme.info_ground)]
        assert min(contrast(*pair) for pair in pairs) >= 4.5


def test_the_layout_is_remembered_and_can_be_reset(make_window):
    window = make_window()
    window.outliner_dock.hide()
    window.close()
    again = make_window()
    assert again.outliner_dock.isHidden()
    again.verbs["reset_layout"].trigger()
    assert again.outliner_dock.isVisible()


def test_a_fault_in_a_thread_is_shown_and_not_lost(window, qtbot):
    reporter = FaultReporter(window)
    try:
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
        qtbot.waitUntil(lambda: bool(window.banners.banners))
    finally:
        reporter.stop()
    assert "ZeroDivisionError" in window.banners.banners[0].text


def test_every_control_has_a_name_and_a_tip(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    kinds = (QAbstractButton, QAbstractSpinBox, QComboBox, QAbstractSlider)
    nameless = []
    for control in window.findChildren(QWidget):
        if not isinstance(control, kinds) or control.objectName().startswith(("qt_", "ScrollLeft", "ScrollRight")):
            continue
        if not control.isVisible() or isinstance(control.parent(), QAbstractSpinBox | QComboBox):
            continue
        if type(control).__name__ in ("QScrollBar", "QDockWidgetTitleButton"):
            continue
        if not control.toolTip() or not (control.accessibleName() or getattr(control, "text", str)()):
            nameless.append((type(control).__name__, control.objectName(), control.parent()))
    assert nameless == []


def test_a_warning_of_a_reader_is_shown_and_read_again_by_a_click_in_the_outliner(window, open_clip, bvh_file):
    lines = bvh_file.read_text().splitlines()
    bvh_file.write_text("\n".join([*lines[:-1], " ".join(lines[-1].split()[:5])]))  # the last frame is cut off
    open_clip(window, bvh_file)
    assert "59" in window.banners.banners[0].text, "a warning is shown with the clip it is about"
    window.verbs["dismiss"].trigger()
    row = window.outliner.topLevelItem(0)
    assert row.text(1) == "1 warning"
    assert not row.icon(1).isNull()
    window.outliner.itemClicked.emit(row, 1)
    assert window.banners.banners[0].kind == "warning"
    assert "59" in window.banners.banners[0].text


def test_export_as_writes_what_is_shown_and_a_wrong_suffix_says_so(window, open_clip, bvh_file, qtbot, monkeypatch):
    open_clip(window, bvh_file)
    copy, wrong = bvh_file.with_name("copy.bvh"), bvh_file.with_name("copy.doc")
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_args, **_more: (str(copy), ""))
    window.verbs["export_as"].trigger()
    qtbot.waitUntil(lambda: any(banner.kind == "info" for banner in window.banners.banners), timeout=10_000)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_args, **_more: (str(wrong), ""))
    window.verbs["export_as"].trigger()
    qtbot.waitUntil(lambda: window.banners.banners[0].kind == "error", timeout=10_000)
    assert not wrong.exists()
    open_clip(window, copy)
    first, second = window.document.state.clips
    np.testing.assert_allclose(second.motion.X, first.motion.X, atol=1e-6)


def test_a_slow_motion_is_played_smoothly_and_rests_on_its_frames(window, open_clip, bvh_file):
    open_clip(window, bvh_file)  # 30 frames a second
    spine = [joint.name for joint in window.document.state.active_clip.motion.skeleton.joints].index("Spine")

    def shown():
        return window.viewport.scene.actors[0].world_from_joint[spine, :3, :3]

    window.playhead.seek(10)
    first = shown()
    window.playhead.seek(11)
    second = shown()
    window.playhead.seek(10)
    window.playhead.playing = True
    window.player._timer.stop()  # time comes from the test
    window.playhead.advance(0.5 / 30.0)
    assert window.playhead.index == 10
    np.testing.assert_allclose(shown(), (first + second) / 2, atol=1e-4)
    window.playhead.playing = False
    np.testing.assert_allclose(shown(), first, atol=1e-12)


def test_the_focus_is_seen_wherever_tab_brings_it(window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    window.viewport.finish()
    knob = window.lab.knobs.paper.bits
    ring = window.findChild(FocusRing)
    window.viewport.setFocus(Qt.FocusReason.MouseFocusReason)
    assert ring.isHidden(), "a click needs no ring"
    window.timeline.place.setFocus()
    window.viewport.setFocus(Qt.FocusReason.TabFocusReason)
    assert ring.isVisible()
    assert ring.geometry() == window.viewport.geometry()
    for widget in (window.outliner, knob.slider, knob.spin, window.strip):
        window.timeline.place.setFocus()
        assert ring.isHidden()
        before = pixels(widget)
        widget.setFocus(Qt.FocusReason.TabFocusReason)
        assert (pixels(widget) != before).any(), widget
    fps, unit = window.clip_panel.fps, window.clip_panel.unit
    before = pixels(unit)
    fps.setFocus()
    QTest.keyClick(fps, Qt.Key.Key_Tab)
    assert unit.hasFocus()
    assert (pixels(unit) != before).any()


def test_the_command_line_takes_files_and_options(capsys):
    options = parser().parse_args(["--no-sample", "a.bvh", "b.qmd"])
    assert [path.name for path in options.files] == ["a.bvh", "b.qmd"]
    assert not options.sample


def test_the_default_body_stands_where_nothing_is_open(window):
    assert len(window.viewport.scene.actors) == 1
    window.viewport.finish()
    picture = pixels(window.viewport)
    middle = picture[:, picture.shape[1] // 2 - 40 : picture.shape[1] // 2 + 40]
    assert middle.std() > 10
    assert QPoint(0, 0) == window.viewport.pos()


def test_the_compiled_kinematics_take_over_and_pose_the_same(window, open_clip, bvh_file, qtbot):
    open_clip(window, bvh_file)
    ready, window.stage.kinematics = [], world_from_joint
    window.playhead.seek(30)
    plain = window.viewport.scene.actors[0].world_from_joint
    window.playhead.seek(0)
    furnishing._warm_kinematics(ready)  # it is given nothing of the window that it could keep alive on its thread
    assert ready[0] is not world_from_joint
    window.stage.kinematics = ready[0]
    window.playhead.seek(30)
    np.testing.assert_allclose(window.viewport.scene.actors[0].world_from_joint, plain, atol=1e-9)
