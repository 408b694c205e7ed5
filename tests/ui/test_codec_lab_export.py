"""Export QMD: one click writes the very bytes that were measured."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from qmd_studio.motion.metrics import measure
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip, SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.registry import open_file
from qmd_studio.ui.codec_lab import CodecLab
from tests.generated_motion import walker
from tests.paper_settings import paper


class Asked:
    """Stands for the user at the file dialog."""

    def __init__(self):
        self.suggested, self.answer = [], None

    def __call__(self, parent, suggested):
        self.suggested.append(suggested)
        return self.answer


@pytest.fixture
def asked():
    return Asked()


@pytest.fixture
def document(tmp_path):
    document = Document()
    document.execute(AddClip(Clip("walk", walker(100), path=tmp_path / "walk.bvh")))
    return document


@pytest.fixture
def lab(qtbot, document, asked):
    lab = CodecLab(document, Playhead(100, 120.0), ask_path=asked)
    lab.exported = []
    lab.export_bar.exported.connect(lab.exported.append)
    qtbot.addWidget(lab)
    lab.show()
    yield lab
    lab.close_down()


def click(lab, modifier=Qt.KeyboardModifier.NoModifier):
    QTest.mouseClick(lab.export_bar.button, Qt.MouseButton.LeftButton, modifier)


def settled(qtbot, lab):
    qtbot.waitUntil(lambda: not lab.pending, timeout=30_000)


def link(lab, text):
    return next(b for b in lab.export_bar.notice.findChildren(QPushButton) if b.text() == text)


def test_one_click_writes_what_was_measured_and_it_opens_with_that_error(qtbot, lab, document, asked, tmp_path):
    settled(qtbot, lab)
    click(lab)
    assert lab.exported == [tmp_path / "walk__fdf6_b8_nd99.qmd"]
    assert lab.exported[0].read_bytes() == lab.report.data
    assert asked.suggested == []
    original, decoded = document.state.active_clip.motion, open_file(lab.exported[0]).motion
    error = measure(original, decoded.__class__(original.skeleton, decoded.X, decoded.fps))
    assert error.def_ == pytest.approx(lab.report.error.def_, rel=1e-3)
    assert error.max_mm == pytest.approx(lab.report.error.max_mm, rel=1e-3)


def test_a_click_before_the_measurement_waits_for_it(qtbot, lab, document, tmp_path):
    settled(qtbot, lab)
    document.execute(SetCodecSettings(paper(fdf=12, bits=10, segment=30)))
    lab.export()  # unlike a click, this lets no result in meanwhile
    assert lab.exported == []
    assert lab.export_bar.notice.isVisible()
    settled(qtbot, lab)
    assert lab.exported == [tmp_path / "walk__fdf12_b10_nd30.qmd"]
    assert lab.exported[0].read_bytes() == lab.report.data


def test_settings_changed_while_it_waits_are_those_that_are_written(qtbot, lab, document, tmp_path):
    settled(qtbot, lab)
    document.execute(SetCodecSettings(paper(bits=12)))
    lab.export()
    document.execute(SetCodecSettings(paper(fdf=3)))
    settled(qtbot, lab)
    assert [path.name for path in lab.exported] == ["walk__fdf3_b8_nd99.qmd"]
    assert lab.exported[0].read_bytes() == lab.report.data


def test_a_different_file_of_that_name_is_never_lost(qtbot, lab, tmp_path):
    taken = tmp_path / "walk__fdf6_b8_nd99.qmd"
    taken.write_bytes(b"somebody's own")
    settled(qtbot, lab)
    click(lab)
    assert lab.exported[0].name == "walk__fdf6_b8_nd99-2.qmd"
    assert taken.read_bytes() == b"somebody's own"
    click(lab)
    assert "Already there" in lab.export_bar.notice.title.text()
    assert len(list(tmp_path.glob("*.qmd"))) == 2


def test_success_is_told_in_place_and_the_file_can_be_opened_from_there(qtbot, lab):
    settled(qtbot, lab)
    click(lab)
    notice = lab.export_bar.notice
    assert "KB" in notice.title.text()
    assert notice.text.text() == "walk__fdf6_b8_nd99.qmd"
    with qtbot.waitSignal(lab.reopen_wanted) as caught:
        link(lab, "Open it").click()
    assert caught.args == lab.exported


def test_shift_and_click_asks_for_a_name_and_may_be_called_off(qtbot, lab, asked, tmp_path):
    settled(qtbot, lab)
    click(lab, Qt.KeyboardModifier.ShiftModifier)
    assert asked.suggested == [tmp_path / "walk__fdf6_b8_nd99.qmd"]
    assert lab.exported == []
    asked.answer = tmp_path / "mine.qmd"
    click(lab, Qt.KeyboardModifier.ShiftModifier)
    assert lab.exported == [tmp_path / "mine.qmd"]
    assert asked.answer.read_bytes() == lab.report.data


def test_where_the_clips_folder_is_gone_it_asks(qtbot, document, lab, asked, tmp_path):
    document.execute(AddClip(Clip("lost", walker(30), path=tmp_path / "gone" / "lost.bvh")))
    asked.answer = tmp_path / "found.qmd"
    settled(qtbot, lab)
    click(lab)
    assert asked.suggested[0].name == "lost__fdf6_b8_nd29.qmd"
    assert lab.exported == [tmp_path / "found.qmd"]


def test_a_failure_is_told_in_place_with_another_way(qtbot, lab, asked, tmp_path):
    settled(qtbot, lab)
    asked.answer = tmp_path / "gone" / "walk.qmd"
    lab.export_as()
    notice = lab.export_bar.notice
    assert notice.property("kind") == "error"
    assert "gone" in notice.text.text()
    assert lab.exported == []
    asked.answer = tmp_path / "walk.qmd"
    link(lab, "Export QMD as…").click()
    assert lab.exported == [tmp_path / "walk.qmd"]
