"""The joint map as a table that can be read, edited, saved and loaded: which joint moves which of the body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCompleter,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHeaderView,
    QLabel,
    QLineEdit,
    QPushButton,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from qmd_studio.errors import FormatError, QmdStudioError
from qmd_studio.motion.joint_map import JointMap, match_joints, read_joint_map, write_joint_map
from qmd_studio.motion.skeleton import Skeleton, depths
from qmd_studio.project.commands import WearBody
from qmd_studio.project.document import Document
from qmd_studio.storage import read_bytes, write_atomic
from qmd_studio.ui.notice import Notice

SOURCE, TARGETS = range(2)
_FILTER = "*.json"


class JointMapDialog(QDialog):
    """Edits the joint map of the clip `key`; OK applies it as one `WearBody` command."""

    def __init__(self, document: Document, key: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(self.tr("Joint map"))
        self._document, self._key = document, key
        clip = document.state.clip(key)
        assert clip.outfit.avatar is not None
        self._skeletons = clip.motion.skeleton, clip.outfit.avatar.skeleton
        self._automatic = match_joints(*self._skeletons)
        self.filter, self.table, self.notice = QLineEdit(self), QTableWidget(self), Notice(self)
        self.automatic = QPushButton(self.tr("Automatic"), self)
        self.save, self.load = QPushButton(self.tr("Save…"), self), QPushButton(self.tr("Load…"), self)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel, self
        )
        self._dress()
        self._lay_out()
        self._connect()
        self.show_map(clip.outfit.joint_map or self._automatic)
        self.resize(560, 600)

    @property
    def joint_map(self) -> JointMap:
        """The map as the table has it; raises `FormatError` for a name that the body does not have."""
        pairs = []
        for row in range(self.table.rowCount()):
            source = self.table.item(row, SOURCE).data(Qt.ItemDataRole.UserRole)
            names = [name.strip() for name in self.table.item(row, TARGETS).text().split(",")]
            targets = tuple(name for name in names if name)
            if targets:
                pairs.append((source, targets))
        return JointMap(tuple(pairs)).checked(*self._skeletons)

    def show_map(self, joint_map: JointMap) -> None:
        """Fill the table with `joint_map`."""
        targets = dict(joint_map.pairs)
        for row, joint in enumerate(self._skeletons[0].joints):
            self.table.item(row, TARGETS).setText(", ".join(targets.get(joint.name, ())))

    def accept(self) -> None:
        clip = self._document.state.clip(self._key)
        try:
            joint_map = self.joint_map
            chosen = None if joint_map == self._automatic else joint_map
            if chosen != clip.outfit.joint_map:
                self._document.execute(WearBody(self._key, replace(clip.outfit, joint_map=chosen)))
        except QmdStudioError as problem:
            self.notice.say_error(self.tr("The map was not changed"), problem)
            return
        super().accept()

    def save_to(self, path: Path) -> None:
        """Write the map to a file."""
        try:
            write_atomic(path, write_joint_map(self.joint_map))
        except QmdStudioError as problem:
            self.notice.say_error(self.tr("The map was not saved"), problem)

    def load_from(self, path: Path) -> None:
        """Fill the table with the map of a file."""
        try:
            self.show_map(read_joint_map(read_bytes(path)).checked(*self._skeletons))
            self.notice.clear()
        except FormatError as problem:
            self.notice.say_error(self.tr("The map was not loaded"), problem.located(path))
        except QmdStudioError as problem:
            self.notice.say_error(self.tr("The map was not loaded"), problem)

    def _ask_save(self) -> None:
        name, _ = QFileDialog.getSaveFileName(self, self.tr("Save the joint map"), "joint-map.json", _FILTER)
        if name:
            self.save_to(Path(name) if Path(name).suffix else Path(name + ".json"))

    def _ask_load(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, self.tr("Load a joint map"), "", _FILTER)
        if name:
            self.load_from(Path(name))

    def _filter(self, text: str) -> None:
        wanted = text.strip().lower()
        for row in range(self.table.rowCount()):
            words = self.table.item(row, SOURCE).text() + " " + self.table.item(row, TARGETS).text()
            self.table.setRowHidden(row, wanted not in words.lower())

    def _connect(self) -> None:
        self.filter.textChanged.connect(self._filter)
        self.automatic.clicked.connect(lambda: self.show_map(self._automatic))
        self.save.clicked.connect(self._ask_save)
        self.load.clicked.connect(self._ask_load)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)

    def _dress(self) -> None:
        self.filter.setPlaceholderText(self.tr("Filter by name"))
        self.filter.setClearButtonEnabled(True)
        self.filter.setAccessibleName(self.tr("Filter"))
        self.filter.setToolTip(self.tr("Show only the rows that hold this text"))
        self.automatic.setToolTip(self.tr("Match the joints by their names and by the shape of both skeletons"))
        self.save.setToolTip(self.tr("Write this map to a file, for other motions of the same skeleton"))
        self.load.setToolTip(self.tr("Read a map that was saved"))
        self._fill_table(*self._skeletons)
        header = self.table.horizontalHeader()
        header.setSectionResizeMode(SOURCE, QHeaderView.ResizeMode.ResizeToContents)
        header.setStretchLastSection(True)
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)

    def _fill_table(self, source: Skeleton, target: Skeleton) -> None:
        table = self.table
        table.setAccessibleName(self.tr("Joints of the motion and of the body"))
        table.setRowCount(len(source.joints))
        table.setColumnCount(2)
        table.setHorizontalHeaderLabels([self.tr("Joint of the motion"), self.tr("Moves these of the body")])
        table.verticalHeader().hide()
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setEditTriggers(QAbstractItemView.EditTrigger.AllEditTriggers)
        table.setTabKeyNavigation(False)
        names = [joint.name for joint in target.joints]
        table.setItemDelegateForColumn(TARGETS, _NamesDelegate(names, table))
        for row, depth in enumerate(depths(tuple(joint.parent for joint in source.joints))):
            name = source.joints[row].name
            first, second = QTableWidgetItem("    " * (depth - 1) + name), QTableWidgetItem()
            first.setData(Qt.ItemDataRole.UserRole, name)
            first.setFlags(first.flags() & ~Qt.ItemFlag.ItemIsEditable)
            table.setItem(row, SOURCE, first)
            table.setItem(row, TARGETS, second)

    def _lay_out(self) -> None:
        words = self.tr(
            "Several joints of the body, with commas between them, share a turn if they follow one another, and each "
            "take it whole if they are side by side. Joints that nothing moves stay at rest."
        )
        intro = QLabel(words, self)
        intro.setWordWrap(True)
        intro.setProperty("muted", True)
        for button in (self.automatic, self.load, self.save):
            self.buttons.addButton(button, QDialogButtonBox.ButtonRole.ResetRole)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.setSpacing(8)
        for widget in (intro, self.filter, self.table, self.notice, self.buttons):
            layout.addWidget(widget)


class _NamesDelegate(QStyledItemDelegate):
    """Edits names of joints, completing the one that is being typed."""

    def __init__(self, names: Sequence[str], parent: QWidget) -> None:
        super().__init__(parent)
        self._names = list(names)

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: object) -> QLineEdit:
        editor = QLineEdit(parent)
        editor.setFrame(False)
        completer = _LastNameCompleter(self._names, editor)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        editor.setCompleter(completer)
        return editor


class _LastNameCompleter(QCompleter):
    """Completes what stands after the last comma."""

    def splitPath(self, path: str) -> list[str]:
        return [path.rpartition(",")[2].strip()]

    def pathFromIndex(self, index: object) -> str:
        editor = self.widget()
        head = editor.text().rpartition(",")[0] if isinstance(editor, QLineEdit) else ""
        name = super().pathFromIndex(index)
        return f"{head}, {name}" if head else name
