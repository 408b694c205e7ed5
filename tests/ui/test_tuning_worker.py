"""The worker: the newest request wins, what is out of date is dropped, and the window stays alive meanwhile."""

import sys
import threading

import pytest
from PySide6.QtCore import QTimer

from qmd_studio.errors import CodecError
from qmd_studio.tuning import lab_session as session_module
from qmd_studio.ui import tuning_worker
from qmd_studio.ui.tuning_worker import TuningWorker
from tests.generated_motion import walker
from tests.paper_settings import paper


@pytest.fixture
def motion():
    return walker(60)


@pytest.fixture
def worker(qtbot):
    worker = TuningWorker()
    worker.outcomes, worker.problems = [], []
    worker.measured.connect(lambda report: worker.outcomes.append(report.settings))
    worker.failed.connect(worker.problems.append)
    yield worker
    worker.close()


class Gate:
    """Holds every evaluation up until it is let through, and notes what was begun."""

    def __init__(self, monkeypatch):
        self.begun, self.entered, self._let = [], threading.Event(), threading.Semaphore(0)
        evaluate = session_module.LabSession.evaluate

        def held(session, settings, **how):
            self.begun.append(settings)
            self.entered.set()
            assert self._let.acquire(timeout=30)
            return evaluate(session, settings, **how)

        monkeypatch.setattr(session_module.LabSession, "evaluate", held)

    def let(self, count=1000):
        """Let `count` evaluations through."""
        self._let.release(count)


@pytest.fixture
def gate(monkeypatch, worker):
    gate = Gate(monkeypatch)
    yield gate
    gate.let()


def settled(qtbot, worker):
    qtbot.waitUntil(lambda: not worker.pending, timeout=30_000)


def test_a_request_is_measured(qtbot, worker, motion):
    with qtbot.waitSignal(worker.measured, timeout=30_000) as caught:
        worker.request(motion, paper(fdf=3))
    report = caught.args[0]
    assert report.settings == paper(fdf=3)
    assert report.file_bytes == len(report.data)
    assert not worker.pending


def test_of_many_requests_the_first_and_the_newest_are_begun_and_told_in_this_order(qtbot, worker, motion, gate):
    worker.request(motion, paper(fdf=0))
    assert gate.entered.wait(30)
    for fdf in range(1, 60):
        worker.request(motion, paper(fdf=fdf))
    gate.let(1)
    qtbot.waitUntil(lambda: bool(worker.outcomes), timeout=30_000)  # the window looks between the two
    gate.let()
    settled(qtbot, worker)
    assert [s.coding.fdf for s in gate.begun] == [0, 59]
    assert [s.coding.fdf for s in worker.outcomes] == [0, 59]


def test_nothing_is_told_of_a_request_that_was_cancelled(qtbot, worker, motion, gate):
    worker.request(motion, paper(fdf=1))
    assert gate.entered.wait(30)
    worker.cancel()
    assert not worker.pending
    gate.let()
    worker.request(motion, paper(fdf=2))
    settled(qtbot, worker)
    assert [s.coding.fdf for s in worker.outcomes] == [2]


def test_nothing_is_told_of_a_motion_that_has_been_left(qtbot, worker, motion, gate):
    worker.request(motion, paper(fdf=1))
    assert gate.entered.wait(30)
    worker.request(walker(60, seed=3), paper(fdf=2))
    gate.let()
    settled(qtbot, worker)
    assert [s.coding.fdf for s in worker.outcomes] == [2]


def test_a_result_that_comes_after_a_newer_one_is_not_told(qtbot, worker, motion, gate):
    gate.let(1)
    worker.request(motion, paper(fdf=1))
    settled(qtbot, worker)
    gate.entered.clear()
    worker.request(motion, paper(fdf=2))
    assert gate.entered.wait(30)
    worker.request(motion, paper(fdf=1))  # remembered: told at once
    gate.let()
    worker.request(motion, paper(fdf=3))
    settled(qtbot, worker)
    assert [s.coding.fdf for s in worker.outcomes] == [1, 1, 3]


def test_the_event_loop_goes_on_while_something_is_measured(qtbot, worker, motion, gate):
    beats = []
    heart = QTimer(interval=1)
    heart.timeout.connect(lambda: beats.append(worker.pending))
    worker.request(motion, paper())
    assert gate.entered.wait(30)
    heart.start()
    qtbot.waitUntil(lambda: beats.count(True) >= 20, timeout=30_000)
    gate.let()
    settled(qtbot, worker)


def test_what_was_measured_a_moment_ago_comes_at_once(qtbot, worker, motion):
    for fdf in (1, 2):
        worker.request(motion, paper(fdf=fdf))
        settled(qtbot, worker)
    worker.request(motion, paper(fdf=1))
    assert not worker.pending
    assert [s.coding.fdf for s in worker.outcomes] == [1, 2, 1]


def test_a_draft_is_not_remembered_and_an_exact_report_serves_for_it(qtbot, worker, motion):
    reports = []
    worker.measured.connect(reports.append)
    for draft in (True, False):
        worker.request(motion, paper(), draft=draft)
        settled(qtbot, worker)
    worker.request(motion, paper(), draft=True)
    assert not worker.pending
    assert [report.draft for report in reports] == [True, False, False]


def test_another_motion_is_measured_for_itself(qtbot, worker, motion):
    reports = []
    worker.measured.connect(reports.append)
    for each in (motion, walker(60, seed=2), motion):
        worker.request(each, paper())
        settled(qtbot, worker)
    assert reports[0].data == reports[2].data != reports[1].data


def test_settings_that_cannot_be_encoded_are_told_as_an_error(qtbot, worker, motion):
    worker.request(motion, paper(bits=1000))
    settled(qtbot, worker)
    assert [type(problem) for problem in worker.problems] == [CodecError]
    worker.request(motion, paper(fdf=4))
    settled(qtbot, worker)
    assert [s.coding.fdf for s in worker.outcomes] == [4]


def test_a_mistake_of_the_studio_leaves_nobody_waiting(qtbot, worker, motion, monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "excepthook", lambda *what: seen.append(what[0]))

    def broken(session, settings, **how):
        raise ZeroDivisionError

    monkeypatch.setattr(session_module.LabSession, "evaluate", broken)
    worker.request(motion, paper())
    settled(qtbot, worker)
    assert [type(problem) for problem in worker.problems] == [CodecError]
    assert seen == [ZeroDivisionError]


def test_a_thread_that_has_nothing_to_do_goes_home_and_another_comes(qtbot, worker, motion, monkeypatch):
    monkeypatch.setattr(tuning_worker, "IDLE_S", 0.01)
    worker.request(motion, paper(fdf=1))
    settled(qtbot, worker)
    qtbot.waitUntil(lambda: not any(t.name == "tuning" for t in threading.enumerate()), timeout=30_000)
    worker.request(motion, paper(fdf=2))
    settled(qtbot, worker)
    assert [s.coding.fdf for s in worker.outcomes] == [1, 2]


def test_closing_waits_for_the_thread_and_tells_nothing(qapp, worker, motion, gate):
    worker.request(motion, paper())
    assert gate.entered.wait(30)
    gate.let()
    worker.close()
    assert not any(t.name == "tuning" for t in threading.enumerate())
    qapp.processEvents()
    worker.request(motion, paper(fdf=2))
    assert worker.outcomes == []
