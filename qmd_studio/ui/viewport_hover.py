"""The joint under the resting mouse: lit up faintly, with its name beside the pointer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPointF, QTimer

from qmd_studio.avatar.humanoid import Body
from qmd_studio.ui.viewport_words import paint_label

if TYPE_CHECKING:
    from qmd_studio.ui.viewport import Viewport

_AFTER_MS = 60


class Hover(QObject):
    """Asks the viewport what is under the mouse once that rests, and names it if `names` says so."""

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self.names = True
        self._at: QPointF | None = None
        self._lines: tuple[str, ...] = ()
        self._timer = QTimer(self, singleShot=True, interval=_AFTER_MS)
        self._timer.timeout.connect(self.look)

    @property
    def _viewport(self) -> Viewport:
        return self.parent()  # asked for each time: a viewport that its own part held would outlive its context

    @property
    def lines(self) -> tuple[str, ...]:
        """What the label says now: the joint's name, and that of its segment; nothing while there is none."""
        return self._lines if self.names else ()

    def move(self, at: QPointF) -> None:
        """Follow the mouse to a place of the viewport."""
        self._at = at
        if not self._timer.isActive():
            self._timer.start()  # at most so often, and not only after a rest: the label goes along

    def wait(self) -> None:
        """Forget what is named, because other bodies stand there, and look again soon."""
        self._lines = ()
        if self._at is not None:
            self._timer.start()

    def leave(self) -> None:
        """Name nothing until the mouse moves again."""
        self._timer.stop()
        self._at = None
        self._tell((), None)

    def look(self) -> None:
        """Find out what is under the mouse now."""
        if self._at is None:
            return
        viewport = self._viewport
        hit = None if viewport.preset_at(self._at) else viewport.hit(self._at)
        if hit is None:
            self._tell((), None)
        else:
            self._tell(named(viewport.scene.actors[hit.actor].body, hit.joint), (hit.actor, hit.joint))

    def paint(self, *, dark: bool) -> None:
        """Paint the label over the picture."""
        if self.lines and self._at is not None:
            paint_label(self._viewport, self.lines, self._at, dark=dark)

    def _tell(self, lines: tuple[str, ...], hovered: tuple[int, int] | None) -> None:
        had_lines, self._lines = self._lines, lines
        self._viewport.set_hovered(hovered)
        if lines or had_lines:
            self._viewport.update()


def named(body: Body, joint: int) -> tuple[str, ...]:
    """Return the name of a joint and that of the segment that it carries, where it has one of its own."""
    name = body.skeleton.joints[joint].name
    segment = body.segments[joint] if joint < len(body.segments) else ""
    return (name, segment) if segment and segment != name else (name,)
