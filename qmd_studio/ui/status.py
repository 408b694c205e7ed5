"""The status bar: where the playhead is, what the encoding costs, and what is being worked on."""

from __future__ import annotations

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QLabel, QProgressBar, QStatusBar, QToolButton, QWidget

from qmd_studio.project.playhead import Playhead
from qmd_studio.ui.icons import icon
from qmd_studio.ui.quantity import kilobytes, significant

JOB_DELAY_MS = 500
"""Work that ends sooner shows no progress: it would only flicker."""


class StatusBar(QStatusBar):
    """Follows the playhead; the figures and the job are told to it. `cancelled` asks to drop the job."""

    cancelled = Signal()

    def __init__(self, playhead: Playhead, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._playhead = playhead
        self.setSizeGripEnabled(False)
        self.place, self.figures, self._job = QLabel(), QLabel(), QLabel()
        self.place.setToolTip(self.tr("Frame, time and rate of the shown clip"))
        self.figures.setToolTip(self.tr("Size of the whole QMD file, with what surrounds the payload, and its error"))
        self._progress = QProgressBar()
        self._progress.setRange(0, 0)
        self._progress.setFixedWidth(120)
        self._progress.setMaximumHeight(12)
        self._progress.setTextVisible(False)
        self._cancel = QToolButton()
        self._cancel.setIcon(icon("close"))
        self._cancel.setToolTip(self.tr("Cancel"))
        self._cancel.setAccessibleName(self.tr("Cancel what is under way"))
        self._cancel.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._cancel.clicked.connect(self.cancelled)
        self.addWidget(self.place)
        for widget in (self._job, self._progress, self._cancel, self.figures):
            self.addPermanentWidget(widget)
        self._delay = QTimer(self)
        self._delay.setSingleShot(True)
        self._delay.timeout.connect(lambda: self._show_job(True))
        self._show_job(False)
        playhead.moved.connect(self._show_place)
        playhead.state_changed.connect(self._show_place)
        self._n_clips = 0

    def show_clips(self, n_clips: int) -> None:
        """Say how many clips are open: without one there is no place to show."""
        self._n_clips = n_clips
        self._show_place()

    def show_figures(self, n_bytes: int, def_: float) -> None:
        """Show the size of the QMD file and its DEF (ASF units)."""
        self.figures.setText(
            self.tr("Whole file {size}  ·  DEF {value}").format(size=kilobytes(n_bytes), value=significant(def_))
        )

    def clear_figures(self) -> None:
        """Show no figures: nothing has been measured."""
        self.figures.clear()

    def show_job(self, text: str) -> None:
        """Show what is being worked on, once it takes a while; "" ends it."""
        self._job.setText(text)
        if text:
            self._delay.start(JOB_DELAY_MS)
        else:
            self._delay.stop()
            self._show_job(False)

    def refresh_icons(self) -> None:
        """Draw the icons in the colours of the present theme."""
        self._cancel.setIcon(icon("close"))

    def _show_place(self, _index: int = 0) -> None:
        if not self._n_clips:
            self.place.setText(self.tr("Nothing is open"))
            return
        playhead = self._playhead
        self.place.setText(
            self.tr("Frame {index}/{last}  ·  {time:.2f} s  ·  {fps:g} fps").format(
                index=playhead.index, last=playhead.n_frames - 1, time=playhead.time_s, fps=round(playhead.fps, 3)
            )
        )

    def _show_job(self, visible: bool) -> None:
        for widget in (self._job, self._progress, self._cancel):
            widget.setVisible(visible)
