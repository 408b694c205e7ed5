"""The outliner: the clips that are open and the joints of each, the selection shared with the viewport."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QIcon, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem, QWidget

from qmd_studio.errors import EditError
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import ActivateClip, RenameClip
from qmd_studio.project.document import Document
from qmd_studio.project.state import DocumentState
from qmd_studio.ui.icons import icon, tinted_icon

_KEY = Qt.ItemDataRole.UserRole
_JOINT = Qt.ItemDataRole.UserRole + 1
_WARNING = "#c98500"
"""An amber that stands out from the light ground and the dark one."""


class Outliner(QTreeWidget):
    """Clips as top rows, their joints below. Picking a row shows its clip and selects its joint.

    `joint_selected` has the joint's number on the shown clip, -1 for none; `warnings_wanted` the key of a clip whose
    warnings were clicked; `refused` an edit that could not be done.
    """

    joint_selected = Signal(int)
    warnings_wanted = Signal(int)
    refused = Signal(EditError)

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._shown: tuple[object, ...] = ()
        self.setAccessibleName(self.tr("Outliner"))
        self.setToolTip(self.tr("Open clips and their joints; F2 renames a clip"))
        self.setColumnCount(2)
        self.setHeaderHidden(True)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)  # deep joints: it scrolls
        self.header().setStretchLastSection(True)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setIndentation(12)
        self.setUniformRowHeights(True)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.currentItemChanged.connect(self._pick)
        self.itemChanged.connect(self._rename)
        self.itemClicked.connect(self._click)
        self.itemDoubleClicked.connect(self._double_click)
        document.changed.connect(self._follow)
        self._follow(document.state)

    def select_joint(self, joint: int) -> None:
        """Select a joint of the shown clip, or the clip itself for -1."""
        item = self._item_of(self._document.state.active, joint)
        if item is not None and item is not self.currentItem():
            with QSignalBlocker(self):
                self.setCurrentItem(item)
            self.scrollToItem(item)

    def rename_active(self) -> None:
        """Let the user type another name for the shown clip."""
        item = self._item_of(self._document.state.active, -1)
        if item is not None:
            self.editItem(item, 0)

    def refresh_icons(self) -> None:
        """Draw the rows again in the colours of the present theme."""
        self._shown = ()
        self._follow(self._document.state)

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        if self.topLevelItemCount():
            return
        painter = QPainter(self.viewport())
        painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
        flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
        text = self.tr("Drop a BVH, AMC, BAP, X3D or QMD file on the window, or press Ctrl+O.")
        painter.drawText(self.viewport().rect().adjusted(24, 24, -24, -24), int(flags), text)
        painter.end()

    def _follow(self, state: DocumentState) -> None:
        shown = (state.clips, state.active)
        if shown == self._shown:
            return
        joint = self._current_joint()
        skeletons_stay = self._shown and self._skeletons(self._shown[0]) == self._skeletons(state.clips)
        self._shown = shown
        with QSignalBlocker(self):
            if not skeletons_stay:
                self._rebuild(state)
            self._label(state)
        self.select_joint(joint)

    def _skeletons(self, clips: tuple[Clip, ...]) -> list[tuple[int, tuple[object, ...]]]:
        return [(clip.key, clip.motion.skeleton.joints) for clip in clips]

    def _rebuild(self, state: DocumentState) -> None:
        self.clear()
        for clip in state.clips:
            row = QTreeWidgetItem(self)
            row.setData(0, _KEY, clip.key)
            row.setData(0, _JOINT, -1)
            row.setFlags(row.flags() | Qt.ItemFlag.ItemIsEditable)
            self._add_joints(row, clip)

    def _add_joints(self, row: QTreeWidgetItem, clip: Clip) -> None:
        items: list[QTreeWidgetItem] = []
        for index, joint in enumerate(clip.motion.skeleton.joints):
            item = QTreeWidgetItem(row if joint.parent < 0 else items[joint.parent], [joint.name])
            item.setData(0, _KEY, clip.key)
            item.setData(0, _JOINT, index)
            items.append(item)
        for item in items[:4]:
            item.setExpanded(True)

    def _label(self, state: DocumentState) -> None:
        for place, clip in enumerate(state.clips):
            row = self.topLevelItem(place)
            row.setText(0, clip.name)
            row.setIcon(0, icon("clip"))
            row.setToolTip(0, str(clip.path or clip.name))
            font = row.font(0)
            font.setBold(clip.key == state.active)
            row.setFont(0, font)
            row.setExpanded(clip.key == state.active)
            count = len(clip.warnings)
            row.setText(1, _count_text(self, count))
            row.setIcon(1, tinted_icon("warning", _WARNING) if count else QIcon())
            row.setToolTip(1, self.tr("Click to read them") if count else "")

    def _current_joint(self) -> int:
        item = self.currentItem()
        if item is None or item.data(0, _KEY) != self._document.state.active:
            return -1
        return int(item.data(0, _JOINT))

    def _item_of(self, key: int | None, joint: int) -> QTreeWidgetItem | None:
        for place in range(self.topLevelItemCount()):
            row = self.topLevelItem(place)
            if row.data(0, _KEY) == key:
                return row if joint < 0 else _find(row, joint)
        return None

    def _pick(self, item: QTreeWidgetItem | None, _previous: object = None) -> None:
        if item is None:
            return
        key, joint = item.data(0, _KEY), item.data(0, _JOINT)
        if key != self._document.state.active:
            self._document.execute(ActivateClip(key))
        self.joint_selected.emit(joint)

    def _click(self, item: QTreeWidgetItem, column: int) -> None:
        if column == 1 and item.text(1):
            self.warnings_wanted.emit(item.data(0, _KEY))

    def _double_click(self, item: QTreeWidgetItem, column: int) -> None:
        if column == 0 and item.data(0, _JOINT) < 0:
            self.editItem(item, 0)

    def _rename(self, item: QTreeWidgetItem, column: int) -> None:
        if column != 0 or item.data(0, _JOINT) >= 0:
            return
        try:
            self._document.execute(RenameClip(item.data(0, _KEY), item.text(0)))
        except EditError as problem:
            self.refused.emit(problem)
            with QSignalBlocker(self):
                self._label(self._document.state)


def _count_text(widget: QWidget, count: int) -> str:
    if count == 0:
        return ""
    return widget.tr("1 warning") if count == 1 else widget.tr("{n} warnings").format(n=count)


def _find(item: QTreeWidgetItem, joint: int) -> QTreeWidgetItem | None:
    for place in range(item.childCount()):
        child = item.child(place)
        if child.data(0, _JOINT) == joint:
            return child
        if (found := _find(child, joint)) is not None:
            return found
    return None
