"""What is seen of a side while it takes long to measure: that it is under way, for how long, and how to stop it."""

from __future__ import annotations

import time

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QProgressBar, QPushButton, QWidget

from qmd_studio.project.state import Side
from qmd_studio.ui.quantity import tabular

SLOW_MS = 500
"""Nothing is said of what takes no longer than this: a flicker tells nobody anything."""

_TICK_MS = 100


class Waiting(QWidget):
    """Hidden until something takes long. `stop_wanted` asks to stop it, `again_wanted` to begin what was stopped."""

    stop_wanted = Signal()
    again_wanted = Signal()

    def __init__(self, side: Side, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._side = side.upper()
        self._started = 0.0
        self._slow = QTimer(self, singleShot=True, interval=SLOW_MS)
        self._tick = QTimer(self, interval=_TICK_MS)
        self.words, self.progress, self.button = QLabel(self), QProgressBar(self), QPushButton(self)
        self._stopped = False
        self._dress()
        self.hide()

    @property
    def stopped(self) -> bool:
        """Whether the user stopped what was under way."""
        return self._stopped

    def begin(self) -> None:
        """Something is under way; one that goes on from another counts as one."""
        self._stopped = False
        if not (self._slow.isActive() or self._tick.isActive()):
            self.hide()
            self._started = time.monotonic()
            self._slow.start()

    def end(self) -> None:
        """Nothing is under way any more."""
        self._stopped = False
        self._rest()
        self.hide()

    def stop(self) -> None:
        """Say that it was stopped, and offer to begin again."""
        self._rest()
        self._stopped = True
        self.words.setText(self.tr("Side {side} was not measured").format(side=self._side))
        self.progress.hide()
        self.button.setText(self.tr("Measure"))
        self.button.setAccessibleName(self.tr("Measure side {side}").format(side=self._side))
        self.show()

    def _rest(self) -> None:
        self._slow.stop()
        self._tick.stop()

    def _show(self) -> None:
        self.progress.show()
        self.button.setText(self.tr("Stop"))
        self.button.setAccessibleName(self.tr("Stop measuring side {side}").format(side=self._side))
        self._count()
        self._tick.start()
        self.show()

    def _count(self) -> None:
        seconds = time.monotonic() - self._started
        self.words.setText(self.tr("Encoding {side}… {seconds:.0f} s").format(side=self._side, seconds=seconds))

    def _press(self) -> None:
        (self.again_wanted if self._stopped else self.stop_wanted).emit()

    def _dress(self) -> None:
        self._slow.timeout.connect(self._show)
        self._tick.timeout.connect(self._count)
        self.words.setFont(tabular(self.font()))
        self.progress.setRange(0, 0)
        self.progress.setMaximumHeight(12)
        self.progress.setTextVisible(False)
        self.progress.setAccessibleName(self.tr("Encoding is under way"))
        self.button.setToolTip(self.tr("Stop encoding these settings, or begin again"))
        self.button.clicked.connect(self._press)
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setHorizontalSpacing(8)
        layout.addWidget(self.words, 0, 0)
        layout.addWidget(self.progress, 0, 1)
        layout.addWidget(self.button, 0, 2)
        layout.setColumnStretch(1, 1)
