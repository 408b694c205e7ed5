"""The viewport: shows the actors through an orbiting camera, and tells which joint is clicked."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtOpenGLWidgets import QOpenGLWidget
from PySide6.QtWidgets import QWidget

from qmd_studio.errors import QmdStudioError
from qmd_studio.render.camera import Camera
from qmd_studio.render.overlay import TRIAD_INSET, TRIAD_RADIUS, triad_preset
from qmd_studio.render.panes import Layout, Pane, pane_at, panes_of
from qmd_studio.render.picking import Hit, pick
from qmd_studio.render.quality import Quality, QualityController
from qmd_studio.render.renderer import Renderer
from qmd_studio.render.scene import Actor, Look, Scene, limb_points
from qmd_studio.ui.viewport_format import viewport_format
from qmd_studio.ui.viewport_hover import Hover
from qmd_studio.ui.viewport_keys import Drag, drag_of, dragged, verb_of
from qmd_studio.ui.viewport_words import paint_words

_STILL_AFTER_MS = 220
_CLICK_PIXELS = 4


class Viewport(QOpenGLWidget):
    """Draws a scene and moves its camera by mouse and keys.

    Orbit by middle drag, Alt + left drag, or left drag; pan with Shift as well or by Alt + middle drag; zoom by wheel,
    Ctrl + middle drag or Alt + right drag. A click picks a joint.
    """

    joint_picked = Signal(int)
    """The joint clicked, -1 for none; `picked_actor` says whose."""
    camera_changed = Signal()
    failed = Signal(str)
    """The 3-D view cannot draw; the message says why and what to do."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFormat(viewport_format())
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setMinimumSize(160, 120)
        self.setAccessibleName(self.tr("Viewport"))
        self.animated = True
        self.fixed_quality: Quality | None = None
        self.picked_actor = 0
        self._renderer: Renderer | None = None
        self._quality: QualityController | None = None
        self._failure: str | None = None
        self._scene = Scene()
        self._camera = self._goal = Camera()
        self._framed_once = False
        self._message: str | None = None
        self._layout, self._split = Layout.ONE, 0.5
        self._drag: Drag | None = None
        self._pressed = self._last = QPointF()
        self._last_paint = 0.0
        self._still = False
        self._still_timer = QTimer(self, singleShot=True, interval=_STILL_AFTER_MS)
        self._still_timer.timeout.connect(self._draw_still)
        self.hover = Hover(self)
        self._look = Look.SOLID

    @property
    def camera(self) -> Camera:
        """The camera that the view shows, or glides to."""
        return self._goal

    @property
    def scene(self) -> Scene:
        """What is shown."""
        return self._scene

    @property
    def failure(self) -> str | None:
        """Why the view cannot draw, or None."""
        return self._failure

    def set_actors(self, actors: Sequence[Actor]) -> None:
        """Show these actors; the first that ever come are framed."""
        self._scene = self._scene.with_actors(self._in_look(actors))
        self.hover.wait()
        if actors and not self._framed_once:
            self._framed_once = True
            self._frame(self._scene.points(), glide=False)
        self._changed()

    @property
    def layout_of_sides(self) -> Layout:
        """How the picture is shared by the first two actors."""
        return self._layout

    @property
    def split(self) -> float:
        """Where the line of a wipe stands, from 0 at the left to 1."""
        return self._split

    @property
    def panes(self) -> tuple[Pane, ...]:
        """What is drawn where, left to right."""
        return panes_of(self._scene, self._layout, self._split)

    def set_layout(self, layout: Layout, split: float | None = None) -> None:
        """Share the picture between the first two actors; a wipe's line goes to `split`, a share of the width."""
        split = self._split if split is None else min(max(split, 0.0), 1.0)
        if (layout, split) != (self._layout, self._split):
            self._layout, self._split = layout, split
            self._changed()

    def set_theme(self, dark: bool) -> None:
        """Draw the stage for a dark or a light window."""
        self._scene = replace(self._scene, dark=dark)
        self._changed()

    def set_overlays(self, *, ground: bool | None = None, axes: bool | None = None) -> None:
        """Show or hide the ground and the axes."""
        shown = {"show_ground": ground, "show_axes": axes}
        self._scene = replace(self._scene, **{name: value for name, value in shown.items() if value is not None})
        self._changed()

    def set_ground_height(self, height_m: float) -> None:
        """Lay the ground at this height."""
        self._scene = replace(self._scene, ground_y=height_m)
        self._changed()

    @property
    def look(self) -> Look:
        """How the bodies' surfaces are shown."""
        return self._look

    def set_look(self, look: Look) -> None:
        """Show the bodies' surfaces in another way."""
        if look is not self._look:
            self._look = look
            self._scene = replace(self._scene, actors=self._in_look(self._scene.actors))
            self._changed()

    def _in_look(self, actors: Sequence[Actor]) -> tuple[Actor, ...]:
        return tuple(actor if actor.look is self._look else replace(actor, look=self._look) for actor in actors)

    def set_hovered(self, hovered: tuple[int, int] | None) -> None:
        """Show faintly that the mouse is on a joint of an actor."""
        if hovered != self._scene.hovered:
            self._scene = replace(self._scene, hovered=hovered)
            self._changed()

    def set_message(self, text: str | None) -> None:
        """Show `text` over the picture; None shows the invitation to drop a file while the stage is empty."""
        self._message = text
        self._changed()

    def select_joint(self, joint: int, actor: int = 0) -> None:
        """Highlight a joint; -1 for none."""
        self._scene = replace(self._scene, selected=(actor, joint) if joint >= 0 else None)
        self._changed()

    def frame_all(self) -> None:
        """Move the camera so that every actor is in the picture."""
        points = self._scene.points()
        if len(points):
            self._frame(points)
        else:
            self._go(Camera(yaw=self._goal.yaw, pitch=self._goal.pitch, orthographic=self._goal.orthographic))

    def frame_selection(self) -> None:
        """Move the camera to the selected joint and what hangs from it; to all where none is selected."""
        if self._scene.selected is None:
            self.frame_all()
        else:
            number, joint = self._scene.selected
            self._frame(limb_points(self._scene.actors[number], joint))

    def view_preset(self, name: str) -> None:
        """Turn the camera to one of the presets of `qmd_studio.render.camera`, such as "front"."""
        self._go(self._goal.preset(name))

    def toggle_orthographic(self) -> None:
        """Change between perspective and parallel projection."""
        self._go(replace(self._goal, orthographic=not self._goal.orthographic))

    def set_camera(self, camera: Camera) -> None:
        """Show the scene through `camera` at once."""
        self._camera = self._goal = camera
        self._changed()
        self.camera_changed.emit()

    def carry_camera(self, moved: np.ndarray) -> None:
        """Move the camera along with the actors that were just set, by `moved` (3,) metres."""
        self._camera, self._goal = self._camera.carried(moved), self._goal.carried(moved)

    def finish(self) -> None:
        """Draw at once what the view would show at rest: camera arrived, best quality. For pictures."""
        self._camera = self._goal
        self._still_timer.stop()
        self._draw_still()
        self.repaint()

    # Drawing

    def initializeGL(self) -> None:
        """Make the renderer in the context that Qt has just made, the first or another after a loss."""
        self._renderer = None
        self.context().aboutToBeDestroyed.connect(self._release, Qt.ConnectionType.DirectConnection)
        try:
            self._renderer = Renderer()
        except QmdStudioError as error:
            self._fail(str(error))
            return
        self._failure = None
        self._quality = QualityController(time.perf_counter, software=self._renderer.software)

    def paintGL(self) -> None:
        """Draw the scene, then words over it."""
        if self._renderer is not None and self._quality is not None:
            self._advance()
            try:
                self._draw(self._renderer, self._quality)
            except QmdStudioError as error:
                self._fail(str(error))
        self._draw_words()

    def _draw(self, renderer: Renderer, controller: QualityController) -> None:
        ratio, size = self._pixels()
        controller.begin()
        renderer.draw_panes(
            self.panes,
            self._camera,
            size,
            framebuffer=self.defaultFramebufferObject(),
            quality=self.fixed_quality or (controller.still if self._still else controller.quality),
            pixel_ratio=ratio,
        )
        renderer.wait()
        if not self._still:
            controller.end()
            self._still_timer.start()

    def _pixels(self) -> tuple[float, tuple[int, int]]:
        """The pixels to a logical one, and the picture's size in them."""
        ratio = self.devicePixelRatioF()
        return ratio, (round(self.width() * ratio), round(self.height() * ratio))

    def _advance(self) -> None:
        now = time.perf_counter()
        passed, self._last_paint = min(now - self._last_paint, 0.1), now
        self._camera = self._camera.glided(self._goal, passed) if self.animated else self._goal
        if self._camera != self._goal:
            QTimer.singleShot(0, self.update)

    def _draw_words(self) -> None:
        text = self._failure or self._message
        if text is None and not self._scene.actors:
            text = self.tr("Drop a BVH, AMC, BAP, X3D or QMD file here")
        if text is not None:
            paint_words(self, text, dark=self._scene.dark, covering=self._failure is not None)
        if self._failure is None:
            self.hover.paint(dark=self._scene.dark)

    def _draw_still(self) -> None:
        if self._camera == self._goal:
            self._still = True
            self.update()

    def _changed(self) -> None:
        self._still = False
        self.update()

    def _fail(self, message: str) -> None:
        self._failure = message
        self._renderer = None
        self.failed.emit(message)

    def _release(self) -> None:
        if self._renderer is not None:
            self.makeCurrent()
            self._renderer.release()
            self._renderer = None
            self.doneCurrent()

    # The camera

    def _go(self, camera: Camera) -> None:
        self._goal = camera
        if not self.animated:
            self._camera = camera
        self._changed()
        self.camera_changed.emit()

    def _frame(self, points: np.ndarray, *, glide: bool = True) -> None:
        self._go(self._goal.frame(points, self._aspect()))
        if not glide:
            self._camera = self._goal

    def _aspect(self) -> float:
        return self.panes[0].width * max(self.width(), 1) / max(self.height(), 1)

    def _place(self, at: QPointF) -> tuple[float, float]:
        pane = self._pane_at(at)
        across = (at.x() / max(self.width(), 1) - pane.window[0]) / pane.width
        return 2 * across - 1, 1 - 2 * at.y() / max(self.height(), 1)

    def _pane_at(self, at: QPointF) -> Pane:
        return pane_at(self.panes, at.x() / max(self.width(), 1))

    # The mouse and the keys

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._pressed = self._last = event.position()
        self._drag = drag_of(event.button(), event.modifiers())
        self.hover.leave()
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        at = event.position()
        if self._drag is None:
            self._last = at
            self.hover.move(at)
            return
        moved = (at - self._last) / max(self.height(), 1)
        self._last = at
        if self._drag is Drag.ORBIT and self._was_click(at):
            return
        self._camera = dragged(self._goal, self._drag, moved)  # a drag follows the hand without delay
        self._go(self._camera)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        clicked = self._drag is not None and event.button() == Qt.MouseButton.LeftButton
        self._drag = None
        if clicked and self._was_click(event.position()):
            self._click(event.position())

    def wheelEvent(self, event: QWheelEvent) -> None:
        steps = event.angleDelta().y() / 120.0
        if steps == 0 or event.modifiers() & Qt.KeyboardModifier.AltModifier:
            event.ignore()  # Alt and the wheel scrub the timeline
            return
        x, y = self._place(event.position())
        self._go(self._goal.zoom(1.18**steps, (x * self._aspect(), y)))
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        verb = verb_of(event)
        framing = {"frame_all": self.frame_all, "frame_selection": self.frame_selection}
        doing = framing | {"orthographic": self.toggle_orthographic}
        if verb is None:
            super().keyPressEvent(event)
        elif verb in doing:
            doing[verb]()
        else:
            self.view_preset(verb)

    def leaveEvent(self, event: QEvent) -> None:
        self.hover.leave()
        super().leaveEvent(event)

    def _was_click(self, at: QPointF) -> bool:
        return (at - self._pressed).manhattanLength() < _CLICK_PIXELS

    def _click(self, at: QPointF) -> None:
        preset = self.preset_at(at)
        if preset is not None:
            self.view_preset(preset)
            return
        hit = self.hit(at)
        self.picked_actor = hit.actor if hit else 0
        self.select_joint(hit.joint if hit else -1, self.picked_actor)
        self.joint_picked.emit(hit.joint if hit else -1)

    def hit(self, at: QPointF) -> Hit | None:
        """Return what is seen at a place of the widget, or None."""
        if self._renderer is not None:
            ratio, size = self._pixels()
            self.makeCurrent()
            try:
                place = (at.x() * ratio, at.y() * ratio)
                return self._renderer.pick(self.panes, self._camera, size, place, pixel_ratio=ratio)
            except QmdStudioError:
                pass  # what cannot be drawn as numbers is worked out
            finally:
                self.doneCurrent()
        pane = self._pane_at(at)
        hit = pick(pane.scene, *self._camera.ray(*self._place(at), self._aspect()))
        return hit and replace(hit, actor=hit.actor + pane.first_actor)

    def preset_at(self, at: QPointF) -> str | None:
        """Return the view preset that a click on the axes in the corner turns to, None beside them."""
        if not self._scene.show_axes:
            return None
        right = (at.x() - (self.width() - TRIAD_INSET)) / TRIAD_RADIUS
        up = (TRIAD_INSET - at.y()) / TRIAD_RADIUS
        return triad_preset(self._camera, right, up)
