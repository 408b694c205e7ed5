"""What the document holds at one instant, never changed in place."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum

from qmd_studio.errors import EditError
from qmd_studio.project.clip import Clip
from qmd_studio.tuning.encode_settings import EncodeSettings


class Side(StrEnum):
    """One of the two sides that the codec lab compares."""

    A = "a"
    """The original at first, or an encoding of it."""
    B = "b"
    """An encoding: the one that is exported."""

    @property
    def other(self) -> Side:
        """The other side."""
        return Side.B if self is Side.A else Side.A


@dataclass(frozen=True, slots=True)
class DocumentState:
    """The clips, the key of the one that is shown (None where there is none), and the settings of both sides.

    `codec` is what side B is encoded with, `codec_a` side A, None where A is the original.

    `next_key` is the key that the next clip gets: keys are never used twice, so that a command means the same clip
    whenever it is applied.
    """

    clips: tuple[Clip, ...] = ()
    active: int | None = None
    codec: EncodeSettings = field(default_factory=EncodeSettings)
    codec_a: EncodeSettings | None = None
    next_key: int = 1

    @property
    def active_clip(self) -> Clip | None:
        """The clip that is shown, None where nothing is open."""
        return None if self.active is None else self.clip(self.active)

    def clip(self, key: int) -> Clip:
        """Return the clip called `key`; raises `EditError` where there is none."""
        for clip in self.clips:
            if clip.key == key:
                return clip
        raise EditError("there is no such clip", at=f"clip {key}", hint="It may have been closed")

    def settings_of(self, side: Side) -> EncodeSettings | None:
        """Return what `side` is encoded with, None where it is the original."""
        return self.codec if side is Side.B else self.codec_a

    def with_clip(self, clip: Clip) -> DocumentState:
        """Return this state with `clip` in the place of the clip of the same key; raises `EditError` without one."""
        self.clip(clip.key)
        return replace(self, clips=tuple(clip if old.key == clip.key else old for old in self.clips))
