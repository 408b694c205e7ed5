"""A notice beside its cause: what went wrong or well, and the way on."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from qmd_studio.errors import QmdStudioError


class Notice(QFrame):
    """A box with a title, a text and up to two links; hidden until it has something to say.

    `link` is emitted with the key of a link that was clicked.
    """

    link = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("Banner")
        self.title, self.text = QLabel(self), QLabel(self)
        self.title.setObjectName("Title")
        for label in (self.title, self.text):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._links = QHBoxLayout()
        self._links.setSpacing(8)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(10, 8, 10, 8)
        layout.setSpacing(4)
        layout.addWidget(self.title)
        layout.addWidget(self.text)
        layout.addLayout(self._links)
        self.hide()

    def say(self, kind: str, title: str, text: str = "", links: tuple[tuple[str, str], ...] = ()) -> None:
        """Show a notice of `kind` "info", "warning" or "error"; `links` are pairs of key and text."""
        self.setProperty("kind", kind)
        self.title.setText(title)
        self.text.setText(text)
        self.text.setVisible(bool(text))
        self._offer(links)
        for widget in (self, self.title, self.text):  # the style sheet looks at `kind` only when it is asked to
            widget.style().unpolish(widget)
            widget.style().polish(widget)
        self.setAccessibleName(f"{title}. {text}")
        self.show()

    def say_error(self, title: str, problem: QmdStudioError) -> None:
        """Show what went wrong, with where, wanted, got and the next step."""
        self.say("error", title, str(problem))

    def clear(self) -> None:
        """Have nothing more to say."""
        self.title.clear()
        self.hide()

    def _offer(self, links: tuple[tuple[str, str], ...]) -> None:
        while (item := self._links.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.deleteLater()
        for key, text in links:
            button = QPushButton(text, self)
            button.clicked.connect(lambda _=False, key=key: self.link.emit(key))
            self._links.addWidget(button)
        self._links.addStretch(1)
