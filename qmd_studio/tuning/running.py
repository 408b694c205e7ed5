"""Trying columns of a grid on all cores, so that whoever waits can look on and can stop it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from qmd_studio.tuning.grid import Column
from qmd_studio.tuning.trial import Cancel, Evaluator, Never, Trial

THREAD_NAME = "qmd-tuning"
"""How the names of threads that try settings begin."""

_WAITING_EACH = 2
"""Columns handed to a thread ahead of time: enough to keep it busy, few enough to stop soon."""


def run_columns(
    evaluator: Evaluator, columns: Iterable[Column], *, cancel: Cancel | None = None, n_threads: int | None = None
) -> Iterator[list[Trial]]:
    """Yield the trials of each column as they are done, in no certain order.

    It ends early once `cancel` is set. When it has ended, been closed or raised, no thread of it runs any more; Ctrl+C
    alone does not wait for them. The kernels leave the interpreter to others, so threads (one a core unless
    `n_threads` says otherwise) keep all busy.
    """
    cancel = cancel or Never()
    threads = n_threads or os.cpu_count() or 1
    rest = iter(columns)
    pool = ThreadPoolExecutor(threads, thread_name_prefix=THREAD_NAME)
    interrupted = False
    try:
        running: set[Future[list[Trial]]] = set()
        while not cancel.is_set():
            while len(running) < threads * _WAITING_EACH and (column := next(rest, None)) is not None:
                running.add(pool.submit(_try, evaluator, column, cancel))
            if not running:
                break
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    except KeyboardInterrupt:
        interrupted = True
        raise
    finally:
        pool.shutdown(wait=not interrupted, cancel_futures=True)


def _try(evaluator: Evaluator, column: Column, cancel: Cancel) -> list[Trial]:
    return [] if cancel.is_set() else evaluator.try_bits(column.fdf, column.segment, column.bits)
