"""The timeline: an error strip's place, the ruler, and the transport."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction, QFontMetrics
from PySide6.QtWidgets import QDoubleSpinBox, QFrame, QHBoxLayout, QLabel, QLineEdit, QToolButton, QVBoxLayout, QWidget

from qmd_studio.errors import EditError
from qmd_studio.project.playhead import SPEEDS, Playhead
from qmd_studio.project.timecode import clock_text, parse_frame
from qmd_studio.ui.actions import Actions
from qmd_studio.ui.icons import icon
from qmd_studio.ui.ruler import Ruler

_TRANSPORT = ("first_frame", "previous_frame", "play_reverse", "play", "next_frame", "last_frame")


class Timeline(QFrame):
    """Follows the playhead and moves it. `refused` tells of a place typed that is none."""

    refused = Signal(EditError)

    def __init__(self, playhead: Playhead, actions: Actions, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("Timeline")
        self._playhead, self._actions = playhead, actions
        self.ruler = Ruler(playhead)
        self.place = self._place_field()
        self.speed = self._speed_field()
        self._of = QLabel()
        self._of.setProperty("muted", True)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self._column.addWidget(self.ruler)
        self._column.addLayout(self._transport())
        playhead.moved.connect(self._show_place)
        playhead.state_changed.connect(self.refresh)
        self.refresh()

    def set_strip(self, strip: QWidget) -> None:
        """Put `strip` above the ruler, its frames over the ruler's (`strip.set_span` is told where they are)."""
        self._column.insertWidget(0, strip)
        strip.set_span(*self.ruler.ends)
        self.ruler.span_changed.connect(strip.set_span)

    def edit_place(self) -> None:
        """Let the user type where to go."""
        self.place.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.place.selectAll()

    def refresh(self) -> None:
        """Show the playhead's state."""
        playhead = self._playhead
        play = self._actions["play"]
        play.setIcon(icon("pause" if playhead.playing and playhead.speed > 0 else "play"))
        self._actions["play_reverse"].setIcon(icon("pause" if playhead.playing and playhead.speed < 0 else "reverse"))
        self._actions["loop"].setChecked(playhead.loop)
        with QSignalBlocker(self.speed):
            self.speed.setValue(abs(playhead.speed))
        last = playhead.n_frames - 1
        self._of.setText(self.tr("of {last}  ·  {time}").format(last=last, time=clock_text(last / playhead.fps)))
        self._show_place()

    def _show_place(self, _index: int = 0) -> None:
        if not self.place.hasFocus():
            self.place.setText(str(self._playhead.index))
        self.ruler.update()

    def _transport(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(12, 4, 12, 4)
        row.setSpacing(4)
        for verb in _TRANSPORT:
            row.addWidget(_button(self._actions[verb]))
        row.addSpacing(8)
        row.addWidget(_button(self._actions["loop"]))
        row.addSpacing(8)
        row.addWidget(self.speed)
        row.addStretch(1)
        caption = QLabel(self.tr("Fra&me"))
        caption.setBuddy(self.place)
        caption.setProperty("muted", True)
        row.addWidget(caption)
        row.addWidget(self.place)
        row.addWidget(self._of)
        return row

    def _place_field(self) -> QLineEdit:
        field = QLineEdit()
        field.setAccessibleName(self.tr("Frame or time"))
        field.setToolTip(self.tr("Frame (123), seconds (4.1s) or time (0:04.1); Enter goes there  (Ctrl+G)"))
        field.setAlignment(Qt.AlignmentFlag.AlignRight)
        field.setFixedWidth(QFontMetrics(field.font()).horizontalAdvance("0:00:00.00") + 24)
        field.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        field.returnPressed.connect(self._go)
        field.editingFinished.connect(self._show_place)
        return field

    def _speed_field(self) -> QDoubleSpinBox:
        field = QDoubleSpinBox()
        field.setAccessibleName(self.tr("Speed"))
        field.setToolTip(self.tr("Speed of playing, 0.1 to 4 times the clip's own  (Ctrl+Up, Ctrl+Down)"))
        field.setRange(*SPEEDS)
        field.setSingleStep(0.1)
        field.setDecimals(2)
        field.setSuffix(" ×")
        field.setKeyboardTracking(False)
        field.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        field.valueChanged.connect(self._set_speed)
        return field

    def _set_speed(self, speed: float) -> None:
        self._playhead.speed = -speed if self._playhead.speed < 0 else speed

    def _go(self) -> None:
        try:
            frame = parse_frame(self.place.text(), self._playhead.fps)
        except EditError as problem:
            self.refused.emit(problem)
            self.place.selectAll()
            return
        self._playhead.playing = False
        self._playhead.seek(float(frame))
        self.place.clearFocus()
        self._show_place()


def _button(action: QAction) -> QToolButton:
    button = QToolButton()
    button.setDefaultAction(action)
    button.setAccessibleName(action.text().replace("&", ""))
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.setAutoRaise(True)
    return button
