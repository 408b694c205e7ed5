"""Profiles, bounds, reductions and the device in the real window: what is set is what is measured and written."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QPushButton

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip, SetCodecSettings
from qmd_studio.project.state import Side
from qmd_studio.registry import open_file
from qmd_studio.tuning.budget import budget_of_file, device
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.ui.preset_menu import PresetShelf
from qmd_studio.ui.quantity import kilobytes, millimetres
from qmd_studio.ui.view import View
from tests.generated_motion import walker
from tests.paper_settings import paper


def settled(qtbot, window):
    qtbot.waitUntil(lambda: not window.lab.pending, timeout=60_000)


@pytest.fixture
def lab_window(qtbot, window, tmp_path):
    window.lab.head.presets.shelf = PresetShelf(tmp_path / "presets")
    window.document.execute(AddClip(Clip("walk", walker(150), path=tmp_path / "walk.bvh")))
    settled(qtbot, window)
    return window


def press(button):
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def choose(window, bar, key):
    button = bar.button(str(key))
    window.lab.findChild(type(button))
    button.click()


def test_the_compact_profile_is_measured_shown_exported_and_reopened(qtbot, lab_window, tmp_path):
    lab, document = lab_window.lab, lab_window.document
    choose(lab_window, lab.knobs.profile, "compact")
    assert document.state.codec == EncodeSettings(COMPACT_DEFAULT)
    assert lab.knobs.compact.isVisible()
    assert not lab.knobs.paper.isVisible()
    settled(qtbot, lab_window)
    report, figures = lab.report, lab.sides[Side.B].figures
    assert report.settings.coding == COMPACT_DEFAULT
    assert figures.size.value.text() == kilobytes(describe(report.data)["payload_bytes"])
    assert figures.mean.value.text() == millimetres(report.error.mean_mm)
    assert millimetres(report.error.mean_mm) in lab.knobs.compact.error.meaning.text()
    parts = [part for part, _ in lab.sides[Side.B].breakdown.bar.rectangles()]
    assert sum(part.n_bytes for part in parts) == len(report.data)
    assert "Exact columns" not in {part.name for part in parts}
    lab_window.export_qmd()
    path = tmp_path / "walk__compact_mean0.5mm_seg120.qmd"
    assert path.read_bytes() == report.data
    original, opened = document.state.active_clip.motion, open_file(path).motion
    assert measure(original, original.with_values(opened.X)).mean_mm == pytest.approx(report.error.mean_mm, rel=1e-3)
    before = len(document.state.clips)
    press(next(b for b in lab.export_bar.notice.findChildren(QPushButton) if b.text() == "Open it"))
    qtbot.waitUntil(lambda: len(document.state.clips) > before, timeout=10_000)


def test_the_knobs_of_the_compact_profile_ask_for_either_error_and_either_cut(qtbot, lab_window):
    lab, document = lab_window.lab, lab_window.document
    knobs = lab.knobs.compact
    choose(lab_window, lab.knobs.profile, "compact")
    choose(lab_window, knobs.measure, "worst")
    assert document.state.codec.coding == CompactSettings(max_error_mm=2.0, segment=120)
    knobs.error.spin.setValue(0.8)
    choose(lab_window, knobs.cut, "whole")
    assert document.state.codec.coding == CompactSettings(max_error_mm=0.8)
    settled(qtbot, lab_window)
    assert lab.report.error.max_mm <= 0.8
    assert describe(lab.report.data)["segments"] == 1
    for _ in range(4):
        document.undo()
    assert document.state.codec == EncodeSettings()
    assert lab.knobs.paper.isVisible()


def test_going_to_and_fro_between_the_profiles_keeps_the_knobs_of_each(lab_window):
    knobs, document = lab_window.lab.knobs, lab_window.document
    knobs.paper.bits.slider.setValue(2)
    choose(lab_window, knobs.profile, "compact")
    knobs.compact.error.spin.setValue(0.3)
    choose(lab_window, knobs.profile, "paper")
    assert document.state.codec.coding == QmdSettings(bits=10)
    choose(lab_window, knobs.profile, "compact")
    assert document.state.codec.coding.mean_error_mm == 0.3


def test_a_drag_of_the_error_is_one_step_of_undo(lab_window):
    knobs, document = lab_window.lab.knobs, lab_window.document
    choose(lab_window, knobs.profile, "compact")
    slider, history = knobs.compact.error.slider, len(document.history)
    slider.setSliderDown(True)
    for place in range(5, 25, 2):
        slider.setValue(place)
    slider.setSliderDown(False)
    assert document.state.codec.coding.mean_error_mm == 2.0
    assert len(document.history) == history + 1
    document.undo()
    assert knobs.compact.error.spin.value() == 0.5


def test_compact_and_paper_are_compared_on_the_body(qtbot, lab_window):
    lab, document = lab_window.lab, lab_window.document
    document.execute(SetCodecSettings(paper(encoder=Encoder.PAPER), side=Side.A))
    document.execute(SetCodecSettings(EncodeSettings(COMPACT_DEFAULT)))
    settled(qtbot, lab_window)
    lab_window.views.show_view(View.WIPE)
    lab_window.views.show_heat(True)
    comparison = lab_window.views.comparison
    assert comparison.tags[Side.B].text() == "B  Compact, mean 0.5 mm"
    assert comparison.legend.isVisible()
    a, b = lab.sides[Side.A].report, lab.sides[Side.B].report
    expected = measure(a.played, b.played).max_mm
    assert millimetres(expected).split()[0] in lab_window.strip.accessibleDescription()


def test_a_bound_is_kept_and_what_was_found_for_it_is_told(qtbot, lab_window, tmp_path):
    lab, document = lab_window.lab, lab_window.document
    choose(lab_window, lab.knobs.paper.encoder, Encoder.BOUNDED)
    assert lab.knobs.paper.bound.isVisible()
    assert not lab.knobs.paper.fdf.isVisible()
    lab.knobs.paper.bound.spin.setValue(3.0)
    settled(qtbot, lab_window)
    assert document.state.codec.coding.max_error_mm == 3.0
    assert lab.report.error.max_mm <= 3.0
    facts = describe(lab.report.data)
    assert f"FDF {facts['fdf']}, b {facts['bits']}" in lab.knobs.paper.bound.meaning.text()
    assert lab.sides[Side.B].figures.size.value.text() == kilobytes(facts["payload_bytes"])
    lab_window.export_qmd()
    assert (tmp_path / "walk__within3mm.qmd").read_bytes() == lab.report.data
    choose(lab_window, lab.knobs.paper.encoder, Encoder.CLOSED)
    assert lab.knobs.paper.fdf.value == document.state.codec.coding.fdf


@pytest.mark.parametrize(
    "settings",
    [paper(encoder=Encoder.BOUNDED, max_error_mm=0.0001), EncodeSettings(CompactSettings(max_error_mm=0.0001))],
)
def test_what_cannot_be_met_is_said_beside_the_knob_and_the_best_can_be_taken(qtbot, lab_window, settings):
    lab, document = lab_window.lab, lab_window.document
    document.execute(SetCodecSettings(settings))
    settled(qtbot, lab_window)
    knob = lab.knobs.paper.bound if settings.paper else lab.knobs.compact.error
    assert "cannot be met; the best reachable is" in knob.meaning.text()
    assert "Side B cannot keep to this" in lab.problem.title.text()
    assert lab.sides[Side.B].figures.size.value.text() == "–"
    press(next(b for b in lab.problem.findChildren(QPushButton) if b.text().startswith("Allow ")))
    settled(qtbot, lab_window)
    assert document.state.codec.coding.max_error_mm > settings.coding.max_error_mm
    assert not lab.problem.isVisible()
    assert lab.report is not None


@pytest.fixture
def slow_window(qtbot, lab_window, monkeypatch):
    """A window whose bounded encoder goes on until it is stopped."""
    from qmd_studio.codecs.qmd import bounded_fit

    whole = bounded_fit.Fitter._run

    def slow(fitter, *arguments, **how):
        run = whole(fitter, *arguments, **how)
        while not fitter._cancel.wait(0.01):
            pass
        return whole(fitter, *arguments, **how) and run

    monkeypatch.setattr(bounded_fit.Fitter, "_run", slow)
    lab_window.document.execute(SetCodecSettings(paper(encoder=Encoder.BOUNDED, max_error_mm=0.5)))
    return lab_window


def test_what_takes_long_shows_progress_and_can_be_stopped_and_begun_again(qtbot, slow_window):
    lab = slow_window.lab
    waiting, figures = lab.sides[Side.B].waiting, lab.sides[Side.B].figures
    assert "looking for" in lab.knobs.paper.bound.meaning.text()
    qtbot.waitUntil(waiting.isVisible, timeout=10_000)
    assert waiting.progress.isVisible()
    assert "Encoding B" in waiting.words.text()
    press(waiting.button)
    assert not lab.pending
    assert figures.def_.value.text() == "–"
    assert "not measured" in waiting.words.text()
    assert lab.knobs.paper.bound.meaning.text() == ""
    press(waiting.button)
    assert lab.pending
    slow_window.document.undo()
    settled(qtbot, slow_window)
    assert lab.report.settings == EncodeSettings()
    assert not waiting.isVisible()


def test_a_newer_setting_stops_what_is_under_way(qtbot, slow_window):
    lab, document = slow_window.lab, slow_window.document
    document.execute(SetCodecSettings(paper(encoder=Encoder.BOUNDED, max_error_mm=0.7)))
    document.execute(SetCodecSettings(paper(fdf=3)))
    settled(qtbot, slow_window)
    assert lab.report.settings == paper(fdf=3)


def test_export_measures_what_was_stopped(qtbot, slow_window, monkeypatch, tmp_path):
    lab = slow_window.lab
    lab.sides[Side.B].stop()
    slow_window.document.execute(SetCodecSettings(EncodeSettings(COMPACT_DEFAULT)))
    lab.sides[Side.B].stop()
    lab.export()
    settled(qtbot, slow_window)
    assert list(tmp_path.glob("walk__compact*.qmd"))


def test_closing_the_window_ends_a_search_for_a_bound(qtbot, slow_window):
    assert slow_window.lab.pending
    slow_window.close()
    assert not slow_window.lab.pending


def test_fewer_frames_and_joints_are_in_size_error_and_file(qtbot, lab_window, tmp_path):
    lab, document = lab_window.lab, lab_window.document
    whole = lab.report
    knobs = lab.knobs.reduction
    assert knobs.fold.text() == "Frame rate and joints: all kept"
    assert not knobs.every.isVisible()
    press(knobs.fold)
    knobs.every.spin.setValue(3)
    figures = lab.sides[Side.B].figures
    at_once = figures.size.value.text()
    settled(qtbot, lab_window)
    assert at_once == figures.size.value.text() == kilobytes(lab.report.size.payload.bytes)
    assert lab.report.size.payload.bytes < 0.45 * whole.size.payload.bytes
    assert lab.report.error.mean_mm > whole.error.mean_mm
    assert "50 of 150 frames, 40 fps" in knobs.every.meaning.text()
    knobs.level.slider.setValue(4)
    settled(qtbot, lab_window)
    reduction = Reduction(3, 5)
    assert document.state.codec == EncodeSettings(reduction=reduction)
    assert lab.knobs.paper.fdf.spin.maximum() == reduction.n_columns(document.state.active_clip.motion.skeleton)
    assert "K 3, L 5" in lab.head.buttons[Side.B].text()
    lab_window.export_qmd()
    opened = open_file(tmp_path / "walk__fdf6_b8_nd49_every3_level5.qmd").motion
    assert (opened.n_frames, opened.fps) == (50, 40.0)
    assert (tmp_path / "walk__fdf6_b8_nd49_every3_level5.qmd").read_bytes() == lab.report.data
    assert lab_window.stage.has_decoded


def test_a_side_that_is_copied_takes_profile_and_reduction_along(qtbot, lab_window):
    lab, document = lab_window.lab, lab_window.document
    settings = EncodeSettings(CompactSettings(mean_error_mm=0.2), Reduction(2))
    document.execute(SetCodecSettings(settings))
    press(lab.head.copy)
    assert document.state.codec_a == settings
    settled(qtbot, lab_window)
    assert lab.sides[Side.B].figures.def_.change.text() == "="
    document.undo()
    assert document.state.codec_a is None


def test_a_preset_keeps_profile_and_reduction(lab_window):
    lab, document = lab_window.lab, lab_window.document
    settings = EncodeSettings(CompactSettings(max_error_mm=1.5), Reduction(2, 5))
    document.execute(SetCodecSettings(settings))
    lab.head.presets._ask_name = lambda parent, suggested: "small"
    lab.head.presets.save()
    document.undo()
    assert [preset.settings for preset in lab.head.presets.shelf.own()] == [settings]
    lab.head.presets.fill()
    next(a for a in lab.head.presets.menu().actions() if a.text() == "small").trigger()
    assert document.state.codec == settings
    assert "small" in lab.head.presets.text()


def test_a_body_with_articulation_is_cut_by_level_of_articulation(qtbot, lab_window):
    skeleton = bap_skeleton()
    walk = walker(40).X
    body = Motion(skeleton, walk[:, :1].repeat(skeleton.n_columns, axis=1) * 0.1, 25.0)
    lab_window.document.execute(AddClip(Clip("gesture", body)))
    settled(qtbot, lab_window)
    knobs = lab_window.lab.knobs.reduction
    press(knobs.fold)
    assert "LOA" in knobs.level.label.text()
    knobs.level.slider.setValue(1)
    assert lab_window.document.state.codec.reduction == Reduction(max_loa=1)
    knobs.level.slider.setValue(3)
    assert lab_window.document.state.codec.reduction == Reduction()
    settled(qtbot, lab_window)


def test_the_budget_is_that_of_the_file_on_the_device_which_is_remembered(qtbot, lab_window, make_window):
    lab, document = lab_window.lab, lab_window.document
    document.execute(SetCodecSettings(EncodeSettings(COMPACT_DEFAULT)))
    settled(qtbot, lab_window)
    panel, name = lab.budget, "cortex-m0"
    panel.chooser.setCurrentIndex(panel.chooser.findData(name))
    budget, board = budget_of_file(lab.report.data), device(name)
    shown = {row: panel.cells[row, Side.B].text() for row in ("file", "ram", "work", "load")}
    assert shown["file"] == kilobytes(len(lab.report.data))
    assert shown["work"] == f"{budget.instructions_per_frame:,.0f}"
    assert shown["ram"].startswith(kilobytes(budget.ram_on(board)))
    assert float(shown["load"].removesuffix(" %")) == pytest.approx(100 * budget.load_on(board, 120.0), rel=0.06)
    assert {panel.cells[row, Side.A].text() for row in shown} == {"–"}
    assert make_window().lab.budget.device.name == name


def test_every_new_control_has_a_tip_and_a_name_and_the_lab_stays_narrow(qtbot, lab_window):
    lab = lab_window.lab
    knobs = lab.knobs
    press(knobs.reduction.fold)
    controls = [knobs.reduction.fold, lab.budget.chooser, lab.plots.reduced]
    for knob in (knobs.reduction.every, knobs.reduction.level, knobs.compact.error, knobs.paper.bound):
        controls += [knob.slider, knob.spin]
    for bar, keys in (
        (knobs.profile, ("paper", "compact")),
        (knobs.compact.measure, ("mean", "worst")),
        (knobs.compact.cut, ("segments", "whole")),
        (knobs.paper.encoder, Encoder),
    ):
        controls += [bar.button(str(key)) for key in keys]
    assert all(control.toolTip() and control.accessibleName() for control in controls)
    lab.resize(340, 700)
    for settings in (EncodeSettings(COMPACT_DEFAULT, Reduction(2, 5)), paper(encoder=Encoder.BOUNDED)):
        lab_window.document.execute(SetCodecSettings(settings))
        settled(qtbot, lab_window)
        assert lab.knobs.minimumSizeHint().width() <= 316
    assert not [label for label in lab.findChildren(QLabel) if label.text() == "None"]
