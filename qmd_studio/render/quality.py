"""How much work a frame may be: measured frame times lower the quality of a slow renderer before it stutters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

SLOW_S = 1 / 22
"""A frame slower than this costs quality: it leaves headroom over the promised 15 frames a second."""
FAST_S = 1 / 34
"""Frames this quick leave room for the next better rung."""
_PATIENCE = 4
_LONG_PATIENCE = 90


@dataclass(frozen=True, slots=True)
class Quality:
    """The choices that cost time: samples a pixel, the internal resolution's share of a side, highlights, and the side
    of the map of what the sun does not reach, in pixels; 0 for a soft shadow on the ground alone.
    """

    samples: int
    scale: float
    gloss: bool
    shadow: int = 0


LADDER = (
    Quality(samples=8, scale=1.0, gloss=True, shadow=1024),
    Quality(samples=4, scale=1.0, gloss=True, shadow=1024),
    Quality(samples=0, scale=1.0, gloss=True),
    Quality(samples=0, scale=1.0, gloss=False),
    Quality(samples=0, scale=0.75, gloss=False),
    Quality(samples=0, scale=0.6, gloss=False),
    Quality(samples=0, scale=0.5, gloss=False),
)
"""From the best picture to the quickest."""
_STILL_SHADED, _STILL = LADDER[1], replace(LADDER[1], shadow=0)
FINE = LADDER[0]
"""What a picture that is kept is drawn with."""
_HARDWARE, _SOFTWARE = 1, 3


class QualityController:
    """Chooses a rung of `LADDER` from the times of the frames it is told about.

    Some slow frames in a row step down; many quick ones step up by one, and a rung that proved too slow is tried again
    only after ever longer waits. `clock` returns seconds.
    """

    def __init__(self, clock: Callable[[], float], *, software: bool) -> None:
        self._clock = clock
        self._rung = _SOFTWARE if software else _HARDWARE
        self._best = _SOFTWARE if software else 0
        self._slow = self._fast = 0
        self._patience = _LONG_PATIENCE
        self._started = 0.0

    @property
    def quality(self) -> Quality:
        """The quality that the next frame should have."""
        return LADDER[self._rung]

    @property
    def still(self) -> Quality:
        """The quality of a picture that does not move: smooth edges on any renderer, the light as while it moved."""
        return _STILL_SHADED if self.quality.shadow else _STILL

    def begin(self) -> None:
        """Note that a frame starts."""
        self._started = self._clock()

    def end(self) -> None:
        """Note that the frame is finished (the driver's queue is empty) and judge it."""
        self.judge(self._clock() - self._started)

    def judge(self, seconds: float) -> None:
        """Take the duration of one frame into account."""
        self._slow = self._slow + 1 if seconds > SLOW_S else 0
        self._fast = self._fast + 1 if seconds < FAST_S else 0
        if self._slow >= _PATIENCE and self._rung < len(LADDER) - 1:
            self._rung += 1
            self._slow = self._fast = 0
            self._patience = min(self._patience * 2, 100_000)
        elif self._fast >= self._patience and self._rung > self._best:
            self._rung -= 1
            self._slow = self._fast = 0
