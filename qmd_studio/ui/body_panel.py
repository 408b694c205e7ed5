"""What the clip is shown on: its body, the pose by which the two are aligned, and the joint map."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QFormLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from qmd_studio.avatar.fit import Fit
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Alignment, Clip, Outfit
from qmd_studio.project.commands import WearBody
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import DocumentState
from qmd_studio.ui.stage import standing_of
from qmd_studio.ui.wardrobe import Wardrobe

_FROM_FILE = "from file"


class BodyPanel(QWidget):
    """Shows and sets what the active clip wears, by commands. `refused` tells of what the document did not take.

    `file_wanted`, `map_wanted` and `bake_wanted` say that a body is to be chosen from a file, that the joint map is to
    be edited, and that the motion is to be made the body's own.
    """

    refused = Signal(QmdStudioError)
    file_wanted = Signal()
    map_wanted = Signal()
    bake_wanted = Signal()

    def __init__(
        self, document: Document, playhead: Playhead, wardrobe: Wardrobe, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._document, self._playhead, self._wardrobe = document, playhead, wardrobe
        self._shown: Clip | None = None
        self.body, self.alignment = QComboBox(self), QComboBox(self)
        self.map = QPushButton(self.tr("Joint map…"), self)
        self.bake = QPushButton(self.tr("Bake"), self)
        self._words = QLabel(self)
        self._dress()
        self._lay_out()
        self.body.activated.connect(self._choose_body)
        self.alignment.activated.connect(self._choose_alignment)
        self.map.clicked.connect(self.map_wanted)
        self.bake.clicked.connect(self.bake_wanted)
        wardrobe.came.connect(self.wear)
        wardrobe.failed.connect(self._fail)
        document.changed.connect(self._follow)
        self._follow(document.state)

    def wear(self, body: Body | None) -> None:
        """Show the active clip on `body`, or on its own bones; a map and an alignment made for another one go."""
        self._execute(Outfit(body))

    def refresh(self) -> None:
        """Say again what there is to choose: bodies have come."""
        self._shown = None
        self._follow(self._document.state)

    def _follow(self, state: DocumentState) -> None:
        clip = state.active_clip
        self.setEnabled(clip is not None)
        if clip is self._shown and clip is not None:
            return
        self._shown = clip
        with QSignalBlocker(self.body), QSignalBlocker(self.alignment):
            self._fill(clip)
        avatar = clip.outfit.avatar if clip is not None else None
        for field in (self.alignment, self.map, self.bake):
            field.setEnabled(avatar is not None and clip is not None and avatar is not clip.body)
        self._words.setText(_words(self, clip))
        self._words.setVisible(bool(self._words.text()))

    def _fill(self, clip: Clip | None) -> None:
        self.body.clear()
        if clip is None:
            self.alignment.setCurrentIndex(0)
            return
        self.body.addItem(self.tr("Made from the bones"), None)
        if clip.body is not None:
            self.body.addItem(self.tr("{name} (the file's own)").format(name=clip.body.name), clip.body)
        worn = clip.outfit.avatar
        for name in self._wardrobe.names:
            self.body.addItem(name.capitalize(), worn if worn is not None and worn.name == name else name)
        known = [*self._wardrobe.loaded, *(c.body for c in self._document.state.clips if c.body is not None)]
        if worn is not None:
            known.append(worn)
        for body in known:
            if self._place_of(body) < 0 and body.name not in self._wardrobe.names:
                self.body.addItem(body.name, body)
        self.body.insertSeparator(self.body.count())
        self.body.addItem(self.tr("From a file…"), _FROM_FILE)
        self.body.setCurrentIndex(max(self._place_of(worn), 0))
        self.alignment.setCurrentIndex(max(self.alignment.findData(clip.outfit.alignment.value), 0))
        text = self.tr("Frame {n}").format(n=clip.outfit.frame)
        here = self.alignment.findData(Alignment.FRAME.value)
        framed = clip.outfit.alignment is Alignment.FRAME
        self.alignment.setItemText(here, text if framed else self.tr("Shown frame"))

    def _place_of(self, body: Body | None) -> int:
        return next((k for k in range(self.body.count()) if self.body.itemData(k) is body), -1)

    def _choose_body(self, place: int) -> None:
        chosen = self.body.itemData(place)
        if isinstance(chosen, str):
            self._shown = None
            self._follow(self._document.state)  # the list goes back to what is worn until the body is there
            if chosen == _FROM_FILE:
                self.file_wanted.emit()
            else:
                self._wardrobe.fetch(chosen)
        else:
            self.wear(chosen)

    def _choose_alignment(self, place: int) -> None:
        clip = self._document.state.active_clip
        if clip is not None:
            alignment = Alignment(self.alignment.itemData(place))
            self._execute(replace(clip.outfit, alignment=alignment, frame=self._playhead.index))

    def _execute(self, outfit: Outfit) -> None:
        key = self._document.state.active
        if key is None:
            return
        try:
            self._document.execute(WearBody(key, outfit))
        except QmdStudioError as problem:
            self._fail(problem)

    def _fail(self, problem: QmdStudioError) -> None:
        self.refused.emit(problem)
        self.refresh()

    def _dress(self) -> None:
        for value, text in (
            (Alignment.AUTO, self.tr("Automatic")),
            (Alignment.REST, self.tr("Rest pose")),
            (Alignment.FRAME, self.tr("Shown frame")),
            (Alignment.ZERO, self.tr("Zero pose")),
        ):
            self.alignment.addItem(text, value.value)
        for field, name, tip in (
            (self.body, self.tr("Body"), self.tr("The body that the clip is shown on; its motion stays as it is")),
            (
                self.alignment,
                self.tr("Aligned by"),
                self.tr(
                    "The pose of the motion in which it stands as the body does at rest: the file's rest pose (or a "
                    "T-pose put before the motion), the frame shown now, or none"
                ),
            ),
            (self.map, self.tr("Joint map"), self.tr("See and edit which joint of the motion moves which of the body")),
            (
                self.bake,
                self.tr("Bake"),
                self.tr("Make a new clip of the motion as the body makes it, in body animation parameters"),
            ),
        ):
            field.setAccessibleName(name)
            field.setToolTip(tip)
        for field in (self.body, self.alignment):
            field.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            field.setMinimumContentsLength(8)
        self._words.setWordWrap(True)
        self._words.setProperty("muted", True)

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.setHorizontalSpacing(12)
        form.setVerticalSpacing(8)
        form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for text, field in ((self.tr("Body"), self.body), (self.tr("Aligned by"), self.alignment)):
            label = QLabel(text)
            label.setProperty("muted", True)
            label.setBuddy(field)
            form.addRow(label, field)
        row = QHBoxLayout()
        row.setSpacing(8)
        row.addWidget(self.map, 1)
        row.addWidget(self.bake, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 12, 12, 12)
        column.setSpacing(8)
        column.addLayout(form)
        column.addLayout(row)
        column.addWidget(self._words)
        column.addStretch(1)


def ask_body(parent: QWidget, folder: Path) -> Path | None:
    """Let the user choose a file with a body."""
    from PySide6.QtWidgets import QFileDialog

    from qmd_studio.registry import FORMATS

    suffixes = [s for f in FORMATS if f.write_figure for s in f.suffixes]
    pattern = parent.tr("Bodies") + f" ({' '.join(f'*{s}' for s in suffixes)})"
    name, _ = QFileDialog.getOpenFileName(parent, parent.tr("Choose a body"), str(folder), pattern)
    return Path(name) if name else None


def _words(widget: QWidget, clip: Clip | None) -> str:
    """How the body follows the clip, in a sentence or two."""
    if clip is None or clip.outfit.avatar is None:
        return ""
    worn: Fit = standing_of(clip)[0]
    if worn.way is None:
        return widget.tr("The body has the very joints of the motion.")
    moved = sum(1 for _, targets in worn.way.joint_map.pairs if targets)
    text = widget.tr("{moved} of {n} joints of the motion move the body.")
    lines = [text.format(moved=moved, n=len(clip.motion.skeleton.joints))]
    lines += [f"{note[:1].upper()}{note[1:]}." for note in worn.way.notes]
    return "\n".join(lines)
