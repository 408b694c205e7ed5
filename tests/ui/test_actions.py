from collections import Counter

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QLineEdit

from qmd_studio import assets
from qmd_studio.ui.actions import VERBS
from qmd_studio.ui.dialogs import ShortcutsDialog

_MODIFIERS = {"Shift": Qt.KeyboardModifier.ShiftModifier, "Ctrl": Qt.KeyboardModifier.ControlModifier}


def test_no_two_verbs_have_the_same_key():
    keys = Counter(QKeySequence(key).toString() for verb in VERBS for key in verb.keys)
    assert [key for key, count in keys.items() if count > 1 or not key] == []


def test_no_two_verbs_have_the_same_id_and_each_says_what_it_does():
    assert len({verb.id for verb in VERBS}) == len(VERBS)
    assert all(verb.tip and verb.text for verb in VERBS)


def test_no_two_verbs_of_a_menu_have_the_same_mnemonic():
    letters = Counter((v.menu, v.text[v.text.index("&") + 1].lower()) for v in VERBS if "&" in v.text)
    assert [place for place, count in letters.items() if count > 1] == []


def test_every_icon_that_a_verb_names_is_there():
    for verb in VERBS:
        assert not verb.icon or assets.resource("icons", f"{verb.icon}.svg").is_file()


def test_the_list_of_shortcuts_names_every_verb_with_a_key(window):
    from PySide6.QtWidgets import QTableWidget

    table = ShortcutsDialog(window).findChild(QTableWidget)
    listed = {table.item(row, 0).text() for row in range(table.rowCount())}
    assert table.rowCount() == sum(1 for verb in VERBS if verb.keys)
    assert "Space" in listed


@pytest.mark.parametrize("typed", ["f", " ", "n", "1", "P"])
def test_a_key_typed_into_a_text_field_is_text_and_no_shortcut(window, open_clip, bvh_file, qtbot, typed):
    open_clip(window, bvh_file)
    fired = []
    for verb in VERBS:
        window.verbs[verb.id].triggered.connect(lambda _=False, i=verb.id: fired.append(i))
    field = window.timeline.place
    field.setFocus()
    qtbot.waitUntil(field.hasFocus)
    field.clear()
    qtbot.keyClicks(field, typed)
    assert field.text() == typed
    assert fired == []


def test_keys_that_move_in_a_text_field_do_not_move_the_playhead(window, open_clip, bvh_file, qtbot):
    open_clip(window, bvh_file)
    window.playhead.seek(5)
    field = window.timeline.place
    field.setFocus()
    qtbot.waitUntil(field.hasFocus)
    for key in (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Home, Qt.Key.Key_End):
        for modifier in (Qt.KeyboardModifier.NoModifier, *_MODIFIERS.values()):
            qtbot.keyClick(field, key, modifier)
    assert window.playhead.index == 5
    assert isinstance(field, QLineEdit)
