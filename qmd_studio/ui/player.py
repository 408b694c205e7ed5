"""Real time for the playhead: while it plays, a timer at the display's rate tells it how much time has passed."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtGui import QGuiApplication

from qmd_studio.project.playhead import Playhead

MAX_STEP_S = 0.25
"""After a stall, longer gaps than this are not made up for: the motion goes on where it was."""


class Player(QObject):
    """Advances `playhead` by the monotonic `clock` (seconds) for as long as it plays."""

    def __init__(self, playhead: Playhead, parent: QObject, clock: Callable[[], float] = perf_counter) -> None:
        super().__init__(parent)
        self._playhead, self._clock, self._last = playhead, clock, 0.0
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        playhead.state_changed.connect(self._follow)
        self._follow()

    def _follow(self) -> None:
        if not self._playhead.playing:
            self._timer.stop()
        elif not self._timer.isActive():
            screen = QGuiApplication.primaryScreen()
            rate = screen.refreshRate() if screen else 60.0
            self._last = self._clock()
            self._timer.start(max(round(1000.0 / min(max(rate, 30.0), 120.0)), 1))

    def _tick(self) -> None:
        now = self._clock()
        passed, self._last = now - self._last, now
        self._playhead.advance(min(passed, MAX_STEP_S))
