"""All knobs of a side of the codec lab: the profile with the knobs it has, and what is left out before."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings, Profile
from qmd_studio.tuning.lab_report import LabReport
from qmd_studio.tuning.reachable import reachable_mm
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.codec_lab_compact_knobs import CompactKnobs
from qmd_studio.ui.codec_lab_paper_knobs import PaperKnobs
from qmd_studio.ui.codec_lab_reduction_knobs import ReductionKnobs
from qmd_studio.ui.quantity import millimetres


class Knobs(QWidget):
    """Emits `changed(EncodeSettings, str)` with the new settings and the knob that made them, `settled` after a drag.

    `levels_wanted` asks for the table of the columns' levels.
    """

    changed = Signal(object, str)
    settled = Signal()
    levels_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._settings = EncodeSettings()
        self._last: dict[Profile, QmdSettings | CompactSettings] = {
            Profile.PAPER: QmdSettings(),
            Profile.COMPACT: COMPACT_DEFAULT,
        }
        self.profile = ChoiceBar(self.tr("Profile"), self._profiles(), self)
        self.paper, self.compact, self.reduction = PaperKnobs(self), CompactKnobs(self), ReductionKnobs(self)
        self._lay_out()
        self._connect()

    @property
    def held(self) -> bool:
        """Whether a slider is being dragged."""
        return self.paper.held or self.compact.held or self.reduction.held

    def show_settings(self, motion: Motion, settings: EncodeSettings) -> None:
        """Show `settings`, which fit `motion`."""
        self._settings = settings
        self._last[settings.profile] = settings.coding
        self.profile.show_choice(str(settings.profile))
        self.paper.setVisible(settings.paper is not None)
        self.compact.setVisible(settings.compact is not None)
        if settings.paper is not None:
            n_rows = settings.reduction.n_rows(motion.n_frames)
            self.paper.show_settings(_skeleton_left(motion, settings.reduction), n_rows, settings.paper)
        if settings.compact is not None:
            self.compact.show_settings(settings.compact)
        self.reduction.show_reduction(motion, settings.reduction)

    def show_report(self, report: LabReport) -> None:
        """Say beside a knob that asks for an error what came of it; `report` is of the settings that are shown."""
        if report.found is not None:
            self.paper.show_found(report.found)
        if report.settings.compact is not None:
            words = self.tr("reached: mean {mean}, worst {worst}")
            mean, worst = millimetres(report.error.mean_mm), millimetres(report.error.max_mm)
            self.compact.error.say(words.format(mean=mean, worst=worst))

    def show_looking(self) -> None:
        """Say beside a knob that asks for an error that it is not known yet what comes of it."""
        for knob in (self.paper.bound, self.compact.error):
            knob.look()

    def show_stop(self) -> None:
        """Say nothing more of what was looked for."""
        for knob in (self.paper.bound, self.compact.error):
            knob.say("")

    def show_problem(self, problem: QmdStudioError) -> None:
        """Say beside a knob that asks for an error that it cannot be kept to, and what is the best."""
        best = reachable_mm(problem)
        if best is None:
            return
        words = self.tr("cannot be met; the best reachable is {best:g} mm").format(best=best)
        if self._settings.is_bounded:
            self.paper.bound.say(words)
        elif self._settings.compact is not None:
            self.compact.error.say(words)

    def _choose_profile(self, key: str) -> None:
        profile = Profile(key)
        if profile is not self._settings.profile:
            self.settled.emit()
            self.changed.emit(replace(self._settings, coding=self._last[profile]), "profile")
            self.settled.emit()

    def _change_coding(self, coding: QmdSettings | CompactSettings, knob: str) -> None:
        self.changed.emit(replace(self._settings, coding=coding), knob)

    def _change_reduction(self, reduction: Reduction, knob: str) -> None:
        self.changed.emit(replace(self._settings, reduction=reduction), knob)

    def _connect(self) -> None:
        self.profile.chosen.connect(self._choose_profile)
        self.paper.changed.connect(self._change_coding)
        self.compact.changed.connect(self._change_coding)
        self.reduction.changed.connect(self._change_reduction)
        self.paper.levels_wanted.connect(self.levels_wanted)
        for knobs in (self.paper, self.compact, self.reduction):
            knobs.settled.connect(self.settled)

    def _lay_out(self) -> None:
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(12)
        for widget in (self.profile, self.paper, self.compact, self.reduction):
            layout.addWidget(widget)

    def _profiles(self) -> tuple[Choice, ...]:
        return (
            Choice(
                str(Profile.PAPER),
                self.tr("Paper's format"),
                self.tr("Version 1: any QMD decoder plays it, with next to no work"),
            ),
            Choice(
                str(Profile.COMPACT),
                self.tr("Compact"),
                self.tr("Version 2: made for an error, several times smaller, more work to decode"),
            ),
        )


def _skeleton_left(motion: Motion, reduction: Reduction) -> Skeleton:
    """Return the skeleton that is encoded: one pose is enough to know it."""
    if reduction.n_columns(motion.skeleton) == motion.skeleton.n_columns:
        return motion.skeleton
    return replace(reduction, fps_divisor=1).reduce(replace(motion, X=motion.X[:1], mask=None)).skeleton
