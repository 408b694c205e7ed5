"""One motion in the codec lab: any profile, encoder and reduction, measured against all of the original."""

from __future__ import annotations

import time
from collections import OrderedDict
from threading import Event

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.target import meet_target
from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SEGMENT_HEADER_BYTES
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.budget import Budget, budget_of_file, budget_of_settings
from qmd_studio.tuning.compact_size import compact_breakdown
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.lab_report import Found, LabReport
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.session import TuningSession
from qmd_studio.tuning.size_figures import figures_of

_REDUCTIONS_KEPT = 2


class LabSession:
    """The motion `motion`, ready to be encoded again and again; one thread at a time.

    Raises `CodecError` where the motion cannot be encoded at all.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self._whole = TuningSession(motion)
        self._sessions: OrderedDict[Reduction, ReducedSession] = OrderedDict()

    def evaluate(self, settings: EncodeSettings, *, draft: bool = False, cancel: Event | None = None) -> LabReport:
        """Encode, decode, play and measure; `settings` are fitted to the motion first.

        Raises `CodecError` for bad settings and for an error that cannot be kept to, `Cancelled` soon after `cancel` is
        set where that takes long.
        """
        settings = settings.fitted(self.motion)
        if isinstance(settings.coding, CompactSettings):
            return self._compact(settings, settings.coding)
        return self._paper(settings, settings.coding, draft=draft, cancel=cancel)

    def _paper(self, settings: EncodeSettings, coding: QmdSettings, *, draft: bool, cancel: Event | None) -> LabReport:
        started = time.perf_counter()
        session = self._session(settings.reduction)
        report = session.evaluate(coding, draft=draft, cancel=cancel)
        segments = report.size.header_bytes // SEGMENT_HEADER_BYTES
        rows, columns = session.reduced.n_frames - 1, session.reduced.skeleton.n_columns
        known = settings.size_is_known

        def budget() -> Budget:
            if not known:
                return budget_of_file(report.data)
            return budget_of_settings(coding, rows, columns, file_bytes=report.file_bytes)

        return LabReport(
            settings=settings,
            size=figures_of(self.motion, settings.reduction, report.size, segments),
            error=report.error,
            fps=session.reduced.fps,
            seconds=time.perf_counter() - started,
            draft=report.draft,
            found=_found(report.data) if settings.is_bounded else None,
            _assemble=lambda: report.data,
            _decode=lambda: report.decoded,
            _play=session.played,
            _reckon=budget,
        )

    def _compact(self, settings: EncodeSettings, coding: CompactSettings) -> LabReport:
        started = time.perf_counter()
        session = self._session(settings.reduction)
        motion = session.reduced
        outcome = meet_target(motion, coding)
        size = compact_breakdown(outcome.payload)
        decoded = motion.with_values(motion_matrix(outcome.decoded, motion.skeleton))
        data = container.build_compact(outcome.payload, pack_skeleton_block(motion), motion.fps, coding.segment)
        return LabReport(
            settings=settings,
            size=figures_of(self.motion, settings.reduction, size, size.n_segments),
            error=session.measured(decoded),
            fps=session.reduced.fps,
            seconds=time.perf_counter() - started,
            draft=False,
            found=None,
            _assemble=lambda: data,
            _decode=lambda: decoded,
            _play=session.played,
            _reckon=lambda: budget_of_file(data),
        )

    def _session(self, reduction: Reduction) -> ReducedSession:
        session = self._sessions.pop(reduction, None) or ReducedSession(self.motion, reduction, self._whole)
        self._sessions[reduction] = session
        while len(self._sessions) > _REDUCTIONS_KEPT:
            self._sessions.popitem(last=False)
        return session


def _found(data: bytes) -> Found:
    facts = describe(data)
    return Found(facts["fdf"], facts["bits"], facts["segments"])
