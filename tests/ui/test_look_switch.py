"""How bodies are shown is chosen in the View menu or by the button beside it, and remembered."""

import numpy as np
import pytest
from PySide6.QtWidgets import QToolButton

from qmd_studio.render.scene import Look
from qmd_studio.ui.settings import Settings


@pytest.mark.parametrize("look", [Look.SEGMENTS, Look.XRAY, Look.WIRE])
def test_a_chosen_look_is_seen_and_remembered(make_window, open_clip, bvh_file, look):
    window = make_window()
    open_clip(window, bvh_file)
    plain = window.viewport.grabFramebuffer()
    window.verbs[f"look_{look}"].trigger()
    assert window.viewport.look is look
    assert window.verbs[f"look_{look}"].isChecked()
    assert not window.verbs["look_solid"].isChecked()
    assert window.viewport.grabFramebuffer() != plain
    window.close()
    assert make_window(furnished=False).viewport.look is look


def test_names_can_be_turned_off_and_stay_off(make_window):
    window = make_window(furnished=False)
    assert window.viewport.hover.names
    window.verbs["joint_names"].trigger()
    assert not window.viewport.hover.names
    window.close()
    again = make_window(furnished=False)
    assert not again.viewport.hover.names
    assert not again.verbs["joint_names"].isChecked()


def test_a_look_that_nobody_knows_is_taken_for_solid(make_window):
    window = make_window(furnished=False)
    Settings().look = "velvet"
    window.close()
    assert make_window(furnished=False).viewport.look is Look.SOLID


def test_the_button_offers_every_look_and_shows_the_chosen_one(make_window):
    window = make_window(furnished=False)
    button = window.tools.findChild(QToolButton, "Look")
    assert [action.objectName() for action in button.menu().actions()] == [
        *(f"look_{look}" for look in Look),
        "joint_names",
    ]

    def drawn():
        image = button.icon().pixmap(20, 20).toImage()
        return np.frombuffer(image.constBits(), np.uint8).copy()

    before = drawn()
    window.verbs["look_wire"].trigger()
    assert not np.array_equal(drawn(), before)
