"""What playing the two sides takes of a device: file, memory, work a frame, and the share of the device's own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QComboBox, QGridLayout, QHBoxLayout, QLabel, QSizePolicy, QWidget

from qmd_studio.project.state import Side
from qmd_studio.tuning.budget import Device, devices
from qmd_studio.ui.quantity import kilobytes, percent, tabular

if TYPE_CHECKING:
    from qmd_studio.tuning.lab_report import LabReport

_NONE = "–"
DEFAULT_DEVICE = "cortex-m4"


class BudgetPanel(QWidget):
    """A chooser of the device and a column for each side; `device_chosen` carries the device's name."""

    device_chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._reports: dict[Side, tuple[LabReport | None, bool]] = dict.fromkeys(Side, (None, False))
        self.chooser = QComboBox(self)
        self.cells: dict[tuple[str, Side], QLabel] = {}
        self._rows = self._named_rows()
        self._dress()
        self._lay_out()
        self.show_device(DEFAULT_DEVICE)

    @property
    def device(self) -> Device:
        """The device that is chosen."""
        return devices()[self.chooser.currentData()]

    def show_device(self, name: str) -> None:
        """Show `name` as chosen, without emitting anything; a name that no device has changes nothing."""
        place = self.chooser.findData(name)
        if place >= 0:
            with QSignalBlocker(self.chooser):
                self.chooser.setCurrentIndex(place)
            self._fill()

    def show_reports(self, reports: Mapping[Side, tuple[LabReport | None, bool]]) -> None:
        """Show what each side takes: its report, None where there is none, and whether that is of other settings."""
        if self._reports != reports:
            self._reports = dict(reports)
            self._fill()

    def _fill(self) -> None:
        for side, (report, stale) in self._reports.items():
            words = dict.fromkeys(self._rows, _NONE) if report is None else self._words(report)
            for row, text in words.items():
                self.cells[row, side].setText(text)
                self.cells[row, side].setEnabled(not stale)
                name = self.tr("{what} of side {side}: {value}")
                self.cells[row, side].setAccessibleName(
                    name.format(what=self._rows[row][0], side=side.upper(), value=text)
                )

    def _words(self, report: LabReport) -> dict[str, str]:
        budget, device = report.budget, self.device
        ram = budget.ram_on(device)
        return {
            "file": kilobytes(budget.file_bytes),
            "ram": f"{kilobytes(ram)}, {percent(ram / device.ram_bytes)}",
            "work": f"{budget.instructions_per_frame:,.0f}",
            "load": percent(budget.load_on(device, report.fps)),
        }

    def _choose(self) -> None:
        self._fill()
        self.device_chosen.emit(self.chooser.currentData())

    def _named_rows(self) -> dict[str, tuple[str, str]]:
        return {
            "file": (self.tr("Whole file"), self.tr("Header, payload and skeleton: what the device stores")),
            "ram": (
                self.tr("Memory"),
                self.tr("What the decoder in C needs, and its share of the device's; a device that reads files where "
                        "they lie does not load them"),
            ),
            "work": (
                self.tr("Instructions a frame"),
                self.tr("Of the decoder in C, the mean over the clip, from a model that was counted with callgrind"),
            ),
            "load": (
                self.tr("Processor"),
                self.tr("Share of the device's processor at the file's frame rate; estimated from its clock"),
            ),
        }  # fmt: skip

    def _dress(self) -> None:
        for name, device in devices().items():
            self.chooser.addItem(device.title, name)
        self.chooser.setAccessibleName(self.tr("Device"))
        self.chooser.setToolTip(self.tr("The kind of machine that is to play the file"))
        self.chooser.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.chooser.setMinimumContentsLength(12)
        self.chooser.currentIndexChanged.connect(self._choose)

    def _lay_out(self) -> None:
        grid, head = QGridLayout(self), QHBoxLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(12)
        grid.setVerticalSpacing(4)
        title = QLabel(self.tr("On a device"), self)
        title.setBuddy(self.chooser)
        head.setSpacing(12)
        head.addWidget(title)
        head.addWidget(self.chooser, 1)
        grid.addLayout(head, 0, 0, 1, 3)
        grid.setRowMinimumHeight(0, 32)
        for place, side in enumerate(Side):
            label = QLabel(side.upper(), self)
            label.setProperty("muted", True)
            grid.addWidget(label, 1, place + 1, Qt.AlignmentFlag.AlignRight)
        for number, (row, (name, tip)) in enumerate(self._rows.items()):
            label = QLabel(name, self)
            label.setProperty("muted", True)
            label.setToolTip(tip)
            grid.addWidget(label, number + 2, 0)
            for place, side in enumerate(Side):
                cell = QLabel(_NONE, self)
                cell.setFont(tabular(self.font()))
                cell.setToolTip(tip)
                self.cells[row, side] = cell
                grid.addWidget(cell, number + 2, place + 1, Qt.AlignmentFlag.AlignRight)
        grid.setColumnStretch(0, 1)
        widest = QFontMetrics(tabular(self.font())).horizontalAdvance(kilobytes(90))
        for column in (1, 2):  # nothing moves when a side becomes known
            grid.setColumnMinimumWidth(column, widest)
