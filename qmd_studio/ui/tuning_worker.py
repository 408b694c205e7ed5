"""Encodes and measures off the GUI thread: the newest request wins, and what is out of date is dropped."""

from __future__ import annotations

import contextlib
import sys
import threading
from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QObject, Qt, Signal

from qmd_studio.errors import CodecError, QmdStudioError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.ui.libraries import load_libraries

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport
    from qmd_studio.tuning.lab_session import LabSession

IDLE_S = 10.0
"""A thread with nothing to do for this long goes home; the next request starts another."""

CACHED_REPORTS = 6
"""Undo, redo and going to and fro between a few settings show their figures at once."""

CACHED_SESSIONS = 2


@dataclass(frozen=True, slots=True)
class Job:
    """What one ticket asks for; `stop` is set when nobody wants it any more."""

    ticket: int
    motion: Motion
    settings: EncodeSettings
    draft: bool = False
    stop: threading.Event = field(default_factory=threading.Event)


class Mailbox:
    """Holds at most one job: putting another in throws the older away. Any thread may call any method."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._job: Job | None = None
        self._closed = False
        self._attended = False

    def put(self, job: Job) -> bool:
        """Leave a job; return whether nobody attends the box, so that the caller must start a thread that does."""
        with self._changed:
            if self._closed:
                return False
            self._job = job
            self._changed.notify()
            unattended, self._attended = not self._attended, True
            return unattended

    def empty(self) -> None:
        """Throw away the job that nobody has taken yet."""
        with self._changed:
            self._job = None

    def take(self, timeout_s: float) -> Job | None:
        """Wait for a job and take it; None, after which nobody attends the box, where none came or it was closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._job is not None, timeout_s)
            job, self._job = self._job, None
            self._attended = job is not None
            return job

    def close(self) -> None:
        """Take in nothing more, and send home who attends."""
        with self._changed:
            self._closed = True
            self._job = None
            self._changed.notify()


class TuningWorker(QObject):
    """Turns `request(motion, settings)` into `measured(LabReport)` or `failed(QmdStudioError)`.

    Every request has a ticket, and outcomes come on this object's thread in the order of their tickets. A request that
    has not begun when a newer one comes never begins; one that has is finished, and its report emitted unless a newer
    one was: a hand that never rests sees figures all the same. What takes long is stopped instead. Of another motion,
    of a request before `cancel`, and of a failure that is not the newest's nothing is told. A report that is still
    remembered is emitted at once. A `draft` is enough while a slider is held: it comes sooner, and it is not
    remembered.
    """

    measured = Signal(object)
    failed = Signal(object)
    _came = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._mailbox = Mailbox()
        self._thread: threading.Thread | None = None
        self._newest = self._told = 0
        self._motion: Motion | None = None
        self._pending = False
        self._stop = threading.Event()
        self._reports: OrderedDict[tuple[Motion, EncodeSettings], LabReport] = OrderedDict()
        self._outcomes: deque[tuple[Job, LabReport | QmdStudioError]] = deque()
        self._came.connect(self._receive_newest, Qt.ConnectionType.QueuedConnection)
        self.destroyed.connect(self._mailbox.close)
        application = QCoreApplication.instance()
        if application is not None:
            application.aboutToQuit.connect(self.close)

    @property
    def pending(self) -> bool:
        """Whether the newest request still waits for its outcome."""
        return self._pending

    def request(self, motion: Motion, settings: EncodeSettings, *, draft: bool = False) -> int:
        """Ask for the report of `settings`, which fit `motion`; return the ticket."""
        if motion is not self._motion:
            self.cancel()
        self._motion = motion
        self._newest += 1
        self._pending = True
        self._stop.set()
        self._stop = threading.Event()
        job = Job(self._newest, motion, settings, draft, self._stop)
        known = self._reports.get((motion, settings))
        if known is not None:
            self._mailbox.empty()
            self._receive(job, known)
        elif self._mailbox.put(job):
            self._start()
        return job.ticket

    def cancel(self) -> None:
        """Forget all requests: nothing is emitted for them, and what has begun is dropped when it ends."""
        self._newest += 1
        self._told = self._newest
        self._pending = False
        self._stop.set()
        self._mailbox.empty()

    def close(self) -> None:
        """Take no more work and wait for what is running."""
        self.cancel()
        self._mailbox.close()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _start(self) -> None:
        arguments = (self._mailbox, self._deliver)
        self._thread = threading.Thread(target=_work, args=arguments, name="tuning", daemon=True)
        self._thread.start()

    def _deliver(self, job: Job, outcome: LabReport | QmdStudioError) -> None:
        """Hand an outcome over, on the working thread."""
        self._outcomes.append((job, outcome))
        self._came.emit()

    def _receive_newest(self) -> None:
        """Of all that has come since the window was last free to look, the newest is enough."""
        while len(self._outcomes) > 1:
            self._remember(*self._outcomes.popleft())
        if self._outcomes:
            self._receive(*self._outcomes.popleft())

    def _receive(self, job: Job, outcome: LabReport | QmdStudioError) -> None:
        self._remember(job, outcome)
        failed, newest = isinstance(outcome, QmdStudioError), job.ticket == self._newest
        if job.ticket <= self._told or (failed and not newest):
            return
        self._told = job.ticket
        self._pending = self._pending and not newest
        (self.failed if failed else self.measured).emit(outcome)

    def _remember(self, job: Job, report: LabReport | QmdStudioError) -> None:
        if isinstance(report, QmdStudioError) or report.draft:
            return
        self._reports[job.motion, job.settings] = report
        self._reports.move_to_end((job.motion, job.settings))
        while len(self._reports) > CACHED_REPORTS:
            self._reports.popitem(last=False)


def _work(mailbox: Mailbox, deliver: Callable[[Job, object], None]) -> None:
    """The thread: take the newest job, measure, deliver, until the box is closed or stays empty."""
    sessions: OrderedDict[Motion, LabSession] = OrderedDict()
    while (job := mailbox.take(IDLE_S)) is not None:
        outcome = _outcome(job, sessions)
        with contextlib.suppress(RuntimeError):  # the window may have gone while this was measured
            deliver(job, outcome)


def _outcome(job: Job, sessions: OrderedDict[Motion, LabSession]) -> LabReport | QmdStudioError:
    try:
        report = _session(job.motion, sessions).evaluate(job.settings, draft=job.draft, cancel=job.stop)
        _ = report.played, report.budget  # made here, where nobody waits for it, and kept in the report
        return report
    except QmdStudioError as problem:
        return problem
    except MemoryError:
        return CodecError("there is not enough memory to measure this motion", hint="Open a shorter motion")
    except Exception as problem:  # the last stop of the thread: a mistake of ours must not leave the panel waiting
        sys.excepthook(type(problem), problem, problem.__traceback__)
        return CodecError("this motion could not be measured", got=repr(problem))


def _session(motion: Motion, sessions: OrderedDict[Motion, LabSession]) -> LabSession:
    load_libraries()
    from qmd_studio.tuning.lab_session import LabSession  # compiled kernels come with it: not before they are wanted

    session = sessions.get(motion)
    if session is None:
        session = sessions[motion] = LabSession(motion)
        while len(sessions) > CACHED_SESSIONS:
            sessions.popitem(last=False)
    sessions.move_to_end(motion)
    return session
