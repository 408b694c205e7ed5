"""Every change of the document, as data: what a drag, a menu or a journal applies and undo takes back."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from qmd_studio.avatar.fit import fit
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import EditError
from qmd_studio.motion.motion import FRAME_RATES
from qmd_studio.project.clip import Clip, Outfit
from qmd_studio.project.state import DocumentState, Side
from qmd_studio.tuning.encode_settings import EncodeSettings

MAX_FPS = 1000.0
METRES_PER_UNIT = (1e-6, 1e3)
"""The length units that can be set: from a micrometre to a kilometre."""


class Command(Protocol):
    """A change of the document.

    `label` is what Edit shows after "Undo". Consecutive commands with equal `merge_key`, other than None, become one
    step of the history until the document is told that the drag is over.
    """

    @property
    def label(self) -> str:
        """The change in a few words, for the history."""

    @property
    def merge_key(self) -> Hashable | None:
        """What a drag has in common, or None for a change that always stands alone."""

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state after the change; raises `EditError` where it makes no sense."""


@dataclass(frozen=True, slots=True)
class AddClip:
    """Add `clip`, under a new key, and show it."""

    clip: Clip
    merge_key: None = None

    @property
    def label(self) -> str:
        """The change in a few words."""
        return f"Open {self.clip.name}"

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the clip at its end and shown."""
        clip = replace(self.clip, key=state.next_key)
        return replace(state, clips=(*state.clips, clip), active=clip.key, next_key=state.next_key + 1)


@dataclass(frozen=True, slots=True)
class RemoveClip:
    """Close the clip `key`; its neighbour is shown where it was the one that is shown."""

    key: int
    label: str = "Close clip"
    merge_key: None = None

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state without the clip."""
        place = state.clips.index(state.clip(self.key))
        rest = state.clips[:place] + state.clips[place + 1 :]
        if state.active != self.key:
            return replace(state, clips=rest)
        active = rest[min(place, len(rest) - 1)].key if rest else None
        return replace(state, clips=rest, active=active)


@dataclass(frozen=True, slots=True)
class ActivateClip:
    """Show the clip `key`."""

    key: int
    label: str = "Show clip"
    merge_key: Hashable = "activate"

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state that shows the clip."""
        return replace(state, active=state.clip(self.key).key)


@dataclass(frozen=True, slots=True)
class SetCodecSettings:
    """Set what a side is encoded with, None for the original on side A; Export QMD writes side B.

    `drag` names the slider that is being dragged.
    """

    settings: EncodeSettings | None
    drag: str | None = None
    side: Side = Side.B
    label: str = "Codec settings"

    @property
    def merge_key(self) -> Hashable | None:
        """The same slider is one drag."""
        return None if self.drag is None else ("codec", self.side, self.drag)

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with these settings; raises `EditError` for a side B that is not encoded."""
        if self.side is Side.A:
            return replace(state, codec_a=self.settings)
        if self.settings is None:
            raise EditError("side B is always encoded", hint="Let side A be the original")
        return replace(state, codec=self.settings)


@dataclass(frozen=True, slots=True)
class CopySettings:
    """Give side `to` the settings of the other side."""

    to: Side
    merge_key: None = None

    @property
    def label(self) -> str:
        """The change in a few words."""
        return f"Copy settings to {self.to.upper()}"

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with both sides alike; raises `EditError` where there is nothing to copy."""
        settings = state.settings_of(self.to.other)
        if settings is None:
            raise EditError("side A is the original: it has no settings to copy", hint="Encode side A first")
        return replace(state, codec=settings, codec_a=settings)


@dataclass(frozen=True, slots=True)
class SetLevels:
    """Set the paper's level, 1 to 6, of named columns of the clip `key`; other columns keep theirs."""

    key: int
    levels: tuple[tuple[str, int], ...]
    label: str = "Column levels"
    merge_key: None = None

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the clip's level table edited; raises `FormatError` for a level or name amiss."""
        clip = state.clip(self.key)
        skeleton = clip.motion.skeleton.with_levels(dict(self.levels))
        if skeleton == clip.motion.skeleton:
            return state
        return state.with_clip(replace(clip, motion=replace(clip.motion, skeleton=skeleton)))


@dataclass(frozen=True, slots=True)
class SetLengthUnit:
    """Say how many metres a unit of the file of clip `key` is: skeleton, motion and body take the new size."""

    key: int
    metres_per_unit: float
    label: str = "Length unit"
    merge_key: None = None

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the clip scaled; raises `EditError` for a unit out of range."""
        smallest, largest = METRES_PER_UNIT
        if not smallest <= self.metres_per_unit <= largest:
            raise EditError(
                "the length unit is out of range",
                wanted=f"{smallest:g} to {largest:g} metres",
                got=f"{self.metres_per_unit:g}",
            )
        clip = state.clip(self.key)
        factor = self.metres_per_unit / clip.motion.skeleton.metres_per_unit
        if math.isclose(factor, 1.0, rel_tol=1e-12):
            return state
        body = None if clip.body is None else _scaled_body(clip.body, factor)
        outfit = replace(clip.outfit, avatar=body) if clip.outfit.avatar is clip.body else clip.outfit
        return state.with_clip(replace(clip, motion=clip.motion.scaled(factor), body=body, outfit=outfit))


@dataclass(frozen=True, slots=True)
class SetFps:
    """Set the frame rate of the clip `key`; its frames stay as they are."""

    key: int
    fps: float
    label: str = "Frame rate"
    merge_key: None = None

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the frame rate set; raises `EditError` for one that is out of range."""
        if not FRAME_RATES[0] <= self.fps <= MAX_FPS:
            wanted, got = f"{FRAME_RATES[0]:g} to {MAX_FPS:g} frames a second", f"{self.fps:g}"
            raise EditError("the frame rate is out of range", wanted=wanted, got=got)
        clip = state.clip(self.key)
        if clip.motion.fps == self.fps:
            return state
        return state.with_clip(replace(clip, motion=replace(clip.motion, fps=self.fps)))


@dataclass(frozen=True, slots=True)
class WearBody:
    """Show the clip `key` in `outfit`; its motion stays as it is."""

    key: int
    outfit: Outfit
    merge_key: None = None

    @property
    def label(self) -> str:
        """The change in a few words."""
        return f"Wear {self.outfit.name or 'bones'}"

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the clip in its outfit; raises `FormatError` where the body cannot follow it."""
        clip = state.clip(self.key)
        if self.outfit.avatar is not None:
            reference = self.outfit.reference(clip.motion)
            fit(clip.motion, self.outfit.avatar, joint_map=self.outfit.joint_map, reference=reference)
        return state.with_clip(replace(clip, outfit=self.outfit))


@dataclass(frozen=True, slots=True)
class RenameClip:
    """Call the clip `key` by another name."""

    key: int
    name: str
    label: str = "Rename clip"
    merge_key: None = None

    def apply(self, state: DocumentState) -> DocumentState:
        """Return the state with the name; raises `EditError` for an empty one."""
        name = self.name.strip()
        if not name:
            raise EditError("a clip needs a name", hint="Type at least one character")
        clip = state.clip(self.key)
        return state if clip.name == name else state.with_clip(replace(clip, name=name))


def _scaled_body(body: Body, factor: float) -> Body:
    bind = body.bind.copy()
    bind[:, :3, 3] *= factor
    surface = replace(body.surface, vertices=body.surface.vertices * np.float32(factor))
    return replace(body, skeleton=body.skeleton.scaled(factor), surface=surface, bind=bind)
