"""How the verbs get their motions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from qmd_studio import registry
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, slots=True)
class OpenedMotion:
    """A motion and what its reader had to say about it."""

    motion: Motion
    warnings: tuple[str, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class OpenedBody:
    """A body, the motion that came with it, and what its reader had to say."""

    path: Path
    body: Body
    motion: Motion | None
    warnings: tuple[str, ...]
    notes: tuple[str, ...]


def open_body(path: str, *, metres_per_unit: float | None = None) -> OpenedBody:
    """Open a file that must hold a body. Raises `FormatError` where it holds none."""
    loaded = registry.open_file(Path(path), ReadOptions(metres_per_unit=metres_per_unit))
    if loaded.body is None:
        got = "a motion" if loaded.motion else "a skeleton"
        raise FormatError("the file holds no body with a surface", path=path, wanted="a figure with meshes", got=got)
    warnings = tuple(f"{path}: {warning}" for warning in loaded.warnings)
    return OpenedBody(Path(path), loaded.body, loaded.motion, warnings, loaded.notes)


def open_any(path: str, *, skeleton: str | None = None, fps: float | None = None) -> Loaded:
    """Open any file; its warnings name it. Raises `FormatError` or `StorageError`."""
    options = ReadOptions(skeleton=Path(skeleton) if skeleton else None, fps=fps)
    loaded = registry.open_file(Path(path), options)
    return replace(loaded, warnings=tuple(f"{path}: {warning}" for warning in loaded.warnings))


def open_motion(path: str, *, skeleton: str | None = None, fps: float | None = None) -> OpenedMotion:
    """Open a file that must hold a motion. Raises `FormatError` where it holds a body or a skeleton only."""
    loaded = open_any(path, skeleton=skeleton, fps=fps)
    if loaded.motion is None:
        raise FormatError(
            "the file holds no motion",
            path=path,
            wanted="frames",
            got="a body" if loaded.body else "a skeleton",
            hint="Give the file of the motion itself; an .amc finds its .asf by name or through --skeleton",
        )
    return OpenedMotion(loaded.motion, loaded.warnings, loaded.notes)
