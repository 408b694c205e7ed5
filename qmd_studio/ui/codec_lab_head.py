"""The head of the codec lab: which side the knobs belong to, and what can be done with a whole side."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QPushButton, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from qmd_studio.project.state import Side
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.ui.choice_bar import Choice, ChoiceBar
from qmd_studio.ui.preset_menu import PresetButton
from qmd_studio.ui.side_words import button_words, settings_words, side_words


class SideHead(QWidget):
    """Two buttons that say what A and B are and choose whose knobs are shown; below, verbs for that side.

    `side_chosen` carries the side, `source_chosen` whether side A is to be encoded, `copy_wanted` the side that is to
    get the other's settings.
    """

    side_chosen = Signal(object)
    source_chosen = Signal(bool)
    copy_wanted = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._side = Side.B
        self._group = QButtonGroup(self)
        self.buttons = {side: self._side_button(side) for side in Side}
        self.source = ChoiceBar(self.tr("What side A is"), self._sources(), self)
        self.copy = QPushButton(self)
        self.copy.clicked.connect(lambda: self.copy_wanted.emit(self._side.other))
        self.source.chosen.connect(lambda key: self.source_chosen.emit(key == "encoded"))
        self.presets = PresetButton(self)
        self._lay_out()

    @property
    def side(self) -> Side:
        """The side whose knobs are shown."""
        return self._side

    def show_sides(self, side: Side, a: EncodeSettings | None, b: EncodeSettings | None) -> None:
        """Show what the sides are, and that the knobs are those of `side`."""
        self._side = side
        for each, settings in ((Side.A, a), (Side.B, b)):
            button = self.buttons[each]
            button.setText(f"{each.upper()}\n{button_words(settings)}")
            button.setAccessibleDescription(side_words(each, settings))
            button.setToolTip(f"<p><b>{each.upper()}  {settings_words(settings)}</b></p><p>{self._tip(each)}</p>")
        self.buttons[side].setChecked(True)
        self.presets.show_settings(a if side is Side.A else b)
        self.source.setVisible(side is Side.A)
        self.source.show_choice("original" if a is None else "encoded")
        self.copy.setText(self.tr("Copy to {side}").format(side=side.other.upper()))
        self.copy.setEnabled((a if side is Side.A else b) is not None)
        tip = self.tr("Give side {to} the settings of side {here}; undo takes it back (Ctrl+Z)")
        self.copy.setToolTip(tip.format(to=side.other.upper(), here=side.upper()))
        self.copy.setAccessibleName(self.copy.text())

    def _tip(self, side: Side) -> str:
        if side is Side.A:
            return self.tr("Show the knobs of side A, what B is compared with: the original, or another encoding")
        return self.tr("Show the knobs of side B, which Export QMD writes")

    def _side_button(self, side: Side) -> QToolButton:
        button = QToolButton(self, checkable=True, checked=side is self._side)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.setProperty("choice", True)
        button.setAccessibleName(self.tr("Side {side}").format(side=side.upper()))
        button.clicked.connect(lambda: self.side_chosen.emit(side))
        self._group.addButton(button)
        return button

    def _sources(self) -> tuple[Choice, ...]:
        return (
            Choice("original", self.tr("Original"), self.tr("Side A is the motion as it is")),
            Choice("encoded", self.tr("Encoded"), self.tr("Side A is an encoding with settings of its own")),
        )

    def _lay_out(self) -> None:
        sides, verbs = QHBoxLayout(), QHBoxLayout()
        sides.setSpacing(4)
        verbs.setSpacing(4)
        for side in Side:
            sides.addWidget(self.buttons[side], 1)
        verbs.addWidget(self.presets, 1)
        verbs.addWidget(self.copy, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addLayout(sides)
        layout.addLayout(verbs)
        layout.addWidget(self.source)
