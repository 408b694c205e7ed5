"""The level table: read, filter, edit, reset, copy, and apply as one step."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QAbstractItemModelTester
from PySide6.QtWidgets import QDialogButtonBox

from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip, SetLevels
from qmd_studio.project.document import Document
from qmd_studio.ui.levels_dialog import COLUMN, LEVEL, LevelsDialog
from tests.generated_motion import walker


@pytest.fixture
def document():
    document = Document()
    document.execute(AddClip(Clip("walk", walker(5))))
    return document


@pytest.fixture
def dialog(qtbot, document):
    dialog = LevelsDialog(document, 1)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, False)
    qtbot.addWidget(dialog)
    dialog.show()
    return dialog


def set_level(dialog, row, level):
    return dialog.shown.setData(dialog.shown.index(row, LEVEL), level)


def levels(document):
    return document.state.active_clip.motion.skeleton.levels


def ok(dialog):
    return dialog.buttons.button(QDialogButtonBox.StandardButton.Ok)


def test_the_table_shows_the_level_of_every_column(dialog, document):
    shown = [dialog.shown.data(dialog.shown.index(row, LEVEL)) for row in range(dialog.shown.rowCount())]
    assert tuple(shown) == levels(document)
    QAbstractItemModelTester(dialog.model)


def test_an_edit_is_one_step_that_can_be_undone(dialog, document):
    before = levels(document)
    assert not ok(dialog).isEnabled()
    set_level(dialog, 2, 5)
    set_level(dialog, 7, 6)
    assert levels(document) == before
    ok(dialog).click()
    assert (levels(document)[2], levels(document)[7]) == (5, 6)
    document.undo()
    assert levels(document) == before


@pytest.mark.parametrize("level", [0, 7, -1])
def test_a_level_out_of_range_is_not_taken(dialog, level):
    assert not set_level(dialog, 0, level)
    assert dialog.model.changes == ()


def test_the_filter_finds_columns_and_edits_the_right_one(dialog, document):
    dialog.filter.setText("rfemur")
    names = [dialog.shown.data(dialog.shown.index(row, COLUMN)) for row in range(dialog.shown.rowCount())]
    assert names == ["rfemur.rx", "rfemur.ry", "rfemur.rz"]
    set_level(dialog, 1, 1)
    assert dialog.model.changes == (("rfemur.ry", 1),)


def test_reset_brings_back_what_the_file_came_with(qtbot, document):
    document.execute(SetLevels(1, (("root.tx", 4),)))
    dialog = LevelsDialog(document, 1)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, False)
    qtbot.addWidget(dialog)
    dialog.reset.click()
    assert not dialog.reset.isEnabled()
    ok(dialog).click()
    assert levels(document)[0] == 1


def test_the_table_is_copied_as_tab_separated_values(dialog, document):
    dialog.copy.click()
    lines = QGuiApplication.clipboard().text().splitlines()
    assert len(lines) == 1 + len(levels(document))
    assert lines[1].split("\t")[:4] == ["0", "root.tx", "root", "1"]


def test_cancel_changes_nothing(dialog, document):
    set_level(dialog, 0, 6)
    history = document.history
    dialog.reject()
    assert document.history == history
