"""How long the window is deaf: the longest pause of its event loop as clips open, sliders are dragged, edits undone.

A heart beats in the event loop every few milliseconds. Beside the longest wall time from beat to beat stands how much
processor time the window's thread took in the longest of them: on a machine that others load, the wall time counts
their work too, the processor time does not. It counts what this thread did, not what it waited for.
"""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

from bench_motion import bench_motion
from PySide6.QtCore import Qt, QTimer
from screen import on_some_screen

from tests.corpus import CORPUS

BEAT_MS = 5
FRAME_S = 1 / 60
DRAG_S = 3.0
BAR = "at most 100 ms"
CLIPS = ("cmu_asfamc/02_01.amc", "cmu_asfamc/60_01.amc", "bvh/fairmotion_01_01.bvh")


class Heart:
    """A beat in the event loop; `longest` is the longest pause since `rest`, in ms of wall and of processor time."""

    def __init__(self):
        self._timer = QTimer(interval=BEAT_MS, timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.beat)
        self._timer.start()
        self.rest()

    def rest(self):
        self.longest_ms = self.busiest_ms = 0.0
        self._wall, self._cpu = time.perf_counter(), time.thread_time()

    def beat(self):
        wall, cpu = time.perf_counter(), time.thread_time()
        self.longest_ms = max(self.longest_ms, 1e3 * (wall - self._wall) - BEAT_MS)
        self.busiest_ms = max(self.busiest_ms, 1e3 * (cpu - self._cpu))
        self._wall, self._cpu = wall, cpu


class Bench:
    """The studio's window with a heart in its loop."""

    def __init__(self, app, window):
        self.app, self.window, self.heart = app, window, Heart()

    def live(self, seconds):
        until = time.perf_counter() + seconds
        while time.perf_counter() < until:
            self.app.processEvents()
            time.sleep(0.0005)  # as the loop itself sleeps where nothing is to do

    def until(self, done, seconds=120.0):
        limit = time.perf_counter() + seconds
        while not done():
            self.app.processEvents()
            time.sleep(0.0005)
            if time.perf_counter() > limit:
                raise SystemExit("the window did not come to rest")

    def settle(self):
        """Let the window live until all is measured, and a while longer: the plots' sweep goes on beside it."""
        self.until(lambda: not self.window.lab.pending)
        self.live(2.0)

    def told(self, title):
        heart = self.heart
        figures = f"{heart.longest_ms:.0f} ms; longest at work {heart.busiest_ms:.0f} ms of processor"
        print(f"longest pause, {title} | {figures} | | | {BAR}", flush=True)
        heart.rest()

    def open(self, path):
        clips = len(self.window.document.state.clips)
        self.heart.rest()
        self.window.open_paths([path])
        self.until(lambda: len(self.window.document.state.clips) > clips)
        self.settle()
        self.told(f"opening {path.name}")

    def drag(self, name):
        """Draw a slider to and fro as a hand does, a step every display frame."""
        slider = getattr(self.window.lab.knobs.paper, name).slider
        start, (low, high) = slider.value(), (slider.minimum(), slider.maximum())
        self.heart.rest()
        slider.setSliderDown(True)
        span, step, until = max(high - low, 1), 0, time.perf_counter() + DRAG_S
        while time.perf_counter() < until:
            step += 1
            slider.setValue(low + abs((step + span) % (2 * span) - span))
            self.live(FRAME_S)
        slider.setValue(start)
        slider.setSliderDown(False)
        self.settle()
        self.told(f"{name} slider dragged")


def clips(folder):
    """Return the files to open: the corpus's, or generated ones where it is absent."""
    found = [CORPUS / name for name in CLIPS]
    if all(path.exists() for path in found):
        return found
    from qmd_studio.registry import save_motion

    motion, made = bench_motion(), [folder / "short.bvh", folder / "long.bvh"]
    for path, n_frames in zip(made, (343, motion.n_frames), strict=True):
        save_motion(path, motion.with_values(motion.X[:n_frames]))
    return made


def main():
    folder = Path(tempfile.mkdtemp(prefix="qmd-pauses-"))
    from qmd_studio.project.commands import ActivateClip
    from qmd_studio.ui.app import make_application
    from qmd_studio.ui.main_window import MainWindow
    from qmd_studio.ui.saver import Saver
    from qmd_studio.ui.settings import SETTINGS_VARIABLE, Settings
    from qmd_studio.ui.theme import Theme, ThemeSwitch

    os.environ[SETTINGS_VARIABLE] = str(folder / "settings.ini")
    app = make_application()
    window = MainWindow(Settings(), ThemeSwitch(app, Theme.LIGHT))
    window.resize(1280, 800)
    bench = Bench(app, window)
    window.show()
    window.viewport.frameSwapped.connect(bench.heart.rest, Qt.ConnectionType.SingleShotConnection)
    bench.until(lambda: window.lab is not None)
    bench.live(1.0)
    bench.told("bringing in what the first picture could do without")
    paths = clips(folder)
    for path in paths:
        bench.open(path)
    for name in ("fdf", "bits", "segment"):
        bench.drag(name)
    bench.live(2.0)
    bench.told("playing")
    keys = [clip.key for clip in window.document.state.clips]
    for key in keys:
        window.document.execute(ActivateClip(key))
        bench.settle()
    bench.told("going from clip to clip")
    for _ in range(6):
        window.document.undo()
        bench.settle()
    bench.told("undo")
    for _ in range(6):
        window.document.redo()
        bench.settle()
    bench.told("redo")
    window.lab.plots.find_front()
    bench.live(3.0)
    bench.told("searching the Pareto front")
    window.lab.plots.find_front()
    bench.settle()
    bench.heart.rest()
    saver = Saver(window)
    saver.save(folder / "out.bvh", window.document.state.active_clip)
    bench.live(1.5)
    saver.wait()
    bench.told("saving a BVH")
    window.close()


if __name__ == "__main__":
    on_some_screen()
    main()
