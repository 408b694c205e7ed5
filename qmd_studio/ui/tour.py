"""The main job by itself: the real window opens a motion, tunes it, exports QMD and opens that, and leaves pictures."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from time import perf_counter

from PySide6.QtCore import QObject, QTimer

from qmd_studio.ui.main_window import MainWindow
from qmd_studio.ui.theme import Theme

STEP_LIMIT_S = 120.0
"""A step that takes longer has failed: compiling the kernels for the first time is the longest."""
_POLL_MS = 40
_TUNED = {"fdf": 12, "bits": 2}
"""Where the sliders are put: counted from their left ends, b from 8."""


class Tour(QObject):
    """Takes `window` through its main job on `file`, the sample where it is None, and leaves what came of it in `out`.

    `status` is 0 where all went well. The pictures are of the window that a user would see.
    """

    def __init__(self, window: MainWindow, out: Path, file: Path | None = None) -> None:
        super().__init__(window)
        self._window, self._out, self._file = window, out, file
        self._exported: Path | None = None
        self._steps = self._job()
        self._until: Callable[[], bool] = lambda: True
        self._since = 0.0
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._go_on)
        self.status = 1

    def start(self) -> None:
        """Begin; the window closes at the end."""
        self._out.mkdir(parents=True, exist_ok=True)
        self._window.resize(1440, 900)
        self._window.ask_export_path = lambda _parent, suggested: self._out.resolve() / suggested.name
        self._since = perf_counter()
        self._until = lambda: self._window.is_furnished
        self._timer.start(_POLL_MS)

    def _job(self) -> Iterator[Callable[[], bool]]:
        window = self._window
        document, lab = window.document, window.lab
        if lab is None:
            raise RuntimeError("the codec lab is missing")
        lab.export_bar.exported.connect(self._take_export)
        if self._file is None:
            window.files.open_sample()
        else:
            window.open_paths([self._file])
        yield lambda: len(document.state.clips) == 1 and lab.report is not None
        window.playhead.playing = False
        window.playhead.seek(window.playhead.n_frames * 0.3)
        yield from self._picture("1-opened-light", Theme.LIGHT)

        for knob, value in _TUNED.items():
            getattr(lab.knobs.paper, knob).slider.setValue(value)
        document.end_merge()
        yield self._measured
        window.verbs["show_both"].trigger()
        window.verbs["next_worst"].trigger()
        yield from self._picture("2-tuned-light", Theme.LIGHT)
        yield from self._picture("3-tuned-dark", Theme.DARK)
        report = lab.report
        print(f"{report.file_bytes} bytes, DEF {report.error.def_:.4g}, at worst {report.error.max_mm:.3g} mm")

        lab.export_as()
        yield lambda: self._exported is not None
        yield from self._picture("4-exported-dark", Theme.DARK)
        if self._exported.read_bytes() != report.data:
            raise RuntimeError("the exported file does not hold the bytes that were measured")

        window.open_paths([self._exported])
        yield lambda: len(document.state.clips) == 2 and self._measured()
        window.playhead.playing = False
        window.playhead.seek(window.playhead.n_frames * 0.6)
        window.verbs["show_original"].trigger()
        yield from self._picture("5-reopened-light", Theme.LIGHT)
        self.status = 0

    def _measured(self) -> bool:
        lab = self._window.lab
        return lab.report is not None and not lab.pending

    def _take_export(self, path: Path) -> None:
        self._exported = path
        print(path)

    def _picture(self, name: str, theme: Theme) -> Iterator[Callable[[], bool]]:
        self._window.themes.choose(theme)
        for _ in range(3):
            yield lambda: True  # the window lays itself out and repaints in between
        self._window.viewport.finish()
        path = self._out / f"{name}.png"
        self._window.grab().save(str(path))
        print(path)

    def _go_on(self) -> None:
        banners = self._window.banners.banners
        if any(banner.kind == "error" for banner in banners):
            self._stop(banners[0].text)
        elif self._until():
            self._since = perf_counter()
            try:
                self._until = next(self._steps)
            except StopIteration:
                self._stop()
            except Exception as problem:
                self._stop(f"{type(problem).__name__}: {problem}")
        elif perf_counter() - self._since > STEP_LIMIT_S:
            self._stop("A step took too long.")

    def _stop(self, trouble: str = "") -> None:
        self._timer.stop()
        if trouble:
            print(trouble, file=sys.stderr)
            self.status = 1
            self._window.grab().save(str(self._out / "trouble.png"))
        self._window.close()
