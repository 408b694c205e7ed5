"""What stands in the viewport at the playhead's frame: the two sides that are compared, one of them or both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from threading import Event

import numpy as np
from PySide6.QtCore import QObject

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.avatar.dressed import morphs
from qmd_studio.avatar.fit import Fit, fit, fit_bones
from qmd_studio.motion.in_between import in_between
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.project.clip import Clip, Outfit
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import Side
from qmd_studio.render.ground import ground_height
from qmd_studio.render.panes import Layout
from qmd_studio.render.scene import Actor
from qmd_studio.tuning.joint_heat import heat_of, joint_errors
from qmd_studio.ui.background import Tell
from qmd_studio.ui.view import LAYOUTS, View
from qmd_studio.ui.viewport import Viewport

_SMOOTH_FPS = 60.0
"""Motions of fewer frames a second are played with poses in between."""

DEFAULT_RANGE_MM = 1.0
_GREY, _FAINT = (0.45, 0.47, 0.5), 0.3
"""What is left of A where only the difference is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class Take:
    """What a side that is encoded plays, made when first looked at, and how far off it is: (n_frames, n_points) mm."""

    decoded: Callable[[], Motion]
    distance_mm: Float32Array


class Stage(QObject):
    """Poses the bodies and hands them to the viewport whenever clip, side, view, heat or frame changes."""

    def __init__(self, viewport: Viewport, playhead: Playhead, parent: QObject) -> None:
        super().__init__(parent)
        self._viewport, self._playhead = viewport, playhead
        self._clip: Clip | None = None
        self._takes: dict[Side, Take] = {}
        self._difference: Float32Array | None = None
        self._view = View.A
        self._heated, self._range_mm = False, DEFAULT_RANGE_MM
        self._follows = True
        self._stands_at: FloatArray | None = None
        self._fit: Fit | None = None
        self._default: list[Actor] = []
        self.kinematics: Callable[[Skeleton, FloatArray], FloatArray] = world_from_joint
        """What poses the bodies: NumPy until the compiled path is warm, which takes longer than the first picture."""
        playhead.moved.connect(self._pose)
        playhead.glided.connect(self._pose)
        playhead.state_changed.connect(self._pose)  # at rest a frame is shown as it is

    @property
    def view(self) -> View:
        """How the two sides are shown, where side B is known."""
        return self._view

    @view.setter
    def view(self, view: View) -> None:
        self._view = view
        self._pose()

    @property
    def shown_view(self) -> View:
        """How the sides are shown now: only A as long as B is not known."""
        return self._view if Side.B in self._takes else View.A

    @property
    def heated(self) -> bool:
        """Whether the error of its joints is painted on a body that is encoded."""
        return self._heated

    @heated.setter
    def heated(self, heated: bool) -> None:
        self._heated = heated
        self._pose()

    @property
    def range_mm(self) -> float:
        """The error at the hot end of the scale, in mm."""
        return self._range_mm

    @range_mm.setter
    def range_mm(self, range_mm: float) -> None:
        self._range_mm = range_mm
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
        """Whether it is known what side B, the QMD file, plays."""
        return Side.B in self._takes

    def show_clip(self, clip: Clip | None) -> None:
        """Show `clip`, or the default body; what was decoded of another motion goes."""
        before, self._clip = self._clip, clip
        if clip is None or before is None or clip.key != before.key:
            self._stands_at = None  # another body: the camera is framed anew, not carried there
        if clip is None or before is None or clip.motion is not before.motion:
            self._takes, self._difference = {}, None
        if clip is None or before is None or (clip.motion, clip.outfit) != (before.motion, before.outfit):
            self._fit, ground = standing_of(clip) if clip is not None else (None, 0.0)
            self._viewport.set_ground_height(ground)
        self._pose()

    def show_side(self, side: Side, take: Take | None) -> None:
        """Take over what `side` plays of the shown clip; None where it is the original or not known."""
        self._takes.pop(side, None)
        if take is not None and self._clip is not None:
            self._takes[side] = take
        self._pose()

    def show_difference(self, distance_mm: Float32Array | None) -> None:
        """Take over how far B is from A, (n_frames, n_points) mm; None if unknown."""
        self._difference = distance_mm if self._clip is not None else None
        self._pose()

    def show_default_body(self) -> None:
        """Let the default body stand, from now on, wherever nothing is open."""
        self._default = [default_actor()]
        self._pose()

    def joint_of_clip(self, joint: int) -> int:
        """Return the joint of the shown clip that moves `joint` of its body, -1 for none."""
        return int(self._fit.moved_by[joint]) if self._fit is not None and joint >= 0 else -1

    def joint_of_body(self, joint: int) -> int:
        """Return the joint of the shown clip's body on which `joint` of the clip is seen, -1 for none."""
        return int(self._fit.shown_by[joint]) if self._fit is not None and joint >= 0 else -1

    def _pose(self, _index: int = 0) -> None:
        if self._clip is None:
            self._viewport.set_layout(Layout.ONE)
            self._viewport.set_actors(self._default)
            return
        view = self.shown_view
        actors = [self._actor(side, view, self._clip) for side in view.sides]
        self._viewport.set_layout(LAYOUTS.get(view, Layout.ONE))
        self._viewport.set_actors(actors)
        self._carry_camera(actors[0].world_from_joint[0, :3, 3])

    def _actor(self, side: Side, view: View, clip: Clip) -> Actor:
        """Return the body of `side` in its pose, painted as `view` has it."""
        take, worn = self._takes.get(side), self._fit
        assert worn is not None
        motion = clip.motion if take is None else take.decoded()
        row = self._row(motion)
        world = worn.pose(self.kinematics(motion.skeleton, row[None]))[0]
        actor = Actor(worn.body, world, world_from_figure=worn.world_from_figure, morphs=morphs(worn.body, motion, row))
        if view is View.DIFFERENCE and side is Side.A:
            return replace(actor, tint=_GREY, alpha=_FAINT, ghost=True)
        if view is View.DIFFERENCE:
            return replace(actor, heat=self._heat(self._difference), only_hot=True)
        heat = self._heat(take.distance_mm) if take is not None and self._heated else None
        return replace(actor, ghost=view is View.GHOST and side is Side.B, heat=heat)

    def _heat(self, distance_mm: Float32Array | None) -> FloatArray | None:
        if distance_mm is None or self._clip is None:
            return None
        frame = min(self._playhead.index, len(distance_mm) - 1)
        errors = joint_errors(self._clip.motion.skeleton, distance_mm, frame)
        return heat_of(self._fit.on_body(errors) if self._fit is not None else errors, self._range_mm)

    def _carry_camera(self, root: FloatArray) -> None:
        before, self._stands_at = self._stands_at, root.copy()
        if self._follows and before is not None:
            moved = root - before
            moved[1] = 0.0  # a jump is seen as one
            self._viewport.carry_camera(moved)

    def _row(self, motion: Motion) -> FloatArray:
        """The pose (n_columns,) at the playhead, between two frames where it is."""
        index = min(self._playhead.index, motion.n_frames - 1)
        row, share = motion.X[index], self._playhead.share
        if share > 0.0 and index + 1 < motion.n_frames and motion.fps < _SMOOTH_FPS:
            row = in_between(motion.skeleton, row, motion.X[index + 1], share)
        return np.asarray(row)


def standing_of(clip: Clip) -> tuple[Fit, float]:
    """Return how the clip's body follows it, and the height of the ground under it, metres."""
    return _standing(clip.motion, clip.outfit)


@lru_cache(maxsize=1)
def default_actor() -> Actor:
    """Return the default body, standing at ease: made once, on whatever thread first asks, for it takes a while."""
    from qmd_studio.motion.bap import bap_skeleton
    from qmd_studio.motion.bap_ease import at_ease
    from qmd_studio.registry import default_body

    motion, body = Motion(bap_skeleton(), at_ease()[None], 30.0), default_body()
    worn = fit_bones(motion) if body is None else fit(motion, body)
    return Actor(worn.body, worn.pose(world_from_joint(motion.skeleton, motion.X))[0])


def prepare_furnishing(_stop: Event, _tell: Tell) -> None:
    """Import and make what furnishes the window, as far as this can be done beside it."""
    import qmd_studio.ui.furnishing  # noqa: F401

    default_actor()


def prepare(clip: Clip) -> None:
    """Make and remember all that showing `clip` needs, on whatever thread this is called: it may take a while."""
    standing_of(clip)


@lru_cache(maxsize=16)
def _standing(motion: Motion, outfit: Outfit) -> tuple[Fit, float]:
    if outfit.avatar is None:
        worn = fit_bones(motion)
    else:
        worn = fit(motion, outfit.avatar, joint_map=outfit.joint_map, reference=outfit.reference(motion))
    return worn, ground_height(motion, worn)
