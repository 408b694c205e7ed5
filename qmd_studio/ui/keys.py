"""Keys belong to the widget that is being typed in; only what it has no use for is a shortcut of the window."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QTextEdit,
    QWidget,
)

_MOVES = {
    Qt.Key.Key_Left,
    Qt.Key.Key_Right,
    Qt.Key.Key_Up,
    Qt.Key.Key_Down,
    Qt.Key.Key_Home,
    Qt.Key.Key_End,
    Qt.Key.Key_Backspace,
    Qt.Key.Key_Delete,
    Qt.Key.Key_Escape,
}
_STEPS = {
    Qt.Key.Key_Left,
    Qt.Key.Key_Right,
    Qt.Key.Key_Up,
    Qt.Key.Key_Down,
    Qt.Key.Key_Home,
    Qt.Key.Key_End,
    Qt.Key.Key_PageUp,
    Qt.Key.Key_PageDown,
}
_EDITING = (
    QKeySequence.StandardKey.Undo,
    QKeySequence.StandardKey.Redo,
    QKeySequence.StandardKey.Cut,
    QKeySequence.StandardKey.Copy,
    QKeySequence.StandardKey.Paste,
    QKeySequence.StandardKey.SelectAll,
)
_PRESSES = {Qt.Key.Key_Space, Qt.Key.Key_Select}


class KeyGuard(QObject):
    """Watches the application: before a key becomes a shortcut, a text field or a focused button may claim it."""

    def __init__(self, app: QApplication) -> None:
        super().__init__(app)
        app.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() != QEvent.Type.ShortcutOverride or not isinstance(watched, QWidget):
            return False
        if isinstance(event, QKeyEvent) and claims(watched, event):
            event.accept()
            return True
        return False


def claims(widget: QWidget, event: QKeyEvent) -> bool:
    """Say whether `widget` keeps the key for itself."""
    key, modifiers = Qt.Key(event.key()), event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
    bare = modifiers in (Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier)
    if is_typed_in(widget):
        typed = bare and bool(event.text()) and event.text().isprintable()
        return typed or key in _MOVES or any(event.matches(standard) for standard in _EDITING)
    if isinstance(widget, QAbstractSlider):
        return modifiers == Qt.KeyboardModifier.NoModifier and key in _STEPS
    if isinstance(widget, QAbstractButton | QComboBox):
        return bare and key in _PRESSES
    return False


def is_typed_in(widget: QWidget) -> bool:
    """Say whether `widget` is a text field that can be typed in."""
    if isinstance(widget, QLineEdit | QPlainTextEdit | QTextEdit):
        return not widget.isReadOnly()
    if isinstance(widget, QAbstractSpinBox):
        return not widget.isReadOnly()
    return isinstance(widget, QComboBox) and widget.isEditable()
