"""The paper's level of each column as a table that can be read and edited."""

from __future__ import annotations

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QSortFilterProxyModel, Qt, Signal
from PySide6.QtGui import QFont, QGuiApplication, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from qmd_studio.errors import QmdStudioError
from qmd_studio.motion.skeleton import MAX_LEVEL, Skeleton
from qmd_studio.project.commands import SetLevels
from qmd_studio.project.document import Document
from qmd_studio.tuning.levels import default_levels
from qmd_studio.ui.notice import Notice

NUMBER, COLUMN, JOINT, LEVEL, DEFAULT = range(5)


class LevelsModel(QAbstractTableModel):
    """A row a column of the motion: number, name, joint, level (to edit), the level it came with.

    `edited` is emitted when a level was changed here. The document is not touched.
    """

    edited = Signal()

    def __init__(self, skeleton: Skeleton, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._skeleton = skeleton
        self._levels, self._defaults = list(skeleton.levels), default_levels(skeleton)
        self._headers = (self.tr("#"), self.tr("Column"), self.tr("Joint"), self.tr("Level"), self.tr("Default"))

    @property
    def changes(self) -> tuple[tuple[str, int], ...]:
        """Name and new level of each column whose level differs from the document's."""
        columns = zip(self._skeleton.columns, self._levels, strict=True)
        return tuple((column.name, level) for column, level in columns if level != column.level)

    @property
    def at_default(self) -> bool:
        """Whether every level is the one it came with."""
        return tuple(self._levels) == self._defaults

    def reset(self) -> None:
        """Give every column the level it came with."""
        self._levels = list(self._defaults)
        self._tell(0, len(self._levels) - 1)

    def as_tsv(self) -> str:
        """Return the table as lines of tab-separated values under a line of names."""
        rows = [self._headers, *(tuple(str(v) for v in self._row(i)) for i in range(self.rowCount()))]
        return "\n".join("\t".join(row) for row in rows) + "\n"

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self._levels)

    def columnCount(self, parent: QModelIndex | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self._headers)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role == Qt.ItemDataRole.DisplayRole and orientation == Qt.Orientation.Horizontal:
            return self._headers[section]
        return None

    def data(self, index: QModelIndex, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            return self._row(index.row())[index.column()]
        if role == Qt.ItemDataRole.ToolTipRole:
            return str(self._row(index.row())[index.column()])
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() not in (COLUMN, JOINT):
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.FontRole and index.column() == LEVEL and self._is_edited(index.row()):
            font = QFont(QGuiApplication.font())
            font.setBold(True)
            return font
        return None

    def flags(self, index: QModelIndex) -> Qt.ItemFlag:
        flags = super().flags(index)
        return flags | Qt.ItemFlag.ItemIsEditable if index.column() == LEVEL else flags

    def setData(self, index: QModelIndex, value: object, role: int = Qt.ItemDataRole.EditRole) -> bool:
        level = int(value)
        if role != Qt.ItemDataRole.EditRole or index.column() != LEVEL or not 1 <= level <= MAX_LEVEL:
            return False
        self._levels[index.row()] = level
        self._tell(index.row(), index.row())
        return True

    def _row(self, row: int) -> tuple[int, str, str, int, int]:
        column = self._skeleton.columns[row]
        joint = self._skeleton.joints[column.joint].name
        return row, column.name, joint, self._levels[row], self._defaults[row]

    def _is_edited(self, row: int) -> bool:
        return self._levels[row] != self._defaults[row]

    def _tell(self, first: int, last: int) -> None:
        self.dataChanged.emit(self.index(first, LEVEL), self.index(last, LEVEL))
        self.edited.emit()


class LevelDelegate(QStyledItemDelegate):
    """Edits a level with a spin box from 1 to 6."""

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: QModelIndex) -> QSpinBox:
        editor = QSpinBox(parent, minimum=1, maximum=MAX_LEVEL, frame=False)
        editor.setAccessibleName(self.tr("Level"))
        return editor


class LevelsDialog(QDialog):
    """Edits the levels of the clip `key`; OK applies them as one `SetLevels` command."""

    def __init__(self, document: Document, key: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(self.tr("Column levels"))
        self._document, self._key = document, key
        clip = document.state.clip(key)
        self.model = LevelsModel(clip.motion.skeleton, self)
        self.shown = QSortFilterProxyModel(self)
        self.shown.setSourceModel(self.model)
        self.shown.setFilterCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        self.shown.setFilterKeyColumn(-1)
        self.filter, self.table, self.notice = QLineEdit(self), QTableView(self), Notice(self)
        self.reset, self.copy = QPushButton(self.tr("Reset to default"), self), QPushButton(self.tr("Copy"), self)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel, self
        )
        self._dress()
        self._lay_out()
        self._connect()
        self._update_buttons()
        self.resize(460, 560)

    def accept(self) -> None:
        changes = self.model.changes
        if changes:
            try:
                self._document.execute(SetLevels(self._key, changes))
            except QmdStudioError as problem:
                self.notice.say_error(self.tr("The levels were not changed"), problem)
                return
        super().accept()

    def copy_table(self) -> None:
        """Put the whole table on the clipboard as tab-separated values."""
        QGuiApplication.clipboard().setText(self.model.as_tsv())

    def _filter(self, text: str) -> None:
        self.shown.setFilterFixedString(text.strip())

    def _update_buttons(self) -> None:
        self.reset.setEnabled(not self.model.at_default)
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(bool(self.model.changes))

    def _connect(self) -> None:
        self.filter.textChanged.connect(self._filter)
        self.reset.clicked.connect(self.model.reset)
        self.copy.clicked.connect(self.copy_table)
        self.model.edited.connect(self._update_buttons)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        QShortcut(QKeySequence.StandardKey.Copy, self.table, self.copy_table)

    def _dress(self) -> None:
        self.filter.setPlaceholderText(self.tr("Filter by name, joint or level"))
        self.filter.setClearButtonEnabled(True)
        self.filter.setAccessibleName(self.tr("Filter"))
        self.filter.setToolTip(self.tr("Show only the rows that hold this text"))
        self.reset.setToolTip(self.tr("Give every column the level it came with"))
        self.copy.setToolTip(self.tr("Copy the whole table as tab-separated values"))
        self.table.setAccessibleName(self.tr("Levels of the columns"))
        self.table.setModel(self.shown)
        self.table.setItemDelegateForColumn(LEVEL, LevelDelegate(self.table))
        self.table.setAlternatingRowColors(True)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(NUMBER, Qt.SortOrder.AscendingOrder)
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.AllEditTriggers)
        self.table.setTabKeyNavigation(False)
        self.table.verticalHeader().hide()
        header = self.table.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(COLUMN, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(JOINT, QHeaderView.ResizeMode.Stretch)

    def _lay_out(self) -> None:
        words = self.tr(
            "A bucket of the paper's table stands for many differences. Its value goes by the columns of the lowest "
            "level in it: 1 moves the whole body, 6 a finger. The closed loop does without."
        )
        intro = QLabel(words, self)
        intro.setWordWrap(True)
        intro.setProperty("muted", True)
        role = QDialogButtonBox.ButtonRole.ResetRole
        self.buttons.addButton(self.reset, role)
        self.buttons.addButton(self.copy, role)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(12)
        for widget in (intro, self.filter, self.table, self.notice, self.buttons):
            layout.addWidget(widget)
