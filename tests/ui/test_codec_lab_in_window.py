"""The codec lab in its window: keys, views, the strip and the way round from a file to a file."""

import numpy as np
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest

from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.project.commands import SetCodecSettings
from qmd_studio.ui.view import View
from tests.paper_settings import paper


def settled(qtbot, window):
    qtbot.waitUntil(lambda: not window.lab.pending, timeout=30_000)


def picture(window):
    image = window.viewport.grabFramebuffer().convertToFormat(QImage.Format.Format_RGB888)
    return np.frombuffer(image.constBits(), np.uint8).astype(int)


def test_arrows_step_a_knob_that_has_the_focus_and_frames_otherwise(qtbot, window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    slider = window.lab.knobs.paper.bits.slider
    slider.setFocus()
    QTest.keyClick(slider, Qt.Key.Key_Right)
    assert (window.document.state.codec.coding.bits, window.playhead.index) == (9, 0)
    QTest.keyClick(window.viewport, Qt.Key.Key_Right)
    assert (window.document.state.codec.coding.bits, window.playhead.index) == (9, 1)


def test_the_decoded_motion_is_seen_beside_the_original(qtbot, window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    rough = paper(fdf=0, encoder=Encoder.PAPER, rqt=20)
    window.document.execute(SetCodecSettings(rough))
    settled(qtbot, window)
    assert window.lab.report.error.max_mm > 10.0
    window.playhead.seek(window.lab.report.error.worst_frame)
    shown = {}
    for view, key in ((View.A, Qt.Key.Key_1), (View.WIPE, Qt.Key.Key_2), (View.B, Qt.Key.Key_3)):
        QTest.keyClick(window, key, Qt.KeyboardModifier.AltModifier)
        assert window.lab.view.view is view
        shown[view] = picture(window)
    changed = [np.abs(shown[View.A] - shown[view]).sum() for view in (View.WIPE, View.B)]
    assert min(changed) > 10_000


def test_n_and_a_click_on_the_strip_move_the_playhead(qtbot, window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    settled(qtbot, window)
    QTest.keyClick(window, Qt.Key.Key_N)
    assert window.playhead.index == window.strip.worst[0]
    x = round(window.strip.x_of(30))
    QTest.mouseClick(window.strip, Qt.MouseButton.LeftButton, pos=QPoint(x, 20))
    assert window.playhead.index == 30
    assert abs(window.strip.x_of(30) - window.timeline.ruler.x_of(30)) < 1.0


def test_export_and_open_again_from_the_lab(qtbot, window, open_clip, bvh_file):
    open_clip(window, bvh_file)
    settled(qtbot, window)
    measured = window.lab.report
    QTest.keyClick(window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    exported = bvh_file.parent / "nod__fdf6_b8_nd59.qmd"
    assert exported.read_bytes() == measured.data
    window.lab.export_bar.notice.link.emit("reopen")
    qtbot.waitUntil(lambda: len(window.document.state.clips) == 2, timeout=30_000)
    np.testing.assert_allclose(window.document.state.active_clip.motion.X, measured.decoded.X, atol=1e-6)
