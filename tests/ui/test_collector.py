"""Cycles are collected on the window's own thread, and nowhere else."""

import gc
import threading
import weakref

from qmd_studio.ui.collector import Collector


class Cycle:
    def __init__(self, seen):
        self.itself = self
        weakref.finalize(self, lambda: seen.append(threading.get_ident()))


def make_garbage(seen):
    Cycle(seen)
    for _ in range(20 * gc.get_threshold()[0]):  # enough for Python's own collector, were it at work
        [[]].append([])


def test_cycles_of_a_worker_are_collected_on_this_thread(qtbot):
    collector, seen = Collector(), []
    try:
        worker = threading.Thread(target=make_garbage, args=(seen,))
        worker.start()
        worker.join()
        kept = []

        def work_goes_on():
            # The window keeps allocating. A single batch is not enough: what earlier tests left for the event loop to
            # delete takes as many off Python's count as the batch has put on it.
            kept.extend([] for _ in range(2 * gc.get_threshold()[0]))
            return bool(seen)

        qtbot.waitUntil(work_goes_on)
    finally:
        collector.stop()
    assert seen == [threading.get_ident()]
    assert gc.isenabled()
