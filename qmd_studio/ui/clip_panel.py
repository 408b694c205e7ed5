"""The clip's properties: what it is, and what can be set about it, through commands."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QFormLayout, QLabel, QVBoxLayout, QWidget

from qmd_studio.errors import QmdStudioError
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.skeleton import SkeletonKind
from qmd_studio.project.commands import MAX_FPS, Command, SetFps, SetLengthUnit
from qmd_studio.project.document import Document
from qmd_studio.project.state import DocumentState
from qmd_studio.project.timecode import clock_text

UNITS: tuple[tuple[str, float], ...] = (
    ("m", 1.0),
    ("dm", 0.1),
    ("cm", 0.01),
    ("mm", 0.001),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("ASF unit", ASF_UNIT_M),
)
"""The length units on offer, in metres; an ASF unit is 1/0.45 inch."""


class ClipPanel(QWidget):
    """Shows the active clip of the document; the frame rate and the file's length unit can be set.

    `refused` tells of a value that the document did not take.
    """

    refused = Signal(QmdStudioError)

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._frames, self._dofs, self._duration = _value(), _value(), _value()
        self._notes = QLabel()
        self._notes.setWordWrap(True)
        self._notes.setProperty("muted", True)
        self.fps, self.unit = self._fps_field(), self._unit_field()
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 12, 12, 12)
        column.setSpacing(8)
        column.addLayout(self._form())
        column.addWidget(self._notes)
        column.addStretch(1)
        document.changed.connect(self._follow)
        self._follow(document.state)

    def _form(self) -> QFormLayout:
        form = QFormLayout()
        form.setHorizontalSpacing(12)
        form.setVerticalSpacing(8)
        form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for text, field in (
            (self.tr("Frames"), self._frames),
            (self.tr("Duration"), self._duration),
            (self.tr("Joints, DOFs"), self._dofs),
            (self.tr("Frame rate"), self.fps),
            (self.tr("Length unit"), self.unit),
        ):
            label = QLabel(text)
            label.setProperty("muted", True)
            label.setBuddy(field)
            form.addRow(label, field)
        return form

    def _fps_field(self) -> QDoubleSpinBox:
        field = _RateField()
        field.setRange(0.01, MAX_FPS)
        field.setDecimals(3)
        field.setSuffix(self.tr(" fps"))
        field.setSpecialValueText("–")
        field.setKeyboardTracking(False)
        field.setAccessibleName(self.tr("Frame rate"))
        field.setToolTip(self.tr("Frames a second of this clip; its frames stay as they are"))
        field.valueChanged.connect(lambda fps: self._execute(lambda key: SetFps(key, fps)))
        return field

    def _unit_field(self) -> QComboBox:
        field = QComboBox()
        field.setAccessibleName(self.tr("Length unit"))
        field.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        field.setMinimumContentsLength(8)
        field.activated.connect(lambda: self._execute(lambda key: SetLengthUnit(key, field.currentData())))
        return field

    def _follow(self, state: DocumentState) -> None:
        clip = state.active_clip
        self.setEnabled(clip is not None)
        if clip is None:
            for label in (self._frames, self._dofs, self._duration):
                label.setText("–")
            self._notes.clear()
            with QSignalBlocker(self.fps):
                self.fps.setValue(self.fps.minimum())
            self.unit.clear()
            return
        motion = clip.motion
        self._frames.setText(str(motion.n_frames))
        self._duration.setText(clock_text(motion.duration_s))
        self._dofs.setText(f"{len(motion.skeleton.joints)}, {motion.skeleton.n_columns}")
        self._notes.setText("\n".join(note[:1].upper() + note[1:] for note in clip.notes))
        self._notes.setVisible(bool(clip.notes))
        with QSignalBlocker(self.fps), QSignalBlocker(self.unit):
            self.fps.setValue(motion.fps)
            self._show_unit(motion.skeleton.metres_per_unit)
        self._offer_unit(motion.skeleton.kind)

    def _offer_unit(self, kind: SkeletonKind) -> None:
        fixed = kind is SkeletonKind.BAP
        self.unit.setEnabled(not fixed)
        self.unit.setToolTip(
            self.tr("Body animation parameters have a unit of their own, millimetres: nothing is to be chosen")
            if fixed
            else self.tr("What one unit of length in the file is; guessed where the file does not say")
        )

    def _show_unit(self, metres: float) -> None:
        self.unit.clear()
        for name, value in UNITS:
            self.unit.addItem(name, value)
            if abs(value / metres - 1.0) < 1e-6:
                self.unit.setCurrentIndex(self.unit.count() - 1)
                metres = value
        if self.unit.currentData() != metres:
            self.unit.addItem(f"{metres:.6g} m", metres)
            self.unit.setCurrentIndex(self.unit.count() - 1)

    def _execute(self, command_for: object) -> None:
        key = self._document.state.active
        if key is None:
            return
        command: Command = command_for(key)
        try:
            self._document.execute(command)
        except QmdStudioError as problem:
            self.refused.emit(problem)
            self._follow(self._document.state)


def _value() -> QLabel:
    label = QLabel("–")
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


class _RateField(QDoubleSpinBox):
    """Shows 120 as "120", and 29.97 as it is."""

    def textFromValue(self, value: float) -> str:
        return self.locale().toString(value, "f", self.decimals()).rstrip("0").rstrip(".,")
