"""The open document, the one mutable thing: commands change it in transactions, history takes them back."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from psygnal import Signal

from qmd_studio.errors import EditError
from qmd_studio.project.commands import Command
from qmd_studio.project.state import DocumentState


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the history: what it is called, and the states on either side of it, which share what they can."""

    label: str
    before: DocumentState
    after: DocumentState
    merge_key: Hashable | None = None


class Document:
    """Holds the current `DocumentState` and its history.

    `changed` is emitted with the new state after each execute, transaction, undo and redo that changed something,
    when the document already is in its new state.
    """

    changed = Signal(DocumentState)

    def __init__(self, state: DocumentState | None = None) -> None:
        self._state = state or DocumentState()
        self._clean = self._state
        self._done: list[Step] = []
        self._undone: list[Step] = []
        self._merging = False
        self._in_transaction = False

    @property
    def state(self) -> DocumentState:
        """What the document holds now."""
        return self._state

    def execute(self, command: Command) -> None:
        """Apply `command` as one step of the history, or as part of the transaction or drag that is under way.

        Raises what the command raises, `EditError` above all; the document then is as it was.
        """
        if self._in_transaction:
            self._state = command.apply(self._state)
            return
        before = self._state
        self._commit(Step(command.label, before, command.apply(before), command.merge_key))

    @contextmanager
    def transaction(self, label: str) -> Iterator[None]:
        """Make all commands executed in this block one step called `label`; an exception takes all of them back."""
        if self._in_transaction:
            raise EditError("a transaction is already open")
        before = self._state
        self._in_transaction = True
        try:
            yield
        except BaseException:
            self._state = before
            raise
        finally:
            self._in_transaction = False
        self._commit(Step(label, before, self._state))

    def end_merge(self) -> None:
        """Say that the drag is over: the next command starts a step of its own."""
        self._merging = False

    def undo(self) -> None:
        """Take back the last step; nothing happens where there is none."""
        self._refuse_in_transaction()
        if self._done:
            step = self._done.pop()
            self._undone.append(step)
            self._show(step.before)

    def redo(self) -> None:
        """Do the last step that was taken back again; nothing happens where there is none."""
        self._refuse_in_transaction()
        if self._undone:
            step = self._undone.pop()
            self._done.append(step)
            self._show(step.after)

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to do again."""
        return bool(self._undone)

    @property
    def undo_text(self) -> str:
        """The label of the step that undo takes back, "" where there is none."""
        return self._done[-1].label if self._done else ""

    @property
    def redo_text(self) -> str:
        """The label of the step that redo does again, "" where there is none."""
        return self._undone[-1].label if self._undone else ""

    @property
    def history(self) -> tuple[str, ...]:
        """The labels of the steps done, oldest first."""
        return tuple(step.label for step in self._done)

    @property
    def is_clean(self) -> bool:
        """Whether the document holds what it held when it was last marked clean."""
        return self._state == self._clean

    def mark_clean(self) -> None:
        """Remember the present state as the saved one."""
        self._clean = self._state
        self._merging = False

    def _commit(self, step: Step) -> None:
        if step.after == self._state and step.after == step.before:
            return
        last = self._done[-1] if self._done else None
        merges = self._merging and last is not None and step.merge_key is not None and last.merge_key == step.merge_key
        if merges and last is not None:
            step = replace(step, before=last.before)
            self._done.pop()
        if step.before != step.after:
            self._done.append(step)
        self._undone.clear()
        self._merging = step.merge_key is not None
        self._state = step.after
        self.changed.emit(self._state)

    def _show(self, state: DocumentState) -> None:
        self._merging = False
        self._state = state
        self.changed.emit(state)

    def _refuse_in_transaction(self) -> None:
        if self._in_transaction:
            raise EditError("history cannot move inside a transaction")
