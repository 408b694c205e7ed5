"""Two sides in the window: each with its own settings, seen by one camera, copied across, told apart."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.project.commands import SetCodecSettings
from qmd_studio.project.state import Side
from qmd_studio.render.heat import heat_colours
from qmd_studio.ui.quantity import kilobytes
from qmd_studio.ui.view import View
from tests.paper_settings import paper

ROUGH = paper(fdf=0, encoder=Encoder.PAPER, rqt=60)


def settled(qtbot, window):
    qtbot.waitUntil(lambda: not window.lab.pending, timeout=30_000)


@pytest.fixture
def lab_window(qtbot, window, open_clip, bvh_file):
    """A window that shows the worst frame of a rough encoding, from a side."""
    open_clip(window, bvh_file)
    window.document.execute(SetCodecSettings(ROUGH))
    settled(qtbot, window)
    window.playhead.seek(window.lab.report.error.worst_frame)
    window.viewport.view_preset("left")
    window.viewport.set_overlays(ground=False, axes=False)
    return window


def picture(window):
    window.viewport.finish()
    image = window.viewport.grabFramebuffer().convertToFormat(QImage.Format.Format_RGB888)
    data = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return data[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def shown(window, view):
    window.views.show_view(view)
    return picture(window)


def set_a(window, settings):
    window.document.execute(SetCodecSettings(settings, side=Side.A))


def test_a_wipe_shows_a_left_of_its_line_and_b_right_of_it(lab_window):
    a, b = shown(lab_window, View.A), shown(lab_window, View.B)
    wiped = shown(lab_window, View.WIPE)
    line = lab_window.viewport.width() // 2
    assert np.abs(a - b).max() > 20
    assert np.abs(wiped[:, : line - 1] - a[:, : line - 1]).max() <= 2
    assert np.abs(wiped[:, line + 1 :] - b[:, line + 1 :]).max() <= 2


def test_the_line_is_drawn_by_hand_and_by_keys(lab_window):
    lab_window.views.show_view(View.WIPE)
    handle, viewport = lab_window.views.comparison.handle, lab_window.viewport
    assert handle.isVisible()
    start = handle.rect().center()
    QTest.mousePress(handle, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(handle, start - QPoint(viewport.width() // 4, 0))
    QTest.mouseRelease(handle, Qt.MouseButton.LeftButton)
    assert viewport.split == pytest.approx(0.25, abs=0.01)
    assert handle.geometry().center().x() == pytest.approx(viewport.split * viewport.width(), abs=2)
    QTest.keyClick(handle, Qt.Key.Key_Right)
    assert viewport.split > 0.25
    QTest.mouseDClick(handle, Qt.MouseButton.LeftButton)
    assert viewport.split == 0.5
    lab_window.views.show_view(View.A)
    assert not handle.isVisible()


def test_beside_each_other_both_are_seen_by_one_camera(qtbot, lab_window):
    lab_window.resize(lab_window.width() + 1, lab_window.height())
    qtbot.waitUntil(lambda: lab_window.viewport.width() % 2 == 0)
    apart = shown(lab_window, View.BESIDE)
    half = apart.shape[1] // 2
    assert np.abs(apart[:, :half] - apart[:, -half:]).mean() > 0.5
    set_a(lab_window, ROUGH)
    settled(qtbot, lab_window)
    alike = picture(lab_window)
    assert np.abs(alike[:, :half] - alike[:, -half:]).mean() < 0.35


def test_a_click_beside_picks_the_joint_that_is_seen_there(lab_window):
    lab_window.views.show_view(View.BESIDE)
    viewport = lab_window.viewport
    viewport.frame_all()
    spine, head = 1, 2
    for number, pane in enumerate(viewport.panes):
        at = viewport.scene.actors[number].joint_positions()[[spine, head]].mean(axis=0)
        x, y = viewport.camera.project(at, 0.5 * viewport.width() / viewport.height())[0]
        place = QPoint(
            round((pane.window[0] + pane.width * (x + 1) / 2) * viewport.width()),
            round((1 - y) / 2 * viewport.height()),
        )
        QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=place)
        assert viewport.picked_actor == number
        assert viewport.scene.selected == (number, spine)


def test_only_what_differs_is_seen_of_b_in_the_difference(qtbot, lab_window):
    empty = shown(lab_window, View.DIFFERENCE)
    hot = np.array(heat_colours(1.0)) * 255
    assert lab_window.views.comparison.legend.isVisible()
    warm = (np.abs(empty - hot).sum(axis=2) < 160).sum()
    lab_window.document.execute(SetCodecSettings(paper(fdf=12)))
    settled(qtbot, lab_window)
    same = picture(lab_window)
    assert warm > 100
    assert (np.abs(same - hot).sum(axis=2) < 160).sum() < warm / 10


def test_e_paints_the_error_on_the_body_by_a_scale_that_is_shown(qtbot, lab_window):
    lab_window.views.show_view(View.B)
    lab_window.playhead.seek(5)
    plain = picture(lab_window)
    QTest.keyClick(lab_window, Qt.Key.Key_E)
    legend = lab_window.views.comparison.legend
    assert legend.isVisible()
    assert lab_window.lab.view.heat.isChecked()
    assert "0 to 1 mm" in legend.accessibleName()
    hot = picture(lab_window)
    assert np.abs(hot - plain).sum() > 10_000
    for _ in range(2):
        QTest.keyClick(legend, Qt.Key.Key_Up)
    assert "0 to 100 mm" in legend.accessibleName()
    assert np.abs(picture(lab_window) - hot).sum() > 10_000
    QTest.keyClick(lab_window, Qt.Key.Key_E)
    assert not legend.isVisible()
    assert np.abs(picture(lab_window) - plain).max() <= 2


def test_the_legend_is_painted_in_the_colours_of_the_map(lab_window):
    lab_window.views.show_heat(True)
    legend = lab_window.views.comparison.legend
    image, bar = legend.grab().toImage(), legend.bar()
    for share in (0.02, 0.5, 0.98):
        at = QPoint(round(bar.left() + share * bar.width()), round(bar.center().y())) * image.devicePixelRatio()
        seen = np.array(image.pixelColor(at).getRgbF()[:3])
        np.testing.assert_allclose(seen, heat_colours(share), atol=0.06)


def test_side_a_is_the_original_until_it_is_encoded(qtbot, lab_window):
    lab, document = lab_window.lab, lab_window.document
    a, b = lab.sides[Side.A].figures, lab.sides[Side.B].figures
    raw = 4 * document.state.active_clip.motion.X.size
    assert (a.size.value.text(), a.def_.value.text()) == (kilobytes(raw), "0")
    assert "▼" in b.size.change.text()
    QTest.mouseClick(lab.head.buttons[Side.A], Qt.MouseButton.LeftButton)
    assert not lab.knobs.isVisible()
    QTest.mouseClick(lab.head.source.button("encoded"), Qt.MouseButton.LeftButton)
    settled(qtbot, lab_window)
    assert lab.knobs.isVisible()
    assert lab.sides[Side.A].report.settings == document.state.codec_a
    lab.knobs.paper.bits.slider.setValue(3)
    assert (document.state.codec_a.coding.bits, document.state.codec.coding.bits) == (11, 8)
    settled(qtbot, lab_window)
    assert a.def_.change.text() != "" != b.def_.change.text()
    document.undo()
    document.undo()
    assert document.state.codec_a is None
    assert not lab.knobs.isVisible()
    assert a.def_.value.text() == "0"


def test_settings_are_copied_to_the_other_side_and_back_by_undo(qtbot, lab_window):
    lab, document = lab_window.lab, lab_window.document
    QTest.mouseClick(lab.head.copy, Qt.MouseButton.LeftButton)
    assert document.state.codec_a == document.state.codec == ROUGH
    settled(qtbot, lab_window)
    assert lab.sides[Side.B].figures.def_.change.text() == "="
    undo = next(b for b in lab.note.findChildren(QPushButton) if b.text() == "Undo")
    QTest.mouseClick(undo, Qt.MouseButton.LeftButton)
    assert document.state.codec_a is None
    assert not lab.note.isVisible()


def test_an_undo_that_would_take_back_something_else_is_not_offered(lab_window):
    lab = lab_window.lab
    QTest.mouseClick(lab.head.copy, Qt.MouseButton.LeftButton)
    assert lab.note.isVisible()
    lab.knobs.paper.bits.slider.setValue(2)
    assert not lab.note.isVisible()


def test_the_strip_shows_b_against_a(qtbot, lab_window):
    strip = lab_window.strip
    against_original = strip.accessibleDescription()
    set_a(lab_window, paper(fdf=0, encoder=Encoder.PAPER, rqt=20))
    settled(qtbot, lab_window)
    against_encoding = strip.accessibleDescription()
    set_a(lab_window, ROUGH)
    settled(qtbot, lab_window)
    assert "Worst 0 mm" in strip.accessibleDescription()
    set_a(lab_window, None)
    assert strip.accessibleDescription() == against_original != against_encoding


def test_export_writes_b_whatever_side_is_edited(qtbot, lab_window, bvh_file):
    set_a(lab_window, paper(bits=9))
    lab_window.lab.edit_side(Side.A)
    settled(qtbot, lab_window)
    lab_window.export_qmd()
    name = "nod__fdf0_b8_nd59_paper_rqt60.qmd"
    assert (bvh_file.parent / name).read_bytes() == lab_window.lab.sides[Side.B].report.data


def test_the_sides_are_named_in_the_picture(lab_window):
    lab_window.views.show_view(View.WIPE)
    tags = lab_window.views.comparison.tags
    assert tags[Side.A].text() == "A  Original"
    assert "FDF 0, b 8" in tags[Side.B].text()
    assert all(tag.isVisible() for tag in tags.values())
    lab_window.views.show_view(View.B)
    assert not tags[Side.A].isVisible()
