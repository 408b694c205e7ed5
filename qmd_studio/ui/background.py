"""Work that takes a while, beside the window: the newest wins, what is out of date is told to stop."""

from __future__ import annotations

import contextlib
import sys
import threading
from collections.abc import Callable
from typing import Any, TypeAlias

from PySide6.QtCore import QCoreApplication, QObject, Qt, Signal

from qmd_studio.errors import CodecError, QmdStudioError
from qmd_studio.ui.libraries import load_libraries

Tell: TypeAlias = Callable[[Any], None]
Work: TypeAlias = Callable[[threading.Event, Tell], Any]
"""What is done: it stops soon after the event is set, tells what it has so far, and returns what it came to."""


class Background(QObject):
    """Runs one piece of work at a time; `told`, `ended` and `failed` come on this object's thread, of the newest."""

    told = Signal(object)
    ended = Signal(object)
    failed = Signal(object)
    _came = Signal(int, str, object)

    def __init__(self, name: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._name = name
        self._newest, self._running = 0, False
        self._stop = threading.Event()
        self._turn = threading.Lock()
        self._threads: list[threading.Thread] = []
        self._came.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        application = QCoreApplication.instance()
        if application is not None:
            application.aboutToQuit.connect(self.close)

    @property
    def running(self) -> bool:
        """Whether the newest work has not ended yet."""
        return self._running

    def run(self, work: Work) -> None:
        """Do `work` as soon as what is under way has stopped, which it is told to."""
        self.cancel()
        self._stop, self._running = threading.Event(), True
        arguments = (work, self._newest, self._stop)
        thread = threading.Thread(target=self._work, args=arguments, name=self._name, daemon=True)
        self._threads = [t for t in self._threads if t.is_alive()] + [thread]
        thread.start()

    def cancel(self) -> None:
        """Stop what is under way; nothing more is told of it."""
        self._newest += 1
        self._running = False
        self._stop.set()

    def close(self) -> None:
        """Stop what is under way and wait for its end."""
        self.cancel()
        for thread in self._threads:
            thread.join()
        self._threads.clear()

    def _work(self, work: Work, ticket: int, stop: threading.Event) -> None:
        with contextlib.suppress(RuntimeError), self._turn:  # the window may have gone meanwhile
            if not stop.is_set():
                kind, value = _outcome(work, stop, lambda part: self._came.emit(ticket, "told", part))
                self._came.emit(ticket, kind, value)

    def _receive(self, ticket: int, kind: str, value: object) -> None:
        if ticket != self._newest:
            return
        if kind != "told":
            self._running = False
        {"told": self.told, "ended": self.ended, "failed": self.failed}[kind].emit(value)


def _outcome(work: Work, stop: threading.Event, tell: Tell) -> tuple[str, Any]:
    try:
        load_libraries()
        return "ended", work(stop, tell)
    except QmdStudioError as problem:
        return "failed", problem
    except MemoryError:
        return "failed", CodecError("there is not enough memory for this motion", hint="Open a shorter motion")
    except RuntimeError:
        raise
    except Exception as problem:  # the last stop of the thread: a mistake of ours must not leave the panel waiting
        sys.excepthook(type(problem), problem, problem.__traceback__)
        return "failed", CodecError("this could not be computed", got=repr(problem))
