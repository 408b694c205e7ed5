"""What stands in the viewport: the shown clip, what its QMD file plays, or both, at the playhead's frame."""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache

from PySide6.QtCore import QObject

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.project.clip import Clip
from qmd_studio.project.playhead import Playhead
from qmd_studio.render.scene import Actor
from qmd_studio.ui.viewport import Viewport


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
        self._decoded: Motion | None = None
        self._overlay = Overlay.ORIGINAL
        self._default: list[Actor] = []
        playhead.moved.connect(self._pose)

    @property
    def overlay(self) -> Overlay:
        """Which of the two motions is shown, where there is a decoded one."""
        return self._overlay

    @overlay.setter
    def overlay(self, overlay: Overlay) -> None:
        self._overlay = overlay
        self._pose()

    @property
    def decoded(self) -> Motion | None:
        """What the QMD file plays."""
        return self._decoded

    def show_clip(self, clip: Clip | None) -> None:
        """Show `clip`, or an empty stage; a decoded motion of another length or skeleton goes."""
        self._clip = clip
        if clip is None or (self._decoded is not None and not _fits(self._decoded, clip.motion)):
            self._decoded = None
        self._pose()

    def show_decoded(self, motion: Motion | None) -> None:
        """Take over what the QMD file plays, or None where that is not known."""
        fits = self._clip is not None and motion is not None and _fits(motion, self._clip.motion)
        self._decoded = motion if fits else None
        self._pose()

    def show_default_body(self) -> None:
        """Let the default body stand, from now on, wherever nothing is open."""
        from qmd_studio.motion.bap import bap_skeleton

        skeleton = bap_skeleton()
        self._default = [Actor(_made(skeleton), world_from_joint(skeleton, rest_values(skeleton)[None])[0])]
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
            actors.append(Actor(body, self._matrices(self._decoded), ghost=overlay is Overlay.BOTH))
        self._viewport.set_actors(actors)

    def _matrices(self, motion: Motion) -> FloatArray:
        index = min(self._playhead.index, motion.n_frames - 1)
        return world_from_joint(motion.skeleton, motion.X[index : index + 1])[0]


def body_of(clip: Clip) -> Body:
    """Return the clip's own body, or the one made from its bones."""
    return clip.body if clip.body is not None else _made(clip.motion.skeleton)


@lru_cache(maxsize=16)
def _made(skeleton: Skeleton) -> Body:
    from qmd_studio.avatar.bone_body import bone_body  # not needed for the first picture

    return bone_body(skeleton)


def _fits(decoded: Motion, original: Motion) -> bool:
    return decoded.X.shape == original.X.shape and len(decoded.skeleton.joints) == len(original.skeleton.joints)
