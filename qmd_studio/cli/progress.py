"""One line on a terminal that says how far a long verb is; nothing where nobody looks."""

from __future__ import annotations

import sys

from qmd_studio.tuning.outcome import Progress


class ProgressLine:
    """Rewrites one line of stderr, if that is a terminal and the answer is for people; `close` clears it."""

    def __init__(self, *, quiet: bool) -> None:
        self._shown = not quiet and sys.stderr.isatty()
        self._percent = -1

    def tell(self, done: int, total: int, note: str = "") -> None:
        """Say that `done` of `total` are done, when that is another per cent than before."""
        percent = 100 * done // max(total, 1)
        if self._shown and percent != self._percent:
            self._percent = percent
            print(f"\r{percent:3} %  {done:,} of {total:,}  {note}\033[K", end="", file=sys.stderr, flush=True)

    def of_search(self, progress: Progress) -> None:
        """Say how far a search is, and its best so far."""
        best = progress.best
        note = (
            f"FDF {best.settings.fdf}, b {best.settings.bits}, {best.bytes:,} bytes, DEF {best.def_:.3g}"
            if best
            else ""
        )
        self.tell(progress.done, progress.total, note)

    def close(self) -> None:
        """Clear the line."""
        if self._shown and self._percent >= 0:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
