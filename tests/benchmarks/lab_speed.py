"""How the codec lab feels: from a slider's tick to its DEF on the screen, and how long the window is deaf meanwhile."""

import os
import statistics
import time

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from bench_motion import bench_motion
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import Side
from qmd_studio.ui.codec_lab import CodecLab

N_TICKS = 120
DRAG_MS = 16
BEAT_MS = 5


def main():
    app = QApplication([])
    document = Document()
    lab = CodecLab(document, Playhead())
    lab.resize(340, 800)
    lab.show()
    motion = bench_motion()
    app.processEvents()
    gaps = Gaps()
    opened = time.perf_counter()
    document.execute(AddClip(Clip("bench", motion)))
    wait(app, lab)
    print(f"first figures after opening, kernels cold: {1e3 * (time.perf_counter() - opened):.0f} ms")
    first, gaps.longest_ms = gaps.longest_ms, 0.0
    latencies = sorted(single_tick(app, lab, document, fdf) for fdf in range(7, 7 + N_TICKS // 4))
    drag(app, lab)
    row("a slider's tick to DEF on the screen, 2,251 × 62", statistics.median(latencies), "at most 50 ms")
    row("longest deafness of the window, slider dragged at 60 Hz", gaps.longest_ms, "at most 100 ms")
    row("longest deafness of the window, clip opened", first, "at most 100 ms")
    lab.close_down()


class Gaps:
    """A heart that beats in the event loop and remembers its longest pause."""

    def __init__(self):
        self.longest_ms, self._last = 0.0, time.perf_counter()
        self._timer = QTimer(interval=BEAT_MS)
        self._timer.timeout.connect(self._beat)
        self._timer.start()

    def _beat(self):
        now = time.perf_counter()
        self.longest_ms = max(self.longest_ms, 1e3 * (now - self._last) - BEAT_MS)
        self._last = now


def single_tick(app, lab, document, fdf):
    """Move the FDF slider and return the milliseconds until the figures of that setting are painted."""
    slider = lab.knobs.paper.fdf.slider
    slider.setSliderDown(True)
    start = time.perf_counter()
    slider.setValue(fdf)
    wait(app, lab)
    lab.sides[Side.B].figures.repaint()
    took = 1e3 * (time.perf_counter() - start)
    slider.setSliderDown(False)
    wait(app, lab)
    return took


def drag(app, lab):
    """Draw the FDF slider to and fro as a hand does, a step every display frame."""
    lab.knobs.paper.fdf.slider.setSliderDown(True)
    for tick in range(N_TICKS):
        lab.knobs.paper.fdf.slider.setValue(abs(tick % 80 - 40))
        until = time.perf_counter() + DRAG_MS / 1e3
        while time.perf_counter() < until:
            app.processEvents()
    lab.knobs.paper.fdf.slider.setSliderDown(False)
    wait(app, lab)


def wait(app, lab):
    """Let the window live until the newest setting is measured."""
    while lab.pending:
        app.processEvents()


def row(title, ms, bar):
    print(f"{title} | {ms:.1f} ms | | | {bar}")


if __name__ == "__main__":
    main()
