"""Plots, targets and presets of the lab, as a user meets them."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QWidget

from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip, SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.preset_json import Preset
from qmd_studio.project.presets import FOLDER_VARIABLE, PresetShelf
from qmd_studio.project.state import Side
from qmd_studio.tuning.size_figures import size_figures
from qmd_studio.ui.codec_lab import CodecLab
from qmd_studio.ui.preset_menu import PresetDialog
from qmd_studio.ui.target_dialog import TargetDialog
from tests.generated_motion import walker
from tests.paper_settings import paper

PAPER = paper(encoder=Encoder.PAPER)


@pytest.fixture
def document():
    return Document()


@pytest.fixture
def lab(qtbot, document, tmp_path, monkeypatch):
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "presets"))
    lab = CodecLab(document, Playhead(90, 120.0))
    qtbot.addWidget(lab)
    lab.resize(340, 760)
    lab.show()
    document.execute(SetCodecSettings(PAPER))
    document.execute(AddClip(Clip("walk", walker(90))))
    settled(qtbot, lab)
    yield lab
    lab.close_down()


def settled(qtbot, lab):
    qtbot.waitUntil(lambda: not lab.pending and not lab.plots.busy, timeout=60_000)


def test_both_figures_are_drawn_with_the_setting_as_a_dot(qtbot, lab, document):
    plots, motion = lab.plots, document.state.active_clip.motion
    kb = size_figures(motion, PAPER.coding).payload.bytes / 1024
    for bits in (8, 9, 10, 11):
        assert len(plots.size.points_of(f"b {bits}")) == 63
        assert [x for x, _ in plots.def_.points_of(f"b {bits}")] == list(range(62))
    assert plots.size.points_of("b 8")[6] == pytest.approx((6, kb))
    spot = plots.size.marks["B"][0].getData()
    assert (spot[0][0], spot[1][0]) == pytest.approx((6, kb))
    assert plots.def_.points_of("b 8")[6][1] == pytest.approx(lab.report.error.def_, rel=0.01)
    assert len(plots.def_.marks["B"][0].getData()[0]) == 1
    assert len(plots.size.marks["A"][0].getData()[0]) == 0


def test_the_dot_follows_the_knob_and_the_lines_stay(qtbot, lab, document):
    lines = lab.plots.def_.points_of("b 9")
    document.execute(SetCodecSettings(paper(fdf=20, bits=9, encoder=Encoder.PAPER)))
    assert lab.plots.size.marks["B"][0].getData()[0][0] == 20
    assert not lab.plots.busy
    assert lab.plots.def_.points_of("b 9") == lines
    document.execute(SetCodecSettings(paper(segment=30, encoder=Encoder.PAPER)))
    assert lab.plots.busy
    settled(qtbot, lab)
    assert lab.plots.def_.points_of("b 9") != lines


def test_lines_of_one_motion_are_not_shown_for_another(qtbot, lab, document):
    before = lab.plots.def_.points_of("b 8")
    document.execute(AddClip(Clip("other", walker(70, seed=9))))
    assert lab.plots.def_.points_of("b 8") == []
    settled(qtbot, lab)
    assert lab.plots.def_.points_of("b 8") != before


def test_a_dot_of_the_front_loads_its_settings_and_undo_takes_it_back(qtbot, lab, document):
    QTest.mouseClick(lab.plots.find, Qt.MouseButton.LeftButton)
    assert lab.plots.progress.isVisible()
    settled(qtbot, lab)
    points = lab.plots.front.points
    assert len(lab.plots.pareto.dots.points()) == len(points) > 3
    lab.plots.pareto.dots.sigClicked.emit(lab.plots.pareto.dots, [lab.plots.pareto.dots.points()[2]], None)
    assert document.state.codec == points[2].settings
    document.undo()
    assert document.state.codec == PAPER


def test_best_trade_off_loads_the_knee(qtbot, lab, document):
    QTest.mouseClick(lab.plots.best, Qt.MouseButton.LeftButton)
    settled(qtbot, lab)
    assert document.state.codec == lab.plots.front.knee.settings
    assert "Best trade-off" in lab.plots.words.text()


def test_a_search_can_be_stopped_and_loads_nothing_then(qtbot, lab, document):
    QTest.mouseClick(lab.plots.best, Qt.MouseButton.LeftButton)
    QTest.mouseClick(lab.plots.find, Qt.MouseButton.LeftButton)
    settled(qtbot, lab)
    assert not lab.plots.progress.isVisible()
    assert document.state.codec == PAPER


def ask_target(qtbot, lab, kind, value):
    lab.open_target()
    dialog = lab.findChildren(TargetDialog)[-1]
    dialog.kind.setCurrentIndex(kind)
    dialog.value.setValue(value)
    dialog.start()
    qtbot.waitUntil(lambda: not dialog.search.running, timeout=60_000)
    return dialog


def test_a_target_that_can_be_met_is_met_and_can_be_used(qtbot, lab, document):
    dialog = ask_target(qtbot, lab, kind=3, value=5.0)  # a mean error
    assert dialog.answer.property("kind") == "info"
    QTest.mouseClick(dialog.use, Qt.MouseButton.LeftButton)
    settled(qtbot, lab)
    assert lab.report.settings == document.state.codec
    assert document.state.codec.coding.encoder is Encoder.PAPER
    assert lab.report.error.mean_mm <= 5.0


def test_a_size_is_kept_within(qtbot, lab, document):
    raw = 4 * document.state.active_clip.motion.X.size
    dialog = ask_target(qtbot, lab, kind=0, value=0.6 * raw / 1024)
    QTest.mouseClick(dialog.use, Qt.MouseButton.LeftButton)
    settled(qtbot, lab)
    assert lab.report.size.payload.bytes <= 0.6 * raw
    assert lab.report.error.def_ > 0


def test_a_target_that_cannot_be_met_says_so_and_what_is_best(qtbot, lab):
    dialog = ask_target(qtbot, lab, kind=0, value=0.5)
    assert "cannot be met" in dialog.answer.title.text()
    assert "FDF" in dialog.answer.title.text()
    assert dialog.use.isEnabled()
    dialog.kind.setCurrentIndex(1)
    assert not dialog.answer.isVisible()
    assert not dialog.use.isEnabled()
    dialog.reject()


def test_the_papers_grid_optimum_is_searched_for_and_loaded(qtbot, lab, document):
    lab.head.presets.optimum_wanted.emit()
    qtbot.waitUntil(lambda: not lab.optimum.running, timeout=60_000)
    assert document.state.codec.coding.encoder is Encoder.PAPER
    assert document.state.codec.coding.fdf in range(1, 27, 5)
    assert document.state.codec.coding.segment % 30 == 0 != document.state.codec.coding.segment


def trigger(button, text):
    button.fill()
    next(action for action in button.menu().actions() if action.text().replace("&", "") == text).trigger()


def test_built_in_presets_are_loaded_and_named(lab, document):
    presets = lab.head.presets
    trigger(presets, "Balanced")
    assert document.state.codec == paper()
    assert "Balanced" in presets.text()
    lab.knobs.paper.bits.slider.setValue(4)
    assert "Balanced" not in presets.text()
    document.undo()
    trigger(presets, "Paper Table 1: FDF 6, b 8, one segment")
    assert document.state.codec == PAPER


def test_own_presets_are_saved_loaded_renamed_and_removed(qtbot, lab, document, monkeypatch, tmp_path):
    presets = lab.head.presets
    presets._ask_name = lambda parent, suggested: "mine"
    fine = paper(fdf=30, bits=11)
    document.execute(SetCodecSettings(fine))
    trigger(presets, "Save as preset…")
    assert PresetShelf().own() == [Preset("mine", fine)]
    document.undo()
    trigger(presets, "mine")
    assert document.state.codec == fine
    host = QWidget()
    qtbot.addWidget(host)
    dialog = PresetDialog(presets.shelf, host, ask_name=lambda parent, suggested: "ours")
    dialog.buttons["rename"].click()
    assert [preset.name for preset in PresetShelf().own()] == ["ours"]
    path = tmp_path / "out.json"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    dialog.buttons["export"].click()
    dialog.buttons["reset"].click()
    assert PresetShelf().own() == []
    dialog.buttons["import"].click()
    assert PresetShelf().own() == [Preset("ours", fine)]
    path.write_text("{}")
    dialog.buttons["import"].click()
    assert not dialog.notice.isHidden()
    assert all(button.toolTip() and button.accessibleName() for button in dialog.buttons.values())


def test_a_preset_goes_to_the_side_whose_knobs_are_shown(lab, document):
    lab.edit_side(Side.A)
    trigger(lab.head.presets, "Smallest")
    assert document.state.codec_a == paper(fdf=0)
    assert document.state.codec == PAPER


def test_every_control_of_the_plots_and_dialogs_has_a_tip_and_a_name(lab):
    lab.open_target()
    dialog = lab.findChildren(TargetDialog)[-1]
    controls = [lab.plots.best, lab.plots.find, lab.plots.target, lab.head.presets]
    controls += [dialog.kind, dialog.value, dialog.find, dialog.use, dialog.close_button]
    assert all(control.toolTip() and control.accessibleName() for control in controls)
    dialog.reject()
