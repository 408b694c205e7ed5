"""Work beside the window: parts are told as they come, the newest wins, what is cancelled stops."""

import sys
import threading

import pytest

from qmd_studio.errors import CodecError
from qmd_studio.ui.background import Background


@pytest.fixture
def background(qtbot):
    background = Background("test-work")
    background.heard = []
    background.told.connect(lambda part: background.heard.append(("told", part)))
    background.ended.connect(lambda value: background.heard.append(("ended", value)))
    background.failed.connect(lambda problem: background.heard.append(("failed", type(problem))))
    yield background
    background.close()


def settled(qtbot, background):
    qtbot.waitUntil(lambda: not background.running, timeout=10_000)


def test_parts_come_before_the_end_and_in_order(qtbot, background):
    def work(_stop, tell):
        for part in range(3):
            tell(part)
        return "done"

    background.run(work)
    settled(qtbot, background)
    assert background.heard == [("told", 0), ("told", 1), ("told", 2), ("ended", "done")]


def test_newer_work_stops_the_older_and_begins_when_that_has_ended(qtbot, background):
    entered, ended = threading.Event(), []

    def old(stop, tell):
        entered.set()
        assert stop.wait(30)
        tell("late")
        ended.append("old")

    background.run(old)
    assert entered.wait(30)
    background.run(lambda _stop, _tell: list(ended))
    settled(qtbot, background)
    assert background.heard == [("ended", ["old"])]


def test_nothing_is_told_after_cancelling_and_no_thread_is_left_after_closing(qapp, background):
    entered = threading.Event()

    def work(stop, tell):
        entered.set()
        assert stop.wait(30)
        tell("late")

    background.run(work)
    assert entered.wait(30)
    background.close()
    qapp.processEvents()
    assert background.heard == []
    assert not any(thread.name == "test-work" for thread in threading.enumerate())


def test_what_goes_wrong_is_told_as_an_error_of_the_studio(qtbot, background, monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "excepthook", lambda *what: seen.append(what[0]))

    def refused(_stop, _tell):
        raise CodecError("no")

    for work in (refused, lambda _stop, _tell: 1 // 0):
        background.run(work)
        settled(qtbot, background)
    assert background.heard == [("failed", CodecError)] * 2
    assert seen == [ZeroDivisionError]
