"""A bar that shows what the bytes of a QMD file are spent on."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QEvent, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QHelpEvent, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QSizePolicy, QToolTip, QVBoxLayout, QWidget

from qmd_studio.codecs.qmd.size import SizeBreakdown
from qmd_studio.tuning.compact_size import CompactBreakdown
from qmd_studio.tuning.size_figures import SizeFigures
from qmd_studio.ui.quantity import exact_bytes, kilobytes, tabular

_HEIGHT = 20
_GAP = 6.0
_SWATCH = 10


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the file: its name, what it is, its colour (after Okabe and Ito, told apart by all) and its bytes."""

    name: str
    tip: str
    colour: QColor
    n_bytes: int
    around: bool = False


class SizeBar(QWidget):
    """Draws the payload's parts in proportion, and apart from them what stands around the payload in the file."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._parts: tuple[Part, ...] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        return QSize(200, _HEIGHT)

    def minimumSizeHint(self) -> QSize:
        return QSize(80, _HEIGHT)

    def show_parts(self, parts: tuple[Part, ...]) -> None:
        """Draw these parts, left to right."""
        self._parts = parts
        words = ", ".join(f"{part.name} {exact_bytes(part.n_bytes)}" for part in parts)
        self.setAccessibleName(self.tr("Bytes of the file: {parts}").format(parts=words))
        self.update()

    def rectangles(self) -> list[tuple[Part, QRectF]]:
        """Return each part that has bytes with the rectangle it fills."""
        total = sum(part.n_bytes for part in self._parts)
        if not total:
            return []
        scale = (self.width() - _GAP) / total
        left, result, was_around = 0.0, [], False
        for part in self._parts:
            if part.around and not was_around:
                left += _GAP
                was_around = True
            if part.n_bytes:
                result.append((part, QRectF(left, 0.0, part.n_bytes * scale, self.height())))
            left += part.n_bytes * scale
        return result

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        for part, area in self.rectangles():
            painter.fillRect(area, part.colour)
            if part.around:
                painter.fillRect(area, Qt.BrushStyle.BDiagPattern)
        ground = self.palette().color(QPalette.ColorRole.Window)
        for _, area in self.rectangles()[1:]:
            painter.fillRect(QRectF(area.left() - 0.5, 0.0, 1.0, area.height()), ground)
        painter.end()

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            for part, area in self.rectangles():
                if area.contains(event.pos()):
                    QToolTip.showText(event.globalPos(), _tip(part), self)
                    return True
            QToolTip.hideText()
            return True
        return super().event(event)


class SizeBreakdownView(QWidget):
    """The bar with its legend; `name` says whose bytes they are."""

    def __init__(self, parent: QWidget | None = None, *, name: str = "") -> None:
        super().__init__(parent)
        self._name = name
        self.bar = SizeBar(self)
        self.payload, self.file = QLabel(self), QLabel(self)
        for label in (self.payload, self.file):
            label.setFont(tabular(self.font()))
            label.setProperty("muted", True)
        self._legend = QGridLayout()
        self._legend.setContentsMargins(0, 0, 0, 0)
        self._legend.setHorizontalSpacing(6)
        self._legend.setVerticalSpacing(2)
        self._entries: list[tuple[QLabel, QLabel, QLabel]] = []
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(6)
        totals = QHBoxLayout()
        totals.addWidget(self.payload, 1)
        totals.addWidget(self.file)
        layout.addLayout(totals)
        layout.addWidget(self.bar)
        layout.addLayout(self._legend)

    def show_size(self, size: SizeFigures) -> None:
        """Show what the bytes of this encoding are spent on."""
        payload = self.tr("Payload {size}").format(size=kilobytes(size.payload.bytes))
        self.payload.setText(f"{self._name}  {payload}".strip())
        self.file.setText(self.tr("Whole file {size}").format(size=kilobytes(size.file_bytes)))
        parts = self._parts(size)
        self.bar.show_parts(parts)
        while len(self._entries) < len(parts):
            self._add_entry()
        for entry in self._entries[len(parts) :]:
            for label in entry:
                label.hide()
        for entry, part in zip(self._entries, parts, strict=False):
            swatch, name, amount = entry
            swatch.setStyleSheet(f"background: {part.colour.name()}; border-radius: 2px;")
            name.setText(part.name)
            amount.setText(kilobytes(part.n_bytes) if part.n_bytes >= 1024 else f"{part.n_bytes} B")
            for label in entry:
                label.setToolTip(_tip(part))
                label.show()

    def _add_entry(self) -> None:
        labels = (QLabel(self), QLabel(self), QLabel(self))
        labels[0].setFixedSize(_SWATCH, _SWATCH)
        labels[2].setFont(tabular(self.font()))
        labels[2].setProperty("muted", True)
        row, side = _PLACES[len(self._entries)]
        for place, label in enumerate(labels):
            self._legend.addWidget(label, row, side * 4 + place)
        self._legend.setColumnStretch(3, 1)
        self._legend.setColumnMinimumWidth(3, 8)
        self._entries.append(labels)

    def _parts(self, size: SizeFigures) -> tuple[Part, ...]:
        payload = size.payload
        if isinstance(payload, CompactBreakdown):
            return (*self._compact_parts(payload), *self._parts_around(size))
        return (*self._paper_parts(payload, size.n_segments), *self._parts_around(size))

    def _compact_parts(self, payload: CompactBreakdown) -> tuple[Part, ...]:
        segments = self._segments(payload.n_segments)
        return (
            Part(
                self.tr("Counts"),
                self.tr("Frames, columns, segment and block, and the lengths of all streams"),
                _GREY,
                payload.count_bytes,
            ),
            Part(
                self.tr("Steps and pose"),
                self.tr("The step of each column and the first pose, entropy coded"),
                _PINK,
                payload.prelude_bytes,
            ),
            Part(
                self.tr("Key poses and waves"),
                self.tr("Key poses, and sums of sines between them, range-coded in one stream a segment: ") + segments,
                _GREEN,
                payload.stream_bytes,
            ),
        )

    def _segments(self, count: int) -> str:
        return self.tr("one segment") if count == 1 else self.tr("{n:,} segments").format(n=count)

    def _paper_parts(self, payload: SizeBreakdown, n_segments: int) -> tuple[Part, ...]:
        segments = self._segments(n_segments)
        return (
            Part(
                self.tr("Headers"),
                self.tr("n_d, m, FDF and b: 13 bytes a segment, ") + segments,
                _GREY,
                payload.header_bytes,
            ),
            Part(
                self.tr("Initial pose"),
                self.tr("The first pose, one float32 a column, once"),
                _PINK,
                payload.pose_bytes,
            ),
            Part(self.tr("Tables"), self.tr("2^b float32 values a segment, ") + segments, _ORANGE, payload.table_bytes),
            Part(self.tr("Exact columns"), self.tr("The first FDF columns as float32"), _BLUE, payload.exact_bytes),
            Part(
                self.tr("Indices"), self.tr("All other columns: one or two bytes a value"), _GREEN, payload.index_bytes
            ),
        )

    def _parts_around(self, size: SizeFigures) -> tuple[Part, ...]:
        return (
            Part(
                self.tr("File frame"),
                self.tr("Around the payload: magic, version, frame rate, checksum, encoder"),
                _DARK,
                size.frame_bytes,
                around=True,
            ),
            Part(
                self.tr("Skeleton"),
                self.tr("After the payload: skeleton and column names; lets the file play anywhere"),
                _SKY,
                size.skeleton_bytes,
                around=True,
            ),
        )


def _tip(part: Part) -> str:
    return f"<b>{part.name}</b>: {exact_bytes(part.n_bytes)}<br>{part.tip}"


_PLACES = ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (3, 1))
"""Where each part stands in the legend: three down the left, then the rest; what is around the payload comes last."""

_GREY, _PINK, _ORANGE = QColor("#999999"), QColor("#cc79a7"), QColor("#e69f00")
_BLUE, _GREEN, _SKY, _DARK = QColor("#0072b2"), QColor("#009e73"), QColor("#56b4e9"), QColor("#7a7a7a")
