"""Settings with a name: those that come with the studio, and the user's own, a JSON file each."""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import Any

import platformdirs

from qmd_studio import storage
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import FormatError, StorageError

SUFFIX = ".json"
FOLDER_VARIABLE = "QMD_STUDIO_PRESETS"
"""The environment variable that names another folder for the user's presets."""

MAX_NAME = 80
_MAX_BYTES = 1 << 16
_KIND, _VERSION = "QMD Studio preset", 1
_FORBIDDEN = re.compile(r'[<>:"/\\|?*\x00-\x1f]')


@dataclass(frozen=True, slots=True)
class Preset:
    """`settings` called `name`."""

    name: str
    settings: QmdSettings


BUILT_IN = (
    Preset("Smallest", QmdSettings(fdf=0)),
    Preset("Balanced", QmdSettings()),
    Preset("Near-transparent", QmdSettings(bits=10)),
    Preset("Paper Table 1: FDF 6, b 8, one segment", QmdSettings(encoder=Encoder.PAPER)),
)
"""What the studio comes with. The paper's grid optimum is another for each motion, and is searched for."""


def default_folder() -> Path:
    """Return the folder of the user's presets."""
    named = os.environ.get(FOLDER_VARIABLE)
    return Path(named) if named else platformdirs.user_config_path("qmd-studio", appauthor=False) / "presets"


class PresetShelf:
    """The user's own presets in `folder`, which is made when the first is saved."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder if folder is not None else default_folder()

    def own(self) -> list[Preset]:
        """Return the presets that can be read, by name. A file that is damaged is left out, and left alone."""
        try:
            paths = sorted(self.folder.glob(f"*{SUFFIX}"))
        except OSError:
            return []
        found = [preset for path in paths if (preset := _read_or_none(path)) is not None]
        return sorted(found, key=lambda preset: preset.name.casefold())

    def save(self, preset: Preset) -> None:
        """Keep `preset`; one of the same name is replaced.

        Raises `StorageError`, and `FormatError` for a name that is empty or cannot be told from another's in a file
        name.
        """
        path = self._path(preset.name)
        there = _read_or_none(path)
        if there is not None and there.name != preset.name:
            raise FormatError("the name is too much like another preset's", got=preset.name, wanted=f"not {there.name}")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise StorageError(
                "the folder of the presets cannot be made", path=self.folder, hint="Check that you may write there"
            ) from problem
        storage.write_atomic(path, to_json(preset))

    def rename(self, preset: Preset, name: str) -> Preset:
        """Call `preset` by another name and return it. Raises as `save` does, and where the name is taken."""
        renamed = Preset(_checked_name(name), preset.settings)
        if self._path(renamed.name) != self._path(preset.name) and self._path(renamed.name).exists():
            raise FormatError("there is a preset of this name", got=renamed.name, hint="Choose another name")
        self.save(renamed)
        if self._path(renamed.name) != self._path(preset.name):
            self.remove(preset)
        return renamed

    def remove(self, preset: Preset) -> None:
        """Throw `preset` away; nothing happens where it is gone already. Raises `StorageError`."""
        path = self._path(preset.name)
        try:
            path.unlink(missing_ok=True)
        except OSError as problem:
            raise StorageError(
                "the preset cannot be removed", path=path, hint="Check that you may write there"
            ) from problem

    def reset(self) -> None:
        """Throw all of the user's presets away. Raises `StorageError`."""
        for preset in self.own():
            self.remove(preset)

    def take_in(self, path: Path) -> Preset:
        """Keep the preset in the file `path` and return it. Raises `FormatError` and `StorageError`."""
        preset = read_preset(path)
        self.save(preset)
        return preset

    def _path(self, name: str) -> Path:
        stem = _FORBIDDEN.sub("_", _checked_name(name)).strip(". ") or "preset"
        return self.folder / f"{stem}{SUFFIX}"


def to_json(preset: Preset) -> bytes:
    """Return the file of a preset; an infinite k is the string "inf", which JSON has no number for."""
    settings: dict[str, Any] = {field.name: getattr(preset.settings, field.name) for field in fields(QmdSettings)}
    settings["k"] = "inf" if math.isinf(preset.settings.k) else preset.settings.k
    contents = {"kind": _KIND, "version": _VERSION, "name": preset.name, "settings": settings}
    return (json.dumps(contents, indent=2, ensure_ascii=False) + "\n").encode()


def read_preset(path: Path) -> Preset:
    """Return the preset in the file `path`. Raises `FormatError` for one that is none, `StorageError`."""
    data = storage.read_bytes(path, limit=_MAX_BYTES)
    try:
        return from_json(data)
    except FormatError as problem:
        raise problem.located(path) from problem.__cause__


def from_json(data: bytes) -> Preset:
    """Return the preset that `to_json` wrote; settings that it does not name have their defaults.

    Raises `FormatError` for anything else. Whether a motion can have these settings shows when they are used.
    """
    try:
        contents = json.loads(data)
        if contents["kind"] != _KIND or contents["version"] != _VERSION:
            raise ValueError(contents["kind"])
        name, given = contents["name"], dict(contents["settings"])
    except (ValueError, KeyError, TypeError, RecursionError) as problem:
        raise FormatError("this is no preset", wanted=f"a JSON file of the kind {_KIND!r}") from problem
    defaults = QmdSettings()
    values = {key: _value(key, value, getattr(defaults, key, None)) for key, value in given.items()}
    if not isinstance(name, str):
        raise FormatError("the preset has no name", got=repr(name))
    return Preset(_checked_name(name), QmdSettings(**values))


def _value(key: str, value: Any, default: Any) -> Any:
    """Return a setting's value as the type of its default; raises `FormatError`."""
    wrong = FormatError(f"the preset's setting {key!r} cannot be understood", got=repr(value)[:80])
    if default is None:
        raise wrong
    if isinstance(default, StrEnum):
        try:
            return type(default)(value)
        except ValueError:
            raise wrong from None
    if isinstance(default, float):
        value = math.inf if value == "inf" else value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise wrong
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise wrong
    return value


def _checked_name(name: str) -> str:
    name = name.strip()
    if not name:
        raise FormatError("a preset needs a name", hint="Type at least one character")
    if len(name) > MAX_NAME:
        raise FormatError("the name is too long", wanted=f"at most {MAX_NAME} characters", got=str(len(name)))
    return name


def _read_or_none(path: Path) -> Preset | None:
    try:
        return read_preset(path)
    except (FormatError, StorageError):
        return None
