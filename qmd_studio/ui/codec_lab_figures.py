"""The figures of the codec lab in large type: size at once, errors when they have been measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from qmd_studio.project.state import Side
from qmd_studio.tuning.size_figures import RawFigures, SizeFigures
from qmd_studio.ui.elided_label import ElidedLabel
from qmd_studio.ui.quantity import against, exact_bytes, kilobytes, millimetres, significant, tabular

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport

_LARGE = 1.7
_NONE = "–"


class Figure(QWidget):
    """One figure: its name and how it compares with the other side, the value in large type, a remark below."""

    def __init__(self, name: str, tip: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.value, self.remark = QLabel(_NONE, self), ElidedLabel(self)
        self.name, self.change = QLabel(name, self), QLabel(self)
        self.change.setFont(tabular(self.font()))
        self.change.setToolTip(self.tr("Against the other side: ▼ is less, ▲ is more"))
        self.value.setFont(tabular(self.font(), scale=_LARGE, bold=True))
        self.remark.setFont(tabular(self.font()))
        self.name.setProperty("muted", True)
        self.remark.setProperty("muted", True)
        self.setToolTip(tip)
        self.setAccessibleName(name)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        head = QHBoxLayout()
        head.setSpacing(4)
        head.addWidget(self.name)
        head.addStretch(1)
        head.addWidget(self.change)
        layout.addLayout(head)
        for widget in (self.value, self.remark):
            layout.addWidget(widget)

    def show_value(self, value: str, remark: str = "") -> None:
        """Show a value and the remark under it."""
        self.value.setText(value)
        self.remark.setText(remark)
        self.setAccessibleDescription(f"{value} {remark}".strip())

    def set_stale(self, stale: bool) -> None:
        """Dim the value: it belongs to settings that are no longer shown."""
        for label in (self.value, self.remark):
            label.setEnabled(not stale)


class Figures(QWidget):
    """Size, DEF, mean and worst error; `frame_wanted` asks to go to the frame of the worst error."""

    frame_wanted = Signal(int)

    def __init__(self, side: Side = Side.B, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)  # two columns, alike
        self.setAccessibleName(self.tr("Figures of side {side}").format(side=side.upper()))
        self.numbers: tuple[float | None, float | None, float | None, float | None] = (None, None, None, None)
        """Bytes of the payload, DEF, mean and worst mm, where they are known."""
        self._worst_frame: int | None = None
        self.size = Figure(self.tr("Payload"), self._size_tip(), self)
        self.def_ = Figure(self.tr("DEF"), self._def_tip(), self)
        self.mean = Figure(self.tr("Mean error"), self._mean_tip(), self)
        self.worst = Figure(self.tr("Worst error"), self._worst_tip(), self)
        self.go = QPushButton(self.worst)
        self._dress()
        self._lay_out()
        self.show_nothing()

    def show_size(self, size: SizeFigures | None) -> None:
        """Show the size; None where only encoding will tell: then the old one is dimmed."""
        self.size.set_stale(size is None)
        if size is None:
            self.numbers = (None, *self.numbers[1:])
            return
        self.numbers = (size.payload.bytes, *self.numbers[1:])
        remark = self.tr("{percent:.0f} %, {rate:.0f} kbit/s")
        self.size.show_value(
            kilobytes(size.payload.bytes), remark.format(percent=size.percent_of_raw, rate=size.kbit_s)
        )
        self.size.setToolTip(self._size_tip(size))

    def show_original(self, raw: RawFigures) -> None:
        """Show that this side is the motion as it is: the raw matrix, without error."""
        self.show_nothing()
        self.size.set_stale(False)
        self.numbers = (raw.bytes, 0.0, 0.0, 0.0)
        self.size.show_value(kilobytes(raw.bytes), self.tr("raw, {rate:.0f} kbit/s").format(rate=raw.kbit_s))
        self.size.setToolTip(self._size_tip())
        self.def_.show_value("0")
        for figure in (self.mean, self.worst):
            figure.show_value(millimetres(0.0))

    def compare(self, other: Figures) -> None:
        """Say how each figure compares with that of the `other` side, which may be the original: only size then."""
        for figure, ours, theirs in zip(self._all(), self.numbers, other.numbers, strict=True):
            figure.change.setText(against(ours, theirs))

    def show_report(self, report: LabReport, *, stale: bool = False) -> None:
        """Show what was measured; `stale` where the settings have gone on since."""
        error = report.error
        self._settle()
        if not stale:
            self.show_size(report.size)
        self.numbers = (self.numbers[0], error.def_, error.mean_mm, error.max_mm)
        self.def_.show_value(significant(error.def_), self.tr("ASF units of 56.4 mm"))
        self.mean.show_value(
            millimetres(error.mean_mm), self.tr("99 % within {p99}").format(p99=millimetres(error.p99_mm))
        )
        self.worst.show_value(millimetres(error.max_mm))
        self._worst_frame = error.worst_frame
        self._name_worst(self.tr("{joint}, frame {frame}").format(joint=error.worst_joint, frame=error.worst_frame))
        if stale:
            self.wait()

    def wait(self) -> None:
        """Dim the errors until the next report."""
        for figure in self._measured():
            figure.set_stale(True)

    def show_nothing(self) -> None:
        """Show that there is no measurement: none was made or it failed."""
        self._settle()
        if self.size.value.isEnabled():
            self.numbers = (self.numbers[0], None, None, None)
        else:  # the size belongs to settings that are no longer shown
            self.numbers = (None, None, None, None)
            self.size.show_value(_NONE)
            self.size.set_stale(False)
        for figure in self._measured():
            figure.show_value(_NONE)
        self._worst_frame = None
        self._name_worst("")

    @property
    def stale(self) -> bool:
        """Whether the errors shown belong to older settings."""
        return not self.def_.value.isEnabled()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._name_worst(self.go.property("whole") or "")

    def _all(self) -> tuple[Figure, ...]:
        return self.size, *self._measured()

    def _measured(self) -> tuple[Figure, ...]:
        return self.def_, self.mean, self.worst

    def _settle(self) -> None:
        for figure in self._measured():
            figure.set_stale(False)

    def _name_worst(self, words: str) -> None:
        self.go.setProperty("whole", words)
        self.go.setVisible(bool(words))
        room = self.worst.width() - 8
        self.go.setText(self.go.fontMetrics().elidedText(words, Qt.TextElideMode.ElideMiddle, max(room, 40)))
        tip = self.tr("Go to the frame of the worst error")
        self.go.setToolTip(f"{words}\n{tip}")
        self.go.setAccessibleName(f"{tip}: {words}")

    def _dress(self) -> None:
        self.go.setProperty("link", True)
        self.go.setCursor(Qt.CursorShape.PointingHandCursor)
        self.go.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.go.clicked.connect(self._go)
        self.worst.remark.hide()
        self.worst.layout().addWidget(self.go, 0, Qt.AlignmentFlag.AlignLeft)

    def _go(self) -> None:
        if self._worst_frame is not None:
            self.frame_wanted.emit(self._worst_frame)

    def _lay_out(self) -> None:
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        for figure in self._all():
            layout.addWidget(figure)
        layout.addStretch(1)

    def _size_tip(self, size: SizeFigures | None = None) -> str:
        tip = self.tr(
            "What is sent of the motion; 1 KB = 1024 bytes. Per cent of the whole motion matrix as float32; kbit/s "
            "(1000 bits) when played at the clip's frame rate."
        )
        if size is None:
            return tip
        parts = self.tr("Payload {payload}, whole file {file}, raw matrix {raw}.").format(
            payload=exact_bytes(size.payload.bytes), file=exact_bytes(size.file_bytes), raw=exact_bytes(size.raw_bytes)
        )
        return f"<p>{tip}</p><p>{parts}</p>"

    def _def_tip(self) -> str:
        return self.tr(
            "<p><b>Displacement error per frame</b>, the paper's measure: the distances of all joints from their "
            "originals, stacked into one vector; its length, averaged over the frames.</p>"
            "<p>The unit is the ASF length unit, 56.444 mm. It grows with the number of joints, and jitter does not "
            "show in it: read the millimetres beside it.</p>"
        )

    def _mean_tip(self) -> str:
        return self.tr("The distance of a joint from its original, averaged over all joints and frames.")

    def _worst_tip(self) -> str:
        return self.tr("The largest distance of any joint from its original in any frame.")
