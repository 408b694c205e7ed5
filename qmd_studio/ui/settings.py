"""What the window remembers between sessions, in one INI file of the user's."""

from __future__ import annotations

import os
from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings

ORGANISATION = "QMD Studio"
SETTINGS_VARIABLE = "QMD_STUDIO_SETTINGS"
"""The environment variable that names another settings file."""
LAYOUT_VERSION = 1
"""Counted up when docks are added or renamed: a layout of another version is not restored."""
MAX_RECENT = 10


class Settings:
    """Typed access to the settings file: every key it has is a method or property here."""

    def __init__(self) -> None:
        path = os.environ.get(SETTINGS_VARIABLE)
        ini = QSettings.Format.IniFormat
        if path:
            self._store = QSettings(path, ini)
        else:
            self._store = QSettings(ini, QSettings.Scope.UserScope, ORGANISATION, "studio")

    @property
    def theme(self) -> str:
        """Return "system", "light" or "dark"."""
        return str(self._store.value("theme", "system"))

    @theme.setter
    def theme(self, theme: str) -> None:
        self._store.setValue("theme", theme)

    @property
    def look(self) -> str:
        """How bodies are shown: the name of a look of the renderer, if nobody else has written here."""
        return str(self._store.value("view/look", "solid"))

    @look.setter
    def look(self, look: str) -> None:
        self._store.setValue("view/look", look)

    @property
    def joint_names(self) -> bool:
        """Whether the joint under the mouse is named."""
        return str(self._store.value("view/joint_names", "true")) == "true"

    @joint_names.setter
    def joint_names(self, names: bool) -> None:
        self._store.setValue("view/joint_names", "true" if names else "false")

    @property
    def recent(self) -> list[Path]:
        """The files opened last, newest first, that still exist."""
        stored = self._store.value("recent", [])
        names = [stored] if isinstance(stored, str) else list(stored or [])
        return [path for path in map(Path, names) if path.is_file()]

    def add_recent(self, path: Path) -> None:
        """Put `path` at the head of the recent files."""
        path = path.resolve()
        others = [old for old in self.recent if old != path]
        self._store.setValue("recent", [str(p) for p in [path, *others][:MAX_RECENT]])

    def clear_recent(self) -> None:
        """Forget the recent files."""
        self._store.remove("recent")

    def folder(self, purpose: str) -> Path:
        """Return the folder last used for `purpose` ("open" or "export"), the home folder at first."""
        stored = Path(str(self._store.value(f"folder/{purpose}", Path.home())))
        return stored if stored.is_dir() else Path.home()

    def set_folder(self, purpose: str, folder: Path) -> None:
        """Remember the folder used for `purpose`."""
        self._store.setValue(f"folder/{purpose}", str(folder))

    @property
    def device(self) -> str:
        """The name of the device profile chosen last, "" where none was."""
        return str(self._store.value("device", ""))

    @device.setter
    def device(self, name: str) -> None:
        self._store.setValue("device", name)

    def layout(self) -> tuple[QByteArray, QByteArray] | None:
        """Return the window's geometry and its docks' state, None where there is none of this version."""
        if int(self._store.value("layout/version", 0)) != LAYOUT_VERSION:
            return None
        geometry, state = self._store.value("layout/geometry"), self._store.value("layout/state")
        if not isinstance(geometry, QByteArray) or not isinstance(state, QByteArray):
            return None
        return geometry, state

    def set_layout(self, geometry: QByteArray, state: QByteArray) -> None:
        """Remember the window's geometry and its docks' state."""
        self._store.setValue("layout/version", LAYOUT_VERSION)
        self._store.setValue("layout/geometry", geometry)
        self._store.setValue("layout/state", state)

    def sync(self) -> None:
        """Write what is still pending."""
        self._store.sync()
