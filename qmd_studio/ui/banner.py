"""Messages inside the window, beside their cause: what happened, where, what was wanted, and the way out."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from qmd_studio.errors import QmdStudioError
from qmd_studio.ui.icons import icon, tinted_icon

MAX_BANNERS = 3
"""As many messages are shown; older ones wait behind them until those are dismissed."""
KEPT_BANNERS = 50
_MAX_LINES = 6


class Banner(QFrame):
    """One message of `kind` "error", "warning" or "info"; `lines` below its title, the last of them the way out."""

    dismissed = Signal()

    def __init__(self, kind: str, title: str, lines: list[str], colour: str) -> None:
        super().__init__()
        self.setObjectName("Banner")
        self.setProperty("kind", kind)
        self.setAccessibleName(f"{kind}: {title}")
        self.title, self.lines, self.kind = title, lines, kind
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 8, 8, 8)
        row.setSpacing(12)
        self._lamp = QLabel()
        row.addWidget(self._lamp, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(self._words(), 1)
        self._buttons = {
            "copy": self._button(self.tr("Copy this message"), self._copy),
            "close": self._button(self.tr("Dismiss this message  (Esc)"), self.dismissed.emit),
        }
        for button in self._buttons.values():
            row.addWidget(button, 0, Qt.AlignmentFlag.AlignTop)
        self.draw_icons(colour)

    def draw_icons(self, colour: str) -> None:
        """Draw the icons for the present theme, the lamp in `colour`."""
        self._lamp.setPixmap(tinted_icon(self.kind, colour).pixmap(20, 20))
        for name, button in self._buttons.items():
            button.setIcon(icon(name))

    @property
    def text(self) -> str:
        """The whole message."""
        return "\n".join([self.title, *self.lines])

    def _words(self) -> QVBoxLayout:
        words = QVBoxLayout()
        words.setSpacing(4)
        shown = [self.title, *self.lines[:_MAX_LINES]]
        if len(self.lines) > _MAX_LINES:
            shown.append(self.tr("… and {n} more").format(n=len(self.lines) - _MAX_LINES))
        for index, line in enumerate(shown):
            label = QLabel(line)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            if index == 0:
                label.setObjectName("Title")
            words.addWidget(label)
        return words

    def _button(self, tip: str, clicked: Callable[[], None]) -> QToolButton:
        button = QToolButton()
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.clicked.connect(lambda: clicked())
        return button

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.text)


class BannerArea(QWidget):
    """A stack of messages, newest first; no higher than they need, the oldest behind the others."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(8, 8, 8, 8)
        self._column.setSpacing(8)
        self.banners: list[Banner] = []
        self._behind = QLabel()
        self._behind.setObjectName("Behind")
        self._column.addWidget(self._behind, 0, Qt.AlignmentFlag.AlignRight)
        self.hide()

    def show_error(self, problem: QmdStudioError, colour: str) -> None:
        """Show an error with its file, its place, what was wanted and got, and the way out."""
        title = problem.message[:1].upper() + problem.message[1:]
        place = "  ·  ".join(part for part in (str(problem.path or ""), problem.at or "") if part)
        wanted = self.tr("Wanted {value}").format(value=problem.wanted) if problem.wanted else ""
        got = self.tr("got {value}").format(value=problem.got) if problem.got else ""
        if not wanted:
            got = got[:1].upper() + got[1:]
        expectation = ", ".join(part for part in (wanted, got) if part)
        self.show_message("error", title, [p for p in (place, expectation, problem.hint or "") if p], colour)

    def show_message(self, kind: str, title: str, lines: list[str], colour: str) -> None:
        """Show a message on top; the same message is not shown twice."""
        for old in self.banners:
            if (old.kind, old.title, old.lines) == (kind, title, lines):
                self._remove(old)
                break
        banner = Banner(kind, title, lines, colour)
        banner.dismissed.connect(lambda: self._remove(banner))
        self.banners.insert(0, banner)
        self._column.insertWidget(0, banner)
        for old in self.banners[KEPT_BANNERS:]:
            self._remove(old)
        self._stack()

    def dismiss_newest(self) -> bool:
        """Close the newest message; returns whether there was one."""
        if self.banners:
            self._remove(self.banners[0])
            return True
        return False

    def clear(self) -> None:
        """Close all messages."""
        while self.dismiss_newest():
            pass

    def _remove(self, banner: Banner) -> None:
        if banner in self.banners:
            self.banners.remove(banner)
            self._column.removeWidget(banner)
            banner.hide()
            banner.deleteLater()
        self._stack()

    def _stack(self) -> None:
        for place, banner in enumerate(self.banners):
            banner.setVisible(place < MAX_BANNERS)
        waiting = len(self.banners) - MAX_BANNERS
        words = self.tr("1 older message waits") if waiting == 1 else self.tr("{n} older messages wait")
        self._behind.setText(words.format(n=waiting))
        self._behind.setVisible(waiting > 0)
        self.setVisible(bool(self.banners))
