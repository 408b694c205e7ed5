"""One line on a terminal that says how far a long verb is; nothing where nobody looks."""

from __future__ import annotations

import sys
import time

from qmd_studio.tuning.outcome import Progress

_TELL_EVERY_S = 1.0
_WORTH_SAYING_S = 5.0


class ProgressLine:
    """Rewrites one line of stderr, if that is a terminal and the answer is for people; `close` clears it."""

    def __init__(self, *, quiet: bool) -> None:
        self._shown = not quiet and sys.stderr.isatty()
        self._percent = -1
        self._started = self._told_at = time.monotonic()

    def tell(self, done: int, total: int, note: str = "") -> None:
        """Say that `done` of `total` are done, when that is another per cent than before or a second has passed."""
        percent, now = 100 * done // max(total, 1), time.monotonic()
        if self._shown and (percent != self._percent or now - self._told_at >= _TELL_EVERY_S):
            self._percent, self._told_at = percent, now
            text = f"{percent:3} %  {done:,} of {total:,}{self._left(done, total)}  {note}"
            print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)

    def _left(self, done: int, total: int) -> str:
        """Return how long the rest will take at most, where that is worth saying."""
        passed = time.monotonic() - self._started
        left = passed * (total - done) / max(done, 1)
        return f"  {left / 60:,.0f} min at most" if done and passed > _WORTH_SAYING_S and left >= 60 else ""

    def of_search(self, progress: Progress) -> None:
        """Say how far a search is, and its best so far."""
        best = progress.best
        note = f"FDF {best.paper.fdf}, b {best.paper.bits}, {best.bytes:,} bytes, DEF {best.def_:.3g}" if best else ""
        self.tell(progress.done, progress.total, note)

    def close(self) -> None:
        """Clear the line."""
        if self._shown and self._percent >= 0:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
