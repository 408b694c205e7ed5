"""A clip: one motion of the open document, with the body that wears it and where it came from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from qmd_studio.avatar.fit import is_figure
from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.loaded import Loaded
from qmd_studio.motion.joint_map import JointMap
from qmd_studio.motion.kinematics import rest_values
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.reference_pose import REST, ZERO, Reference, choose_reference, frame_reference

REST_FPS = 30.0
"""The frame rate of the single pose that stands for a file with a skeleton and no motion."""


class Alignment(StrEnum):
    """Which pose of a motion counts as the rest pose of the body that wears it."""

    AUTO = "auto"
    """The rest pose, or a T-pose that was put in front of the motion."""
    REST = "rest"
    FRAME = "frame"
    """The frame that `Outfit.frame` names."""
    ZERO = "zero"
    """None: turns are taken as they stand."""


@dataclass(frozen=True, slots=True, eq=False)
class Outfit:
    """What a clip is shown on: `avatar`, any body; None for one made from the clip's own bones.

    `joint_map` says which joint moves which, None for what the names and shapes of both say.
    """

    avatar: Body | None = None
    joint_map: JointMap | None = None
    alignment: Alignment = Alignment.AUTO
    frame: int = 0

    @property
    def name(self) -> str:
        """What the body is called, "" for one made from bones."""
        return self.avatar.name if self.avatar is not None else ""

    def reference(self, motion: Motion) -> Reference:
        """Return the pose of `motion` that counts as the body's rest; raises `FormatError` for a frame it lacks."""
        if self.alignment is Alignment.AUTO:
            return choose_reference(motion)
        if self.alignment is Alignment.FRAME:
            return frame_reference(motion, self.frame)
        return REST if self.alignment is Alignment.REST else ZERO


BONES = Outfit()
"""A body made from the clip's own bones."""


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """A motion that is open. Two clips are equal only where they are the same object.

    `key` names the clip in commands for as long as the document lives; `AddClip` gives it. `body` is the file's own
    body, None where it has none, and `outfit` what the clip is shown on. `path` is the file it came from, None for a
    motion made here.
    """

    name: str
    motion: Motion
    body: Body | None = None
    outfit: Outfit = BONES
    path: Path | None = None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    key: int = 0


def clip_from(loaded: Loaded, path: Path, avatar: Body | None = None) -> Clip:
    """Return the clip that shows what the file `path` held; a skeleton without motion stands for one frame at rest.

    It wears the file's own body, or else `avatar` where its skeleton is a person's, or else one made from its bones.
    """
    motion, notes = loaded.motion, loaded.notes
    if motion is None:
        motion = Motion(loaded.skeleton, rest_values(loaded.skeleton)[None, :], REST_FPS, name=path.stem)
        notes = (*notes, "The file holds no motion: its body stands at rest.")
    return Clip(
        name=path.stem,
        motion=motion,
        body=loaded.body,
        outfit=Outfit(loaded.body or (avatar if avatar is not None and is_figure(motion.skeleton) else None)),
        path=path,
        warnings=loaded.warnings,
        notes=notes,
    )
