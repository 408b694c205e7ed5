"""Exports are encoded and written off the GUI thread, through the one atomic writer."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, QRunnable, QThreadPool, Signal

from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip

_log = logging.getLogger(__name__)


class _Messages(QObject):
    done = Signal(object)
    failed = Signal(object)


class Saver(QObject):
    """Writes motions one after another; `saved` and `failed` tell how each ended, `busy_changed` what is under way."""

    saved = Signal(object)
    failed = Signal(QmdStudioError)
    busy_changed = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(1)
        self._messages = _Messages(self)
        self._messages.done.connect(self._finish)
        self._messages.failed.connect(self._fail)

    def save(self, path: Path, clip: Clip) -> None:
        """Start to write `clip` to `path` in the format of its suffix; returns at once.

        Formats that hold a body take the one that is worn, and the motion as that body makes it.
        """

        def write() -> None:
            from qmd_studio.project.baking import figure_of, motion_for
            from qmd_studio.registry import format_for, save_figure, save_motion

            if format_for(path).write_figure is not None:
                save_figure(path, *figure_of(clip))
            else:
                save_motion(path, motion_for(clip, path.suffix))

        self.busy_changed.emit(path.name)
        self._pool.start(_Writing(path, write, self._messages))

    def wait(self) -> None:
        """Wait until all is written: a window that closes does not cut an export short."""
        self._pool.waitForDone(-1)

    def _finish(self, path: Path) -> None:
        self.busy_changed.emit("")
        self.saved.emit(path)

    def _fail(self, problem: QmdStudioError) -> None:
        self.busy_changed.emit("")
        self.failed.emit(problem)


class _Writing(QRunnable):
    def __init__(self, path: Path, write: Callable[[], None], messages: _Messages) -> None:
        super().__init__()
        self._path, self._write, self._messages = path, write, messages

    def run(self) -> None:
        try:
            self._write()
            self._messages.done.emit(self._path)
        except QmdStudioError as problem:
            self._messages.failed.emit(problem.located(self._path))
        except Exception as problem:
            _log.exception("writing %s", self._path)
            self._messages.failed.emit(
                QmdStudioError(
                    f"the file could not be written ({type(problem).__name__}: {problem})",
                    path=self._path,
                    hint="This is a fault of the studio. What stood there before is untouched.",
                )
            )
