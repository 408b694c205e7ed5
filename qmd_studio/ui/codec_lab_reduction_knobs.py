"""Two knobs before any codec: fewer frames, and fewer joints; folded away as long as all are kept."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QSizePolicy, QToolButton, QVBoxLayout, QWidget

from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.tuning.encode_settings import has_articulation
from qmd_studio.tuning.reduction import MAX_LOA, Reduction
from qmd_studio.ui.codec_lab_knob import Knob
from qmd_studio.ui.quantity import frame_rate

_EVERY = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 24, 30)
_FARTHEST = 1000


class ReductionKnobs(QWidget):
    """Emits `changed(Reduction, str)` with what is left out now and the knob that says so, `settled` after a drag."""

    changed = Signal(object, str)
    settled = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._reduction, self._by_loa = Reduction(), False
        self._unfolded: bool | None = None
        self.fold = QToolButton(self)
        self.room = QWidget(self)
        self.every = Knob(
            "every", symbol="K", title=self.tr("keep every K-th frame"), tip=self._every_tip(), parent=self.room
        )
        self.level = Knob(
            "level", symbol="L", title=self.tr("joints up to level"), tip=self._level_tip(), parent=self.room
        )
        self._dress()
        self._lay_out()
        self._connect()

    @property
    def held(self) -> bool:
        """Whether a slider is being dragged."""
        return self.every.slider.isSliderDown() or self.level.slider.isSliderDown()

    def show_reduction(self, motion: Motion, reduction: Reduction) -> None:
        """Show what `reduction`, which fits `motion`, leaves of it."""
        self._reduction, self._by_loa = reduction, has_articulation(motion)
        most = max(1, min(motion.n_frames, _FARTHEST))
        self.every.set_stops(tuple(k for k in _EVERY if k <= most), limits=(1, most))
        n_kept, fps = reduction.n_rows(motion.n_frames) + 1, motion.fps / reduction.fps_divisor
        frames = self._part(n_kept, motion.n_frames, self.tr("frames"))
        self.every.show_value(reduction.fps_divisor, self._frames_meaning(frames, fps, reduction))
        columns = self._part(reduction.n_columns(motion.skeleton), motion.skeleton.n_columns, self.tr("columns"))
        self._show_level(reduction, columns)
        kept = f"{frames}, {columns}"
        self.fold.setText(self.tr("Frame rate and joints: all kept") if reduction == Reduction() else kept)
        self.fold.setAccessibleName(self.tr("Fewer frames and joints: {what}").format(what=kept))
        self._show_room()

    def _show_level(self, reduction: Reduction, columns: str) -> None:
        if self._by_loa:
            self.level.label.setText(self.tr("<b>LOA</b> level of articulation"))
            self.level.set_stops(tuple(range(MAX_LOA + 1)))
            self.level.show_value(MAX_LOA if reduction.max_loa is None else reduction.max_loa, columns)
        else:
            self.level.label.setText(self.tr("<b>L</b> joints up to level"))
            self.level.set_stops(tuple(range(1, MAX_LEVEL + 1)))
            self.level.show_value(reduction.max_level, columns)

    def _part(self, kept: int, of: int, what: str) -> str:
        if kept == of:
            return self.tr("all {n:,} {what}").format(n=of, what=what)
        return self.tr("{n:,} of {of:,} {what}").format(n=kept, of=of, what=what)

    def _frames_meaning(self, frames: str, fps: float, reduction: Reduction) -> str:
        rate = self.tr("{frames}, {rate}").format(frames=frames, rate=frame_rate(fps))
        return rate if reduction.fps_divisor == 1 else self.tr("{rate}; filled in when played").format(rate=rate)

    def _set_level(self, level: int) -> None:
        if self._by_loa:
            change = {"max_loa": None if level >= MAX_LOA else level, "max_level": MAX_LEVEL}
        else:
            change = {"max_level": level}
        self.changed.emit(replace(self._reduction, **change), "level")

    def _set_every(self, every: int) -> None:
        self.changed.emit(replace(self._reduction, fps_divisor=every), "every")

    def _reset(self, knob: Knob, value: int) -> None:
        self.settled.emit()
        knob.moved.emit(value)
        self.settled.emit()

    @property
    def unfolded(self) -> bool:
        """Whether the knobs are seen: as the user chose, and otherwise where something is left out."""
        return self._reduction != Reduction() if self._unfolded is None else self._unfolded

    def _press_fold(self) -> None:
        self._unfolded = not self.unfolded
        self._show_room()

    def _show_room(self) -> None:
        unfolded = self.unfolded
        self.room.setVisible(unfolded)
        self.fold.setArrowType(Qt.ArrowType.DownArrow if unfolded else Qt.ArrowType.RightArrow)

    def _connect(self) -> None:
        self.fold.clicked.connect(self._press_fold)
        self.every.moved.connect(self._set_every)
        self.level.moved.connect(self._set_level)
        self.every.reset_wanted.connect(lambda: self._reset(self.every, 1))
        self.level.reset_wanted.connect(lambda: self._reset(self.level, MAX_LOA if self._by_loa else MAX_LEVEL))
        for knob in (self.every, self.level):
            knob.settled.connect(self.settled)

    def _dress(self) -> None:
        self.fold.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.fold.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.fold.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.fold.setAutoRaise(True)
        self.fold.setToolTip(self.tr("Leave out frames and joints before encoding: what everybody tries first"))

    def _lay_out(self) -> None:
        inner = QVBoxLayout(self.room)
        inner.setContentsMargins(0, 0, 0, 0)
        inner.setSpacing(12)
        inner.addWidget(self.every)
        inner.addWidget(self.level)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addWidget(self.fold)
        layout.addWidget(self.room)

    def _every_tip(self) -> str:
        return self.tr(
            "Every K-th frame is encoded, at a K-th of the frame rate; a player fills in the poses between. Errors are "
            "against every frame of the original."
        )

    def _level_tip(self) -> str:
        return self.tr(
            "Columns of a higher level stay as they are in the first frame: 1 is the root, 6 a finger. Of bodies with "
            "animation parameters the joints go that an H-Anim body of that level of articulation lacks."
        )
