"""What stands in the viewport: the shown clip, what its QMD file plays, or both, at the playhead's frame."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QObject

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.avatar.upright import upright
from qmd_studio.motion.in_between import in_between
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.project.clip import Clip
from qmd_studio.project.playhead import Playhead
from qmd_studio.render.ground import ground_height
from qmd_studio.render.scene import Actor
from qmd_studio.ui.viewport import Viewport

_SMOOTH_FPS = 60.0
"""Motions of fewer frames a second are played with poses in between."""


class Overlay(StrEnum):
    """Which of the two motions is shown."""

    ORIGINAL = "original"
    BOTH = "overlay"
    DECODED = "decoded"


class Stage(QObject):
    """Poses the bodies and hands them to the viewport whenever clip, decoded motion, overlay or frame changes."""

    def __init__(self, viewport: Viewport, playhead: Playhead, parent: QObject) -> None:
        super().__init__(parent)
        self._viewport, self._playhead = viewport, playhead
        self._clip: Clip | None = None
        self._decoded: Callable[[], Motion] | None = None
        self._overlay = Overlay.ORIGINAL
        self._follows = True
        self._stands_at: FloatArray | None = None
        self._upright = np.eye(4)
        self._default: list[Actor] = []
        self.kinematics: Callable[[Skeleton, FloatArray], FloatArray] = world_from_joint
        """What poses the bodies: NumPy until the compiled path is warm, which takes longer than the first picture."""
        playhead.moved.connect(self._pose)
        playhead.glided.connect(self._pose)
        playhead.state_changed.connect(self._pose)  # at rest a frame is shown as it is

    @property
    def overlay(self) -> Overlay:
        """Which of the two motions is shown, where there is a decoded one."""
        return self._overlay

    @overlay.setter
    def overlay(self, overlay: Overlay) -> None:
        self._overlay = overlay
        self._pose()

    @property
    def follows(self) -> bool:
        """Whether the camera goes along with the body over the ground."""
        return self._follows

    @follows.setter
    def follows(self, follows: bool) -> None:
        self._follows = follows

    @property
    def has_decoded(self) -> bool:
        """Whether it is known what the QMD file plays."""
        return self._decoded is not None

    def show_clip(self, clip: Clip | None) -> None:
        """Show `clip`, or the default body; what was decoded of another motion goes."""
        before, self._clip = self._clip, clip
        if clip is None or before is None or clip.key != before.key:
            self._stands_at = None  # another body: the camera is framed anew, not carried there
        if clip is None or before is None or clip.motion is not before.motion:
            self._decoded = None
            self._upright, ground = standing_of(clip) if clip is not None else (np.eye(4), 0.0)
            self._viewport.set_ground_height(ground)
        self._pose()

    def show_decoded(self, decoded: Callable[[], Motion] | None) -> None:
        """Take over what the QMD file of the shown clip plays, made when first looked at; None if unknown."""
        self._decoded = decoded if self._clip is not None else None
        self._pose()

    def show_default_body(self) -> None:
        """Let the default body stand, from now on, wherever nothing is open."""
        from qmd_studio.motion.bap import bap_skeleton
        from qmd_studio.motion.bap_ease import at_ease

        skeleton = bap_skeleton()
        self._default = [Actor(_made(skeleton), world_from_joint(skeleton, at_ease()[None])[0])]
        self._pose()

    def _pose(self, _index: int = 0) -> None:
        if self._clip is None:
            self._viewport.set_actors(self._default)
            return
        body = body_of(self._clip)
        overlay = self._overlay if self._decoded is not None else Overlay.ORIGINAL
        actors = []
        if overlay is not Overlay.DECODED:
            actors.append(Actor(body, self._matrices(self._clip.motion)))
        if overlay is not Overlay.ORIGINAL and self._decoded is not None:
            actors.append(Actor(body, self._matrices(self._decoded()), ghost=overlay is Overlay.BOTH))
        self._viewport.set_actors(actors)
        self._carry_camera(actors[0].world_from_joint[0, :3, 3])

    def _carry_camera(self, root: FloatArray) -> None:
        before, self._stands_at = self._stands_at, root.copy()
        if self._follows and before is not None:
            moved = root - before
            moved[1] = 0.0  # a jump is seen as one
            self._viewport.carry_camera(moved)

    def _matrices(self, motion: Motion) -> FloatArray:
        index = min(self._playhead.index, motion.n_frames - 1)
        row, share = motion.X[index], self._playhead.share
        if share > 0.0 and index + 1 < motion.n_frames and motion.fps < _SMOOTH_FPS:
            row = in_between(motion.skeleton, row, motion.X[index + 1], share)
        return self._upright @ self.kinematics(motion.skeleton, row[None])[0]


def body_of(clip: Clip) -> Body:
    """Return the clip's own body, or the one made from its bones."""
    return clip.body if clip.body is not None else _made(clip.motion.skeleton)


def standing_of(clip: Clip) -> tuple[FloatArray, float]:
    """Return the rotation (4, 4) that stands the clip up and the height of the ground under it, metres."""
    return _standing(clip.motion, body_of(clip))


def prepare(clip: Clip) -> None:
    """Make and remember all that showing `clip` needs, on whatever thread this is called: it may take a while."""
    standing_of(clip)


@lru_cache(maxsize=16)
def _standing(motion: Motion, body: Body) -> tuple[FloatArray, float]:
    turn = upright(motion)
    return turn, ground_height(motion, body, turn)


@lru_cache(maxsize=16)
def _made(skeleton: Skeleton) -> Body:
    from qmd_studio.avatar.bone_body import bone_body  # not needed for the first picture

    return bone_body(skeleton)
