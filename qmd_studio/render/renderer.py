"""The renderer: draws a scene through a camera into a framebuffer with OpenGL 3.3. It knows no window system."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from OpenGL import GL

from qmd_studio.render.bodies import Bodies
from qmd_studio.render.bones import BoneMarks
from qmd_studio.render.camera import Camera
from qmd_studio.render.frame import Frame
from qmd_studio.render.gl import Program, is_software, renderer_name, require_version
from qmd_studio.render.id_buffer import IdBuffer, nearest, window_about
from qmd_studio.render.overlay import Overlay
from qmd_studio.render.panes import Pane, pane_at
from qmd_studio.render.picking import Hit
from qmd_studio.render.quality import LADDER, Quality
from qmd_studio.render.scene import Scene
from qmd_studio.render.shadow import shadow_map
from qmd_studio.render.sun import SunMap, sunlight_on
from qmd_studio.render.target import Target
from qmd_studio.render.texture import Texture
from qmd_studio.render.theme import StageTheme


class Renderer:
    """Owns the objects of one OpenGL context; make, use and release it while that context is current.

    Raises `GraphicsError` where the context is older than 3.3.
    """

    def __init__(self) -> None:
        require_version()
        self.name = renderer_name()
        self.software = is_software(self.name)
        self.max_samples = int(GL.glGetIntegerv(GL.GL_MAX_SAMPLES))
        self._bodies = Bodies()
        self._bones = BoneMarks()
        self._sky = Program("sky.vert", "sky.frag")
        self._grounds: dict[bool, Program] = {False: Program("ground.vert", "ground.frag")}
        self._overlay = Overlay()
        self._nothing: int = GL.glGenVertexArrays(1)
        self._shadow: Texture | None = None
        self._sun: SunMap | None = None
        self._ids: IdBuffer | None = None
        self._target: Target | None = None

    def draw(
        self,
        scene: Scene,
        camera: Camera,
        size: tuple[int, int],
        *,
        framebuffer: int = 0,
        quality: Quality = LADDER[2],
        pixel_ratio: float = 1.0,
    ) -> None:
        """Draw `scene` into `framebuffer` of `size` pixels; `pixel_ratio` is pixels to a logical one.

        Raises `FormatError` for an actor with more joints than the driver's uniform blocks hold.
        """
        panes = (Pane(scene),)
        self.draw_panes(panes, camera, size, framebuffer=framebuffer, quality=quality, pixel_ratio=pixel_ratio)

    def draw_panes(
        self,
        panes: Sequence[Pane],
        camera: Camera,
        size: tuple[int, int],
        *,
        framebuffer: int = 0,
        quality: Quality = LADDER[2],
        pixel_ratio: float = 1.0,
    ) -> None:
        """Draw `panes`, which together cover the picture, as `draw` does one scene; all through the one camera."""
        size = (max(size[0], 1), max(size[1], 1))
        target = self._target_for(size, quality)
        target.bind()
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glDepthMask(True)
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        GL.glEnable(GL.GL_MULTISAMPLE)
        GL.glDisable(GL.GL_CULL_FACE)
        for pane in panes:
            self._draw_scene(pane, camera, target, quality)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        target.show(framebuffer, size)
        for pane in panes:
            _look_at(pane, size)
            self._draw_marks(_frame(pane, camera, size), pixel_ratio, triad=pane is panes[-1])
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glViewport(0, 0, *size)
        GL.glBindVertexArray(0)
        GL.glUseProgram(0)

    def pick(
        self,
        panes: Sequence[Pane],
        camera: Camera,
        size: tuple[int, int],
        at: tuple[float, float],
        *,
        pixel_ratio: float = 1.0,
    ) -> Hit | None:
        """Return what `draw_panes` shows at a pixel `at`, from the left and from the top, or None.

        Only the few pixels around it are drawn, with numbers for colours; the joints and bones of a body that is seen
        through come before its skin. The framebuffer that was bound is bound no longer.
        """
        pane = pane_at(tuple(panes), at[0] / max(size[0], 1))
        frame = replace(_frame(pane, camera, size), sun=None)
        left = round(pane.window[0] * size[0])
        window = window_about((at[0] - left, size[1] - at[1]), frame.size)
        if self._ids is None:
            self._ids = IdBuffer()
        self._ids.begin()
        self._bodies.draw_ids(frame, window)
        GL.glDisable(GL.GL_DEPTH_TEST)
        self._bones.draw_ids(frame, window, pixel_ratio)
        numbers, depths = self._ids.read()
        GL.glUseProgram(0)
        place = nearest(numbers)
        if place is None:
            return None
        actor, joint = (int(number) - 1 for number in numbers[place])
        return Hit(actor + pane.first_actor, joint, _distance(frame, float(depths[place])))

    def _draw_scene(self, pane: Pane, camera: Camera, target: Target, quality: Quality) -> None:
        frame = replace(_frame(pane, camera, target.size), gloss=quality.gloss)
        if quality.shadow:
            frame = replace(frame, sun=sunlight_on(pane.scene.actors, quality.shadow))
        if frame.sun is not None:
            self._draw_sun(frame, quality.shadow)
            target.bind()
        _look_at(pane, target.size)
        if pane.scene.backdrop:
            self._draw_sky(frame.theme, frame.size[0] / frame.size[1])
        else:
            GL.glClearColor(0.0, 0.0, 0.0, 0.0)
            GL.glClear(GL.GL_COLOR_BUFFER_BIT)
        self._bodies.draw_solid(frame)
        if pane.scene.show_ground:
            self._draw_ground(frame)
        self._bodies.draw_translucent(frame)

    def wait(self) -> None:
        """Wait until the driver has drawn everything, so that a frame's time can be told."""
        GL.glFinish()

    def release(self) -> None:
        """Give everything back to the driver; the context must be current."""
        for program in (self._sky, *self._grounds.values()):
            program.release()
        for part in (self._bodies, self._bones, self._overlay):
            part.release()
        for extra in (self._shadow, self._sun, self._ids, self._target):
            if extra is not None:
                extra.release()
        GL.glDeleteVertexArrays(1, [self._nothing])

    def _target_for(self, size: tuple[int, int], quality: Quality) -> Target:
        samples = min(quality.samples, self.max_samples)
        scaled = (max(1, round(size[0] * quality.scale)), max(1, round(size[1] * quality.scale)))
        if self._target is None or (self._target.size, self._target.samples) != (scaled, samples):
            if self._target is not None:
                self._target.release()
            self._target = None
            self._target = Target(scaled, samples)
        return self._target

    def _draw_sun(self, frame: Frame, n_pixels: int) -> None:
        assert frame.sun is not None
        if self._sun is None or self._sun.n_pixels != n_pixels:
            if self._sun is not None:
                self._sun.release()
            self._sun = None
            self._sun = SunMap(n_pixels)
        self._sun.begin()
        self._bodies.draw_depth(frame.scene, frame.sun.sun_from_world)
        self._sun.end()

    def _draw_sky(self, theme: StageTheme, aspect: float) -> None:
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glDepthMask(False)
        self._sky.use()
        self._sky.set(top=theme.top, bottom=theme.bottom, glow=theme.glow, aspect=float(aspect))
        GL.glBindVertexArray(self._nothing)
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)

    def _draw_ground(self, frame: Frame) -> None:
        scene, camera, theme, sunny = frame.scene, frame.camera, frame.theme, frame.sun is not None
        shadow = shadow_map(scene.actors, scene.ground_y)
        if shadow is not None:
            if self._shadow is None:
                self._shadow = Texture(shadow.darkness)
            else:
                self._shadow.write(shadow.darkness)
            self._shadow.bind(1)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(False)
        GL.glEnable(GL.GL_BLEND)
        GL.glBlendFunc(GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
        spacing = 10.0 ** max(-1, round(math.log10(max(camera.half_height, 1e-3) / 1.2)))
        below = camera.eye[1] < scene.ground_y
        if sunny not in self._grounds:
            self._grounds[sunny] = Program("ground.vert", "ground.frag", SUN=1)
        program = self._grounds[sunny]
        program.use()
        program.set(
            clip_from_world=frame.clip_from_world,
            centre=(camera.target[0], scene.ground_y, camera.target[2]),
            reach=float(max(12.0 * camera.half_height, 14.0 * spacing)),
            spacing=float(spacing / 2),
            line_colour=theme.line,
            line_strength=theme.line_strength * (0.35 if below else 1.0),
            axis_x=theme.axis_x,
            axis_z=theme.axis_z,
            show_axes=float(scene.show_axes),
            shadow=1,
            shadow_window=shadow.window if shadow is not None else (0.0, 0.0, 0.0, 0.0),
            shadow_strength=theme.shadow_strength * (0.4 if below else 1.0),
        )
        if sunny:
            program.set(**frame.sun_uniforms(), sun_strength=theme.sun_strength * (0.4 if below else 1.0))
        GL.glBindVertexArray(self._nothing)
        GL.glDrawArrays(GL.GL_TRIANGLE_STRIP, 0, 4)

    def _draw_marks(self, frame: Frame, pixel_ratio: float, *, triad: bool) -> None:
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glEnable(GL.GL_BLEND)
        GL.glBlendFunc(GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
        scene, size = frame.scene, (frame.size[0] / pixel_ratio, frame.size[1] / pixel_ratio)
        self._bones.draw(frame, pixel_ratio)
        if scene.selected is not None and scene.selected[0] < len(scene.actors):
            actor, joint = scene.selected
            at = frame.camera.project(scene.actors[actor].joint_positions()[joint], size[0] / size[1])[0]
            if np.isfinite(at).all():
                self._overlay.ring((at + 1) / 2 * size, size, frame.theme.accent)
        if scene.show_axes and triad:
            self._overlay.triad(frame.camera, size, frame.theme)


def _frame(pane: Pane, camera: Camera, size: tuple[int, int]) -> Frame:
    """The pane's scene as it is drawn over the pane's window of a picture of `size` pixels."""
    left, right = (round(share * size[0]) for share in pane.window)
    window = (max(right - left, 1), max(size[1], 1))
    projection = camera.projection(window[0] / window[1], pane.scene.radius())
    return Frame(pane.scene, camera, window, projection @ camera.view())


def _look_at(pane: Pane, size: tuple[int, int]) -> None:
    """Draw over the pane's window of a picture of `size` pixels, where it is shown."""
    left, right = (round(share * size[0]) for share in pane.window)
    from_, to = (round(share * size[0]) for share in pane.shown)
    GL.glViewport(left, 0, max(right - left, 1), size[1])
    GL.glEnable(GL.GL_SCISSOR_TEST)
    GL.glScissor(from_, 0, max(to - from_, 0), size[1])


def _distance(frame: Frame, depth: float) -> float:
    """How far from the eye a depth (0 to 1) lies along the way that the camera looks, metres."""
    near, far = frame.camera.clip_planes(frame.scene.radius())
    if frame.camera.orthographic:
        return near + depth * (far - near)
    return near * far / (far - depth * (far - near))
