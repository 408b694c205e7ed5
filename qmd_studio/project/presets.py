"""Settings with a name: those that come with the studio, and the user's own, a JSON file each."""

from __future__ import annotations

import os
import re
from pathlib import Path

import platformdirs

from qmd_studio import storage
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import FormatError, StorageError
from qmd_studio.project.preset_json import Preset, checked_name, from_json, to_json
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings

SUFFIX = ".json"
FOLDER_VARIABLE = "QMD_STUDIO_PRESETS"
"""The environment variable that names another folder for the user's presets."""

_MAX_BYTES = 1 << 16
_FORBIDDEN = re.compile(r'[<>:"/\\|?*\x00-\x1f]')


BUILT_IN = (
    Preset("Smallest", EncodeSettings(QmdSettings(fdf=0))),
    Preset("Balanced", EncodeSettings()),
    Preset("Near-transparent", EncodeSettings(QmdSettings(bits=10))),
    Preset("Within 1 mm", EncodeSettings(QmdSettings(fdf=0, encoder=Encoder.BOUNDED, max_error_mm=1.0))),
    Preset("Compact: half a millimetre, segments that play alone", EncodeSettings(COMPACT_DEFAULT)),
    Preset("Paper Table 1: FDF 6, b 8, one segment", EncodeSettings(QmdSettings(encoder=Encoder.PAPER))),
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
        renamed = Preset(checked_name(name), preset.settings)
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
        stem = _FORBIDDEN.sub("_", checked_name(name)).strip(". ") or "preset"
        return self.folder / f"{stem}{SUFFIX}"


def read_preset(path: Path) -> Preset:
    """Return the preset in the file `path`. Raises `FormatError` for one that is none, `StorageError`."""
    data = storage.read_bytes(path, limit=_MAX_BYTES)
    try:
        return from_json(data)
    except FormatError as problem:
        raise problem.located(path) from problem.__cause__


def _read_or_none(path: Path) -> Preset | None:
    try:
        return read_preset(path)
    except (FormatError, StorageError):
        return None
