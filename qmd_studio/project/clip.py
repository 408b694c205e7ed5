"""A clip: one motion of the open document, with the body that wears it and where it came from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.loaded import Loaded
from qmd_studio.motion.kinematics import rest_values
from qmd_studio.motion.motion import Motion

REST_FPS = 30.0
"""The frame rate of the single pose that stands for a file with a skeleton and no motion."""


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """A motion that is open. Two clips are equal only where they are the same object.

    `key` names the clip in commands for as long as the document lives; `AddClip` gives it. `body` is the file's own
    body, None where the body is made from the bones. `path` is the file it came from, None for a motion made here.
    """

    name: str
    motion: Motion
    body: Body | None = None
    path: Path | None = None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    key: int = 0


def clip_from(loaded: Loaded, path: Path) -> Clip:
    """Return the clip that shows what the file `path` held; a skeleton without motion stands for one frame at rest."""
    motion, notes = loaded.motion, loaded.notes
    if motion is None:
        motion = Motion(loaded.skeleton, rest_values(loaded.skeleton)[None, :], REST_FPS, name=path.stem)
        notes = (*notes, "The file holds no motion: its body stands at rest.")
    return Clip(
        name=path.stem,
        motion=motion,
        body=loaded.body,
        path=path,
        warnings=loaded.warnings,
        notes=notes,
    )
