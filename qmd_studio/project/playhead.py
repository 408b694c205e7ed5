"""The playhead: which frame is shown, and how time moves it. Not part of the document's history."""

from __future__ import annotations

import math

from psygnal import Signal

SPEEDS = (0.1, 4.0)
"""The slowest and the fastest playback, as a multiple of the clip's own rate; reverse is the same, negative."""


class Playhead:
    """A position in frames on a clip of `n_frames` at `fps`. Time comes in through `advance`, never from a clock.

    `frame` is a real number in [first, last + 1): the frame that is shown is its floor, `index`. `moved` is emitted
    with the new `index` when that changes, `glided` when only the part after the point does; `state_changed` when
    playing, loop, speed, range or clip changed.
    """

    moved = Signal(int)
    glided = Signal()
    state_changed = Signal()

    def __init__(self, n_frames: int = 1, fps: float = 30.0) -> None:
        self._n_frames, self._fps = n_frames, fps
        self._range: tuple[int, int] | None = None
        self._frame = 0.0
        self._playing, self._loop, self._speed = False, True, 1.0

    @property
    def n_frames(self) -> int:
        """The number of frames of the clip."""
        return self._n_frames

    @property
    def fps(self) -> float:
        """The clip's frames a second."""
        return self._fps

    @property
    def frame(self) -> float:
        """The position in frames."""
        return self._frame

    @property
    def index(self) -> int:
        """The frame that is shown, 0 to n_frames - 1."""
        return min(int(self._frame), self._n_frames - 1)

    @property
    def share(self) -> float:
        """How far from the shown frame to the next one playing is, 0 to 1; 0 on the last frame, and at rest."""
        return self._frame - self.index if self._playing and self.index < self.last else 0.0

    @property
    def time_s(self) -> float:
        """The time of the shown frame in seconds."""
        return self.index / self._fps

    @property
    def first(self) -> int:
        """The first frame of the range that is played."""
        return self._range[0] if self._range else 0

    @property
    def last(self) -> int:
        """The last frame of the range that is played."""
        return self._range[1] if self._range else self._n_frames - 1

    @property
    def preview_range(self) -> tuple[int, int] | None:
        """The first and last frame that are played, None for the whole clip."""
        return self._range

    @preview_range.setter
    def preview_range(self, frames: tuple[int, int] | None) -> None:
        if frames is not None:
            first, last = sorted(min(max(int(f), 0), self._n_frames - 1) for f in frames)
            frames = None if first == last else (first, last)
        self._range = frames
        self.state_changed.emit()

    @property
    def playing(self) -> bool:
        """Whether `advance` moves the playhead."""
        return self._playing

    @playing.setter
    def playing(self, playing: bool) -> None:
        if playing and not self._loop and self._at_end():
            self._move(float(self.first if self._speed > 0 else self.last))
        if playing != self._playing:
            self._playing = playing
            self.state_changed.emit()

    @property
    def loop(self) -> bool:
        """Whether playing starts again at the end; otherwise it stops there."""
        return self._loop

    @loop.setter
    def loop(self, loop: bool) -> None:
        self._loop = loop
        self.state_changed.emit()

    @property
    def speed(self) -> float:
        """Clip seconds that pass in a second of playing, ±0.1 to ±4; negative plays backwards."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        slowest, fastest = SPEEDS
        self._speed = math.copysign(min(max(abs(speed), slowest), fastest), speed)
        self.state_changed.emit()

    def set_clip(self, n_frames: int, fps: float) -> None:
        """Go over to a clip of `n_frames` ≥ 1 at `fps` > 0; the position is kept where the clip is long enough."""
        if (n_frames, fps) == (self._n_frames, self._fps):
            return
        if n_frames != self._n_frames:
            self._range = None
        self._n_frames, self._fps = n_frames, fps
        self._frame = min(self._frame, float(n_frames - 1))
        self.state_changed.emit()
        self.moved.emit(self.index)

    def seek(self, frame: float) -> None:
        """Go to `frame`, held within the clip."""
        self._move(min(max(frame, 0.0), float(self._n_frames - 1)))

    def seek_time(self, seconds: float) -> None:
        """Go to the frame nearest to `seconds`."""
        self.seek(float(round(seconds * self._fps)))

    def step(self, frames: int) -> None:
        """Stop, and go `frames` on from the shown frame (back where negative); past an end, to that end."""
        self.playing = False
        self.seek(float(self.index + frames))

    def advance(self, seconds: float) -> None:
        """Let `seconds` ≥ 0 of playing pass: frames in between are dropped, so that time is kept."""
        if not self._playing or seconds <= 0.0:
            return
        first, length = self.first, self.last - self.first + 1
        frame = self._frame + seconds * self._fps * self._speed
        if first <= frame < first + length:
            self._move(frame)
        elif self._loop:
            self._move(first + (frame - first) % length)
        else:
            self._move(float(self.last if self._speed > 0 else first))
            self.playing = False

    def _at_end(self) -> bool:
        return self.index >= self.last if self._speed > 0 else self.index <= self.first

    def _move(self, frame: float) -> None:
        before, index = self._frame, self.index
        self._frame = frame
        if self.index != index:
            self.moved.emit(self.index)
        elif frame != before:
            self.glided.emit()
