"""Files are read off the GUI thread: the open document is touched only when a whole clip stands ready."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QObject, QRunnable, QThreadPool, Signal

from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip
from qmd_studio.ui.libraries import load_libraries

_log = logging.getLogger(__name__)


class _Messages(QObject):
    clip_read = Signal(int, object)
    failed = Signal(int, object)
    finished = Signal(int)


class Opener(QObject):
    """Reads files in a worker thread, in the order asked for.

    `opened` hands over the clips of one request together, `failed` one error for each file that could not be read,
    `busy_changed` the name of what is being read, "" when idle. Requests have tickets; those cancelled are dropped.
    """

    opened = Signal(list)
    failed = Signal(QmdStudioError)
    busy_changed = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(1)
        self._ticket = 0
        self._waiting: dict[int, list[Clip]] = {}
        self._messages = _Messages(self)
        self._messages.clip_read.connect(self._take)
        self._messages.failed.connect(self._fail)
        self._messages.finished.connect(self._finish)

    @property
    def busy(self) -> bool:
        """Whether something is being read."""
        return bool(self._waiting)

    def open(self, paths: Sequence[Path]) -> None:
        """Start to read `paths`; returns at once."""
        if not paths:
            return
        self._ticket += 1
        self._waiting[self._ticket] = []
        self._pool.start(_Reading(self._ticket, tuple(paths), self._messages))
        name = paths[0].name if len(paths) == 1 else self.tr("{n} files").format(n=len(paths))
        self.busy_changed.emit(name)

    def cancel(self) -> None:
        """Drop everything that is under way."""
        self._waiting.clear()
        self._pool.clear()
        self.busy_changed.emit("")

    def wait(self, timeout_ms: int = 2000) -> None:
        """Wait for the worker before the window goes."""
        self._waiting.clear()
        self._pool.clear()
        self._pool.waitForDone(timeout_ms)

    def _take(self, ticket: int, clip: Clip) -> None:
        if ticket in self._waiting:
            self._waiting[ticket].append(clip)

    def _fail(self, ticket: int, problem: QmdStudioError) -> None:
        if ticket in self._waiting:
            self.failed.emit(problem)

    def _finish(self, ticket: int) -> None:
        clips = self._waiting.pop(ticket, None)
        if clips is None:
            return
        if not self._waiting:
            self.busy_changed.emit("")
        if clips:
            self.opened.emit(clips)


class _Reading(QRunnable):
    """Reads the files of one ticket, and makes the bodies of those that bring none."""

    def __init__(self, ticket: int, paths: tuple[Path, ...], messages: _Messages) -> None:
        super().__init__()
        self._ticket, self._paths, self._messages = ticket, paths, messages

    def run(self) -> None:
        for path in self._paths:
            try:
                self._messages.clip_read.emit(self._ticket, read_clip(path))
            except QmdStudioError as problem:
                self._messages.failed.emit(self._ticket, problem.located(path))
            except Exception as problem:
                _log.exception("reading %s", path)
                self._messages.failed.emit(self._ticket, _unforeseen(path, problem))
        self._messages.finished.emit(self._ticket)


def read_clip(path: Path) -> Clip:
    """Return the clip of the file `path`, with all that showing it needs made ready; raises `QmdStudioError`."""
    load_libraries()
    from qmd_studio.project.clip import clip_from
    from qmd_studio.registry import default_body, open_file
    from qmd_studio.ui.stage import prepare

    clip = clip_from(open_file(path), path, default_body())
    prepare(clip)  # here, so that the window does not wait for it
    return clip


def _unforeseen(path: Path, problem: Exception) -> QmdStudioError:
    return QmdStudioError(
        f"the file could not be read ({type(problem).__name__}: {problem})",
        path=path,
        hint="This is a fault of the studio. The file and what is open are untouched.",
    )
