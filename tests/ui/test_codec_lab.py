"""The codec lab as a user meets it: sizes at once, errors in a moment, one step of undo a drag."""

import itertools

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QScrollArea, QStyle, QStyleOptionSlider

from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import ActivateClip, AddClip, RemoveClip, RenameClip, SetCodecSettings, SetLevels
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import Side
from qmd_studio.tuning.size_figures import size_figures
from qmd_studio.ui.codec_lab import CodecLab
from qmd_studio.ui.quantity import kilobytes
from qmd_studio.ui.view import View
from tests.generated_motion import walker
from tests.paper_settings import paper

DOCK = (340, 760)


@pytest.fixture
def document():
    return Document()


@pytest.fixture
def lab(qtbot, document):
    lab = CodecLab(document, Playhead(120, 120.0))
    lab.reports = []
    lab.side_measured.connect(lambda side, report: lab.reports.append(report))
    qtbot.addWidget(lab)
    lab.resize(*DOCK)
    lab.show()
    yield lab
    lab.close_down()


@pytest.fixture
def open_lab(qtbot, lab, document):
    document.execute(AddClip(Clip("walk", walker(120))))
    settled(qtbot, lab)
    return lab


def settled(qtbot, lab):
    qtbot.waitUntil(lambda: not lab.pending, timeout=30_000)


def handle(slider, place=None):
    """Where the middle of the handle is, or where it would be at another place."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    if place is not None:
        option.sliderPosition = place
    part = QStyle.SubControl.SC_SliderHandle
    return slider.style().subControlRect(QStyle.ComplexControl.CC_Slider, option, part, slider).center()


def drag(slider, place, steps=4):
    """Press the handle, draw it to `place` in some steps and let go."""
    start, end = handle(slider), handle(slider, place)
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=start)
    for step in range(1, steps + 1):
        QTest.mouseMove(slider, start + (end - start) * step / steps)
        yield slider.value()
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=end)


def wheel(widget, notches):
    centre = QPointF(widget.rect().center())
    event = QWheelEvent(
        centre, QPointF(widget.mapToGlobal(centre.toPoint())), QPoint(), QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(widget, event)


@pytest.mark.parametrize(
    ("knob", "field", "place"), [("fdf", "fdf", 30), ("bits", "bits", 5), ("segment", "segment", 8)]
)
def test_dragging_a_slider_shows_the_size_in_the_same_event_and_the_error_soon(
    qtbot, open_lab, document, knob, field, place
):
    slider, before = getattr(open_lab.knobs.paper, knob).slider, open_lab.sides[Side.B].figures.def_.value.text()
    motion, sizes = document.state.active_clip.motion, set()
    for _ in drag(slider, place):
        settings = document.state.codec.coding.checked(62, 119)
        shown = open_lab.sides[Side.B].figures.size.value.text()
        assert shown == kilobytes(size_figures(motion, settings).payload.bytes)
        sizes.add(shown)
    assert len(sizes) > 1
    assert getattr(document.state.codec.coding, field) != getattr(QmdSettings(), field)
    settled(qtbot, open_lab)
    assert open_lab.report.settings == document.state.codec
    assert open_lab.sides[Side.B].figures.def_.value.text() != before
    assert not open_lab.sides[Side.B].figures.stale


def test_a_held_slider_shows_drafts_and_letting_go_measures_exactly(qtbot, open_lab, document):
    slider, motion = open_lab.knobs.paper.fdf.slider, document.state.active_clip.motion
    open_lab.reports.clear()
    start = handle(slider)
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(slider, handle(slider, 20))
    settled(qtbot, open_lab)
    held = document.state.codec
    assert held.coding.fdf != QmdSettings().fdf
    assert [(report.settings, report.draft) for report in open_lab.reports] == [(held, True)]
    assert not open_lab.sides[Side.B].figures.stale
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=handle(slider, 20))
    settled(qtbot, open_lab)
    assert [report.draft for report in open_lab.reports] == [True, False]
    assert open_lab.report.data == encode(motion, held.coding).data
    assert open_lab.report.data != open_lab.reports[0].data
    assert open_lab.report.error.def_ < open_lab.reports[0].error.def_


def test_what_is_exported_is_never_a_draft(qtbot, open_lab, document, tmp_path, monkeypatch):
    monkeypatch.setattr("pathlib.Path.home", lambda: tmp_path)
    slider = open_lab.knobs.paper.fdf.slider
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=handle(slider))
    QTest.mouseMove(slider, handle(slider, 25))
    settled(qtbot, open_lab)
    open_lab.export()
    assert list(tmp_path.iterdir()) == []
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=handle(slider, 25))
    qtbot.waitUntil(lambda: any(tmp_path.iterdir()), timeout=30_000)
    (written,) = tmp_path.iterdir()
    assert written.read_bytes() == encode(document.state.active_clip.motion, document.state.codec.coding).data


@pytest.mark.parametrize("knob", ["fdf", "bits", "segment"])
def test_a_drag_is_one_step_of_undo_and_undo_brings_the_slider_back(open_lab, document, knob):
    slider, spin = getattr(open_lab.knobs.paper, knob).slider, getattr(open_lab.knobs.paper, knob).spin
    places, numbers, history = [slider.value()], [spin.value()], len(document.history)
    for place in (slider.maximum() // 2, slider.maximum() // 3):
        list(drag(slider, place))
        places.append(slider.value())
        numbers.append(spin.value())
    assert len(set(places)) == 3
    assert len(document.history) == history + 2
    for place, number in ((places[1], numbers[1]), (places[0], numbers[0])):
        document.undo()
        assert (slider.value(), spin.value()) == (place, number)
    document.redo()
    assert slider.value() == places[1]


def test_of_a_hundred_rapid_changes_few_are_measured_and_the_last_one_is_reported_last(qtbot, open_lab, document):
    open_lab.reports.clear()
    for step in range(100):
        document.execute(SetCodecSettings(paper(fdf=step % 60, bits=8 + step % 7), drag="fdf"))
    assert open_lab.sides[Side.B].figures.stale
    settled(qtbot, open_lab)
    final = document.state.codec
    assert len(open_lab.reports) <= 3  # what had come meanwhile, what had begun, and the newest
    assert open_lab.report is open_lab.reports[-1]
    assert not open_lab.sides[Side.B].figures.stale
    assert open_lab.report.data == encode(document.state.active_clip.motion, final.coding).data


def test_figures_are_those_of_the_report(open_lab):
    report, figures = open_lab.report, open_lab.sides[Side.B].figures
    assert f"frame {report.error.worst_frame}" in figures.go.property("whole")
    assert report.error.worst_joint in figures.go.property("whole")
    assert float(figures.def_.value.text()) == pytest.approx(report.error.def_, rel=0.1)
    assert float(figures.mean.value.text().removesuffix(" mm")) == pytest.approx(
        report.error.mean_mm, rel=0.01, abs=1e-4
    )
    assert float(figures.worst.value.text().removesuffix(" mm")) == pytest.approx(
        report.error.max_mm, rel=0.01, abs=1e-4
    )
    assert "ASF" in figures.def_.toolTip()


def test_clicking_the_worst_goes_to_its_frame(qtbot, document):
    playhead = Playhead(120, 120.0)
    lab = CodecLab(document, playhead)
    qtbot.addWidget(lab)
    lab.show()
    document.execute(AddClip(Clip("walk", walker(120))))
    settled(qtbot, lab)
    playhead.playing = True
    QTest.mouseClick(lab.sides[Side.B].figures.go, Qt.MouseButton.LeftButton)
    assert playhead.index == lab.report.error.worst_frame
    assert not playhead.playing
    lab.close_down()


def test_the_bar_accounts_for_every_byte_of_the_file(open_lab):
    parts = [part for part, _ in open_lab.sides[Side.B].breakdown.bar.rectangles()]
    assert sum(part.n_bytes for part in parts) == len(open_lab.report.data)
    payload = [part for part in parts if not part.around]
    assert sum(part.n_bytes for part in payload) == open_lab.report.size.payload.bytes
    areas = [area for part, area in open_lab.sides[Side.B].breakdown.bar.rectangles()]
    assert all(a.right() <= b.left() + 1e-6 for a, b in itertools.pairwise(areas))
    assert areas[-1].right() <= open_lab.sides[Side.B].breakdown.bar.width() + 1e-6


def test_the_bar_is_painted_in_the_colours_of_its_legend(open_lab):
    bar = open_lab.sides[Side.B].breakdown.bar
    image = bar.grab().toImage()
    for part, area in bar.rectangles():
        if area.width() > 4 and not part.around:
            point = area.center() * image.devicePixelRatio()
            assert image.pixelColor(point.toPoint()) == part.colour


def test_the_exact_columns_are_named(open_lab, document):
    assert open_lab.knobs.paper.fdf.meaning.text() == "exact: root"
    document.execute(SetCodecSettings(paper(fdf=8)))
    assert open_lab.knobs.paper.fdf.meaning.text() == "exact: root, lowerback rx ry"
    document.execute(SetCodecSettings(paper(fdf=62)))
    assert open_lab.knobs.paper.fdf.meaning.text() == "exact: all 62 columns"


def test_the_spin_box_takes_every_number_and_the_word_for_one_segment(open_lab, document):
    spin = open_lab.knobs.paper.segment.spin
    spin.setFocus()
    spin.selectAll()
    QTest.keyClicks(spin, "37")
    QTest.keyClick(spin, Qt.Key.Key_Return)
    assert document.state.codec.coding.segment == 37
    spin.selectAll()
    QTest.keyClicks(spin, "one")
    QTest.keyClick(spin, Qt.Key.Key_Return)
    assert document.state.codec.coding.segment == 0
    assert spin.text() == "one segment"


def test_wheel_and_arrows_step_by_one_and_a_burst_is_one_undo(open_lab, document):
    slider, history = open_lab.knobs.paper.bits.slider, len(document.history)
    wheel(slider, 1)
    assert document.state.codec.coding.bits == 9
    wheel(slider, 1)
    QTest.keyClick(slider, Qt.Key.Key_Right)
    assert document.state.codec.coding.bits == 11
    assert len(document.history) == history + 1


def test_a_double_click_resets_a_knob_and_can_be_undone(open_lab, document):
    document.execute(SetCodecSettings(paper(fdf=20, bits=12)))
    QTest.mouseDClick(open_lab.knobs.paper.fdf.slider, Qt.MouseButton.LeftButton)
    assert document.state.codec == paper(bits=12)
    QTest.mouseDClick(open_lab.knobs.paper.bits.label, Qt.MouseButton.LeftButton)
    assert document.state.codec == paper()
    document.undo()
    assert open_lab.knobs.paper.bits.value == 12


def test_the_papers_constants_are_shown_for_the_papers_encoder_only(qtbot, open_lab, document):
    assert not open_lab.knobs.paper.constants.isVisible()
    open_lab.knobs.paper.encoder.button(str(Encoder.PAPER)).click()
    assert open_lab.knobs.paper.constants.isVisible()
    open_lab.knobs.paper.k.setValue(2)
    assert document.state.codec.coding.encoder is Encoder.PAPER
    assert document.state.codec.coding.k == 2.0
    settled(qtbot, open_lab)
    assert open_lab.report.settings.coding.k == 2.0
    open_lab.knobs.paper.k.stepBy(100)
    assert document.state.codec.coding.k == np.inf
    assert open_lab.knobs.paper.k.text() == "∞"


def test_settings_too_large_for_a_clip_are_fitted_and_kept_for_the_next(qtbot, lab, document):
    document.execute(SetCodecSettings(paper(fdf=200, segment=500)))
    document.execute(AddClip(Clip("walk", walker(60))))
    settled(qtbot, lab)
    assert (lab.knobs.paper.fdf.value, lab.knobs.paper.segment.spin.text()) == (62, "one segment")
    assert lab.report.settings == paper(fdf=62)
    assert document.state.codec.coding.fdf == 200


def test_another_clip_clears_the_report_until_its_own_is_there(qtbot, open_lab, document):
    cleared = []
    open_lab.side_cleared.connect(cleared.append)
    document.execute(AddClip(Clip("other", walker(40))))
    assert cleared == [Side.B]
    assert open_lab.report is None
    settled(qtbot, open_lab)
    assert open_lab.report.decoded.n_frames == 40
    document.execute(ActivateClip(1))
    assert open_lab.report.decoded.n_frames == 120


def test_a_new_name_measures_nothing_anew(open_lab, document):
    open_lab.reports.clear()
    document.execute(RenameClip(1, "stroll"))
    assert not open_lab.pending
    assert open_lab.reports == []


def test_new_levels_are_measured(qtbot, open_lab, document):
    open_lab.knobs.paper.encoder.button(str(Encoder.PAPER)).click()
    settled(qtbot, open_lab)
    before = open_lab.report
    document.execute(SetLevels(1, tuple((c.name, 6) for c in before.decoded.skeleton.columns[:12])))
    settled(qtbot, open_lab)
    assert open_lab.report.data != before.data


def test_with_nothing_open_the_panel_says_what_to_do(qtbot, open_lab, document):
    document.execute(RemoveClip(1))
    words = " ".join(label.text() for label in open_lab.findChildren(QLabel) if label.isVisible())
    assert "Open a BVH" in words
    assert open_lab.report is None
    document.undo()
    settled(qtbot, open_lab)
    assert open_lab.knobs.isVisible()


def test_a_motion_of_one_frame_has_figures_too(qtbot, lab, document):
    document.execute(AddClip(Clip("pose", walker(1))))
    settled(qtbot, lab)
    assert lab.report is not None
    assert lab.sides[Side.B].figures.worst.value.text() in ("0 mm", "< 0.0001 mm")  # what float32 leaves of a metre


def test_a_motion_without_columns_is_told_beside_the_knobs(qtbot, lab, document):
    from qmd_studio.motion.skeleton import Joint, Skeleton, SkeletonKind

    still = Skeleton("still", SkeletonKind.BVH, (Joint("root", -1, (0.0, 0.0, 0.0)),), (), (), (0,))
    document.execute(AddClip(Clip("still", Motion(still, np.zeros((5, 0)), 30.0))))
    settled(qtbot, lab)
    assert lab.problem.isVisible()
    assert "no column" in lab.problem.text.text()
    document.execute(AddClip(Clip("walk", walker(20))))
    settled(qtbot, lab)
    assert not lab.problem.isVisible()


def test_it_fits_a_narrow_dock_whatever_the_names(qtbot, lab, document):
    skeleton = bap_skeleton()
    values = np.cumsum(np.random.default_rng(5).normal(0, 0.01, (30, skeleton.n_columns)), axis=0)
    document.execute(AddClip(Clip("gesture", Motion(skeleton, values, 25.0))))
    document.execute(SetCodecSettings(paper(fdf=150, encoder=Encoder.PAPER)))
    settled(qtbot, lab)
    area = lab.findChild(QScrollArea)
    assert area.widget().minimumSizeHint().width() <= DOCK[0] - area.verticalScrollBar().sizeHint().width()
    assert area.widget().width() <= area.viewport().width()
    assert lab.knobs.paper.fdf.meaning.toolTip() == lab.knobs.paper.fdf.meaning.text() != ""


def test_every_control_has_a_tip_and_a_name(open_lab):
    knobs, bar = open_lab.knobs.paper, open_lab.export_bar
    controls = [w for knob in (knobs.fdf, knobs.bits, knobs.segment) for w in (knob.slider, knob.spin)]
    controls += [knobs.k, knobs.rqt, open_lab.sides[Side.B].figures.go, bar.button, bar.more]
    controls += [open_lab.view.choices.button(view) for view in View] + [open_lab.view.heat]
    controls += [*open_lab.head.buttons.values(), open_lab.head.copy]
    controls += [open_lab.head.source.button(source) for source in ("original", "encoded")]
    assert all(control.toolTip() and control.accessibleName() for control in controls)


def test_the_view_is_chosen_by_button_or_by_the_window(open_lab):
    chosen = []
    open_lab.view_chosen.connect(chosen.append)
    open_lab.view.choices.button("ghost").click()
    assert open_lab.view.view is View.GHOST
    open_lab.view.show_view(View.B)
    assert open_lab.view.choices.button("b").isChecked()
    assert chosen == [View.GHOST]


def test_old_figures_are_dimmed_until_the_new_ones_come(qtbot, open_lab, document):
    value = open_lab.sides[Side.B].figures.def_.value
    words, plain = value.text(), value.grab().toImage()
    document.execute(SetCodecSettings(paper(fdf=9)))
    assert open_lab.sides[Side.B].figures.stale
    assert value.text() == words
    assert value.grab().toImage() != plain
    settled(qtbot, open_lab)
    document.undo()
    settled(qtbot, open_lab)
    assert value.grab().toImage() == plain
