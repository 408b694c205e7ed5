"""The bodies that can be worn: those that ship, those of open clips, and those of files, read beside the window."""

from __future__ import annotations

from pathlib import Path
from threading import Event

from PySide6.QtCore import QObject, Signal

from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.ui.background import Background, Tell


class Wardrobe(QObject):
    """Reads bodies off the GUI thread. `came` hands one over, `failed` says why one could not be read."""

    came = Signal(object)
    failed = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.loaded: list[Body] = []
        """Bodies of files, in the order in which they came."""
        self._reading = Background("wardrobe", self)
        self._reading.ended.connect(self._take)
        self._reading.failed.connect(self.failed)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the bodies that ship, the default first."""
        from qmd_studio.registry import avatar_names

        return avatar_names()

    def fetch(self, body: str | Path) -> None:
        """Read the body that ships under a name, or that of a file; returns at once."""

        def read(_stop: Event, _tell: Tell) -> tuple[bool, Body]:
            from qmd_studio.registry import open_body

            found = open_body(body).body
            if found is None:
                raise FormatError("the file holds no body", path=body, wanted="a skin or segments with meshes")
            return isinstance(body, Path), found

        self._reading.run(read)

    def close_down(self) -> None:
        """Stop reading, before the window goes."""
        self._reading.close()

    def _take(self, found: tuple[bool, Body]) -> None:
        from_file, body = found
        if from_file:
            self.loaded.append(body)
        self.came.emit(body)
