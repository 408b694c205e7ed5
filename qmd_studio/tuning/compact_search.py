"""What is made for an error among the searches: what it comes to, and the setting that meets a target."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from threading import Event

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import Cancelled, CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings
from qmd_studio.tuning.lab_session import LabSession
from qmd_studio.tuning.outcome import OnProgress, Outcome, Progress
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.targets import Target, TargetKind
from qmd_studio.tuning.trial import Cancel, Never, Trial

FRONT_ERRORS_MM = (0.5, 5.0, 0.05, 2.0, 0.2, 10.0, 0.1, 1.0, 0.02, 20.0)
"""The mean errors that a front is drawn from, those far apart first."""

_FINEST_MM, _COARSEST_MM = 1e-3, 1e3
_STEPS = 13
"""Halvings of that range: to a thousandth of a decade or so."""

_DIGITS = 3
"""An error in settings has as many digits as a person would type."""


def compact_trials(session: LabSession, reduction: Reduction) -> Iterator[Trial | None]:
    """Yield what the compact profile comes to at each of `FRONT_ERRORS_MM`, in segments and in one; None where not."""
    for error in FRONT_ERRORS_MM:
        for segment in (COMPACT_DEFAULT.segment, 0):
            yield tried(session, EncodeSettings(CompactSettings(mean_error_mm=error, segment=segment), reduction))


def tried(session: LabSession, settings: EncodeSettings, cancel: Event | None = None) -> Trial | None:
    """Return what `settings` come to, None where they cannot be kept to; raises `Cancelled` as the session does."""
    try:
        report = session.evaluate(settings, cancel=cancel)
    except CodecError:
        return None
    error = report.error
    return Trial(report.settings, report.size.payload.bytes, error.def_, error.mean_mm, error.max_mm)


def meet_compact(
    motion: Motion,
    base: EncodeSettings,
    target: Target,
    *,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> Outcome:
    """Return the compact setting, in the segments and under the reduction of `base`, that meets `target` best.

    A mean or a worst error is asked of the encoder itself; for a size, a rate or a DEF the mean error is halved in on.
    """
    cancel, started, session = cancel or Never(), time.perf_counter(), LabSession(motion)
    coding = base.compact or COMPACT_DEFAULT
    trials: list[Trial] = []

    def attempt(mean_mm: float | None = None, worst_mm: float | None = None) -> Trial | None:
        asked = replace(coding, mean_error_mm=mean_mm, max_error_mm=worst_mm)
        trial = tried(session, EncodeSettings(asked, base.reduction))
        if trial is not None:
            trials.append(trial)
            if on_progress:
                on_progress(Progress(len(trials), _STEPS + 2, min(trials, key=target.rank(motion)), (trial,)))
        return trial

    if target.kind is TargetKind.MAX_MM:
        attempt(worst_mm=target.value)
    elif target.kind is TargetKind.MEAN_MM:
        attempt(mean_mm=target.value)
    if not any(target.met_by(trial, motion) for trial in trials):
        _halve(attempt, target, motion, cancel)
    return Outcome(
        best=min(trials, key=target.rank(motion), default=None),
        trials=tuple(trials),
        evaluations=len(trials),
        seconds=time.perf_counter() - started,
        complete=not cancel.is_set(),
    )


def meet_bounded(motion: Motion, base: EncodeSettings, target: Target, *, cancel: Event | None = None) -> Outcome:
    """Return what the bounded encoder finds for a worst distance; what it can reach where it cannot keep that.

    With frames left out the bound holds where they were kept, so the file may miss a target that the encoder met.
    """
    started, session = time.perf_counter(), LabSession(motion)
    settings = replace(base, coding=replace(base.paper or QmdSettings(), max_error_mm=target.value))
    try:
        trial = tried(session, settings, cancel)
    except Cancelled:
        return Outcome(None, (), 0, time.perf_counter() - started, complete=False)
    trials = (trial,) if trial else ()
    return Outcome(trial, trials, 1, time.perf_counter() - started, complete=True)


def _halve(attempt: Callable[[float], Trial | None], target: Target, motion: Motion, cancel: Cancel) -> None:
    """Close in on the mean error where the target begins, or ceases, to be met."""
    low, high = math.log10(_FINEST_MM), math.log10(_COARSEST_MM)
    for _ in range(_STEPS):
        if cancel.is_set():
            return
        middle = (low + high) / 2
        trial = attempt(_rounded(10.0**middle))
        met = trial is not None and target.met_by(trial, motion)
        coarser = met != target.bounds_size if trial is not None else True
        low, high = (middle, high) if coarser else (low, middle)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
