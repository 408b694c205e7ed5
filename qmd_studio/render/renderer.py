"""The renderer: draws a scene through a camera into a framebuffer with OpenGL 3.3. It knows no window system."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Surface
from qmd_studio.errors import FormatError
from qmd_studio.render.camera import Camera
from qmd_studio.render.gl import Program, is_software, palette_rows, renderer_name, require_version
from qmd_studio.render.heat import heat_colours, linear
from qmd_studio.render.mesh import Mesh, UniformBlock, heat_rows
from qmd_studio.render.overlay import Overlay
from qmd_studio.render.panes import Pane
from qmd_studio.render.quality import LADDER, Quality
from qmd_studio.render.scene import GHOST_ALPHA, GHOST_GAP_M, GHOST_TINT, Actor, Scene
from qmd_studio.render.shadow import shadow_map
from qmd_studio.render.target import Target
from qmd_studio.render.texture import Texture
from qmd_studio.render.theme import DARK, LIGHT, StageTheme

_MAX_JOINTS = 1024


class Renderer:
    """Owns the objects of one OpenGL context; make, use and release it while that context is current.

    Raises `GraphicsError` where the context is older than 3.3.
    """

    def __init__(self) -> None:
        require_version()
        self.name = renderer_name()
        self.software = is_software(self.name)
        block = int(GL.glGetIntegerv(GL.GL_MAX_UNIFORM_BLOCK_SIZE))
        self.max_joints = min(_MAX_JOINTS, block // 48)
        self.max_samples = int(GL.glGetIntegerv(GL.GL_MAX_SAMPLES))
        sizes = {"ROWS": 3 * self.max_joints, "MARKS": (self.max_joints + 3) // 4}
        self._bodies = {
            False: Program("body.vert", "body.frag", **sizes),
            True: Program("body.vert", "body.frag", **sizes, GLOSS=1),
        }
        for program in self._bodies.values():
            program.block("Palette", 0)
            program.block("Marks", 1)
        self._palette = UniformBlock(0, sizes["ROWS"])
        self._marks = UniformBlock(1, sizes["MARKS"])
        self._sky = Program("sky.vert", "sky.frag")
        self._ground = Program("ground.vert", "ground.frag")
        self._overlay = Overlay()
        self._nothing: int = GL.glGenVertexArrays(1)
        self._meshes: dict[int, tuple[Surface, Mesh]] = {}
        self._heat = Texture(linear(heat_colours(np.linspace(0, 1, 256)))[None])
        self._shadow: Texture | None = None
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
        self._bind_target(size, quality)
        target = self._target
        assert target is not None
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glDepthMask(True)
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        GL.glEnable(GL.GL_MULTISAMPLE)
        GL.glDisable(GL.GL_CULL_FACE)
        for pane in panes:
            width = _look_at(pane, target.size)
            self._draw_scene(pane.scene, camera, width / target.size[1], gloss=quality.gloss)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        target.show(framebuffer, size)
        for pane in panes:
            width = _look_at(pane, size)
            self._draw_marks(pane.scene, camera, (width / pixel_ratio, size[1] / pixel_ratio), triad=pane is panes[-1])
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glViewport(0, 0, *size)
        GL.glBindVertexArray(0)
        GL.glUseProgram(0)

    def _draw_scene(self, scene: Scene, camera: Camera, aspect: float, *, gloss: bool) -> None:
        clip_from_world = camera.projection(aspect, scene.radius()) @ camera.view()
        if scene.backdrop:
            self._draw_sky(DARK if scene.dark else LIGHT, aspect)
        else:
            GL.glClearColor(0.0, 0.0, 0.0, 0.0)
            GL.glClear(GL.GL_COLOR_BUFFER_BIT)
        self._draw_actors(scene, camera, clip_from_world, gloss=gloss)
        if scene.show_ground:
            self._draw_ground(scene, camera, clip_from_world)
        self._draw_ghosts(scene, camera, clip_from_world, gloss=gloss)

    def wait(self) -> None:
        """Wait until the driver has drawn everything, so that a frame's time can be told."""
        GL.glFinish()

    def release(self) -> None:
        """Give everything back to the driver; the context must be current."""
        for _, mesh in self._meshes.values():
            mesh.release()
        self._meshes.clear()
        programs = [*self._bodies.values(), self._sky, self._ground]
        for thing in [*programs, self._palette, self._marks, self._overlay, self._heat, self._shadow, self._target]:
            if thing is not None:
                thing.release()
        GL.glDeleteVertexArrays(1, [self._nothing])

    def _bind_target(self, size: tuple[int, int], quality: Quality) -> None:
        samples = min(quality.samples, self.max_samples)
        scaled = (max(1, round(size[0] * quality.scale)), max(1, round(size[1] * quality.scale)))
        if self._target is None or (self._target.size, self._target.samples) != (scaled, samples):
            if self._target is not None:
                self._target.release()
            self._target = None
            self._target = Target(scaled, samples)
        self._target.bind()

    def _draw_sky(self, theme: StageTheme, aspect: float) -> None:
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glDepthMask(False)
        self._sky.use()
        self._sky.set(top=theme.top, bottom=theme.bottom, glow=theme.glow, aspect=float(aspect))
        GL.glBindVertexArray(self._nothing)
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)

    def _draw_ground(self, scene: Scene, camera: Camera, clip_from_world: FloatArray) -> None:
        theme = DARK if scene.dark else LIGHT
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
        self._ground.use()
        self._ground.set(
            clip_from_world=clip_from_world,
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
        GL.glBindVertexArray(self._nothing)
        GL.glDrawArrays(GL.GL_TRIANGLE_STRIP, 0, 4)

    def _draw_actors(self, scene: Scene, camera: Camera, clip_from_world: FloatArray, *, gloss: bool) -> None:
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(True)
        GL.glDisable(GL.GL_BLEND)
        program = self._lit_program(scene, camera, clip_from_world, gloss=gloss)
        for number, actor in enumerate(scene.actors):
            if not _is_translucent(actor):
                self._set_actor(program, scene, number)
                self._mesh(actor.body.surface).draw()
        self._forget_unused(scene)

    def _draw_ghosts(self, scene: Scene, camera: Camera, clip_from_world: FloatArray, *, gloss: bool) -> None:
        """Translucent bodies: depth first, so that each shows only its nearest skin; then colour.

        A ghost counts as a little farther away than it is, so that where it agrees with a solid body that one is seen,
        unspoiled and without speckles, and what shows of the ghost is the difference.
        """
        if not any(_is_translucent(actor) for actor in scene.actors):
            return
        program = self._lit_program(scene, camera, clip_from_world, gloss=gloss)
        GL.glEnable(GL.GL_DEPTH_TEST)
        for number, actor in enumerate(scene.actors):
            if not _is_translucent(actor):
                continue
            self._set_actor(program, scene, number)
            GL.glDepthMask(True)
            GL.glColorMask(False, False, False, False)
            self._mesh(actor.body.surface).draw()
            GL.glColorMask(True, True, True, True)
            GL.glDepthMask(False)
            GL.glEnable(GL.GL_BLEND)
            # The picture stays opaque: with its alpha below 1 Qt would take bright colours for more than full.
            GL.glBlendFuncSeparate(GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA, GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
            self._mesh(actor.body.surface).draw()
            GL.glDisable(GL.GL_BLEND)

    def _lit_program(self, scene: Scene, camera: Camera, clip_from_world: FloatArray, *, gloss: bool) -> Program:
        theme = DARK if scene.dark else LIGHT
        program = self._bodies[gloss]
        frame = np.stack([camera.right, np.array([0.0, 1.0, 0.0]), np.cross(camera.right, [0.0, 1.0, 0.0])], axis=1)
        program.use()
        self._heat.bind(0)
        program.set(
            clip_from_world=clip_from_world,
            eye=camera.eye,
            sight=-camera.backward if camera.orthographic else np.zeros(3),
            key_from=_unit(frame @ (-0.50, 0.72, 0.62)),
            fill_from=_unit(frame @ (0.85, 0.15, 0.45)),
            sky_light=theme.sky_light,
            ground_light=theme.ground_light,
            key_light=theme.key_light,
            fill_light=theme.fill_light,
            rim_light=theme.rim_light,
            accent=theme.accent,
            ground_y=float(scene.ground_y),
            heat_map=0,
        )
        return program

    def _set_actor(self, program: Program, scene: Scene, number: int) -> None:
        actor = scene.actors[number]
        n_joints = len(actor.body.skeleton.joints)
        if n_joints > self.max_joints:
            raise FormatError(
                "the body has too many joints to draw", wanted=f"at most {self.max_joints}", got=str(n_joints)
            )
        self._palette.write(palette_rows(actor.skin_matrices()))
        if actor.heat is not None:
            self._marks.write(heat_rows(actor.heat))
        tint = actor.tint if actor.tint is not None else GHOST_TINT if actor.ghost else None
        program.set(
            tint=(*tint, 0.82) if tint is not None else (0.0, 0.0, 0.0, 0.0),
            alpha=float(actor.alpha if not actor.ghost or actor.alpha < 1.0 else GHOST_ALPHA),
            ghost=float(actor.ghost),
            nudge=GHOST_GAP_M if actor.ghost else 0.0,
            heated=actor.heat is not None,
            only_hot=float(actor.only_hot),
            selected=_joint_of(scene.selected, number),
            hovered=_joint_of(scene.hovered, number),
        )

    def _draw_marks(self, scene: Scene, camera: Camera, size: tuple[float, float], *, triad: bool) -> None:
        theme = DARK if scene.dark else LIGHT
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glEnable(GL.GL_BLEND)
        GL.glBlendFunc(GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
        if scene.selected is not None and scene.selected[0] < len(scene.actors):
            actor, joint = scene.selected
            at = camera.project(scene.actors[actor].joint_positions()[joint], size[0] / size[1])[0]
            if np.isfinite(at).all():
                self._overlay.ring((at + 1) / 2 * size, size, theme.accent)
        if scene.show_axes and triad:
            self._overlay.triad(camera, size, theme)

    def _mesh(self, surface: Surface) -> Mesh:
        entry = self._meshes.get(id(surface))
        if entry is None:
            entry = self._meshes[id(surface)] = (surface, Mesh(surface))
        return entry[1]

    def _forget_unused(self, scene: Scene) -> None:
        """Drop the meshes of bodies that left the scene, but for a few that may come back."""
        used = {id(actor.body.surface) for actor in scene.actors}
        spare = [key for key in self._meshes if key not in used]
        for key in spare[: max(0, len(spare) - 4)]:
            self._meshes.pop(key)[1].release()


def _look_at(pane: Pane, size: tuple[int, int]) -> int:
    """Draw over the pane's window of a picture of `size` pixels, where it is shown; return the window's width."""
    left, right = (round(share * size[0]) for share in pane.window)
    from_, to = (round(share * size[0]) for share in pane.shown)
    GL.glViewport(left, 0, max(right - left, 1), size[1])
    GL.glEnable(GL.GL_SCISSOR_TEST)
    GL.glScissor(from_, 0, max(to - from_, 0), size[1])
    return max(right - left, 1)


def _is_translucent(actor: Actor) -> bool:
    return actor.ghost or actor.only_hot or actor.alpha < 1.0


def _joint_of(mark: tuple[int, int] | None, actor: int) -> int:
    return mark[1] if mark is not None and mark[0] == actor else -1


def _unit(vector: FloatArray) -> FloatArray:
    return np.asarray(vector / np.linalg.norm(vector))
