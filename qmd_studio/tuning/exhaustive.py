"""The paper's exhaustive search (section 5.4): every setting of a grid, the one with the least bytes times DEF."""

from __future__ import annotations

import time
from dataclasses import replace

from qmd_studio.tuning.attempts import Rank, by_merit
from qmd_studio.tuning.grid import Column, Grid
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import OnProgress, Outcome, Progress
from qmd_studio.tuning.running import run_columns
from qmd_studio.tuning.trial import Cancel, Evaluator, Never, Trial


def exhaustive(
    evaluator: Evaluator,
    grid: Grid,
    *,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
    memory: Memory | None = None,
    n_threads: int | None = None,
    rank: Rank = by_merit,
) -> Outcome:
    """Try all of `grid` and return the best by `rank`, least first: bytes times DEF, fewer bytes where that is equal.

    `memory` is asked first and told afterwards. A search that `cancel` stops returns what it has, `complete` False.
    """
    cancel, memory = cancel or Never(), memory or Memory(evaluator)
    started = time.perf_counter()
    columns = list(grid.columns(evaluator.motion))
    total = sum(len(column.bits) for column in columns)
    trials, missing = _split(columns, memory)
    n_known = len(trials)
    best = min(trials, key=rank, default=None)
    if on_progress:
        on_progress(Progress(n_known, total, best, tuple(trials)))
    try:
        for latest in run_columns(evaluator, missing, cancel=cancel, n_threads=n_threads):
            memory.add(latest)
            trials += latest
            best = min([*latest, *([best] if best else [])], key=rank, default=None)
            if on_progress:
                on_progress(Progress(len(trials), total, best, tuple(latest)))
    finally:
        memory.save()
    return Outcome(
        best=best,
        trials=tuple(trials),
        evaluations=len(trials) - n_known,
        seconds=time.perf_counter() - started,
        complete=len(trials) == total,
    )


def _split(columns: list[Column], memory: Memory) -> tuple[list[Trial], list[Column]]:
    """Return the trials that are known already, and the columns that remain to be tried."""
    known: list[Trial] = []
    missing: list[Column] = []
    for column in columns:
        found = {bits: memory.get(column.fdf, bits, column.segment) for bits in column.bits}
        known += [trial for trial in found.values() if trial]
        bits = tuple(width for width, trial in found.items() if not trial)
        if bits:
            missing.append(replace(column, bits=bits))
    return known, missing
