"""Draws the surfaces of bodies: solid or translucent, as colours, as depths for the sun, or as numbers for picking."""

from __future__ import annotations

from typing import Any

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import FormatError
from qmd_studio.render.frame import Frame
from qmd_studio.render.gl import Program, palette_rows
from qmd_studio.render.heat import heat_colours, linear
from qmd_studio.render.mesh import Mesh, UniformBlock, mark_rows
from qmd_studio.render.scene import GHOST_ALPHA, GHOST_GAP_M, GHOST_TINT, Actor, Look, Scene
from qmd_studio.render.segment_colours import segment_colours
from qmd_studio.render.sun import casts_shadow
from qmd_studio.render.texture import Texture

_MAX_JOINTS = 1024
_SPARE_MESHES = 4
_WIRE_HALF_WIDTH = 0.55


class Bodies:
    """Owns what the bodies are drawn with: shaders, the matrices of a pose, and a mesh for each surface."""

    def __init__(self) -> None:
        block = int(GL.glGetIntegerv(GL.GL_MAX_UNIFORM_BLOCK_SIZE))
        self.max_joints = min(_MAX_JOINTS, block // 48)
        self._palette, self._marks = UniformBlock(0, 3 * self.max_joints), UniformBlock(1, self.max_joints)
        self._programs: dict[tuple[str, ...], Program] = {}
        self._prepared: set[int] = set()
        self._meshes: dict[tuple[int, ...], tuple[Body, Mesh]] = {}
        self._heat = Texture(linear(heat_colours(np.linspace(0, 1, 256)))[None])

    def draw_solid(self, frame: Frame) -> None:
        """Draw the bodies that hide what is behind them."""
        self._begin(frame.scene)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(True)
        GL.glDisable(GL.GL_BLEND)
        for number, actor in enumerate(frame.scene.actors):
            if not is_translucent(actor):
                self._draw_lit(frame, number)

    def draw_translucent(self, frame: Frame) -> None:
        """Draw the others: depth first, so that each shows only its nearest skin; then colour.

        A ghost counts as a little farther away than it is, so that where it agrees with a solid body that one is seen,
        unspoiled and without speckles, and what shows of the ghost is the difference.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        for number, actor in enumerate(frame.scene.actors):
            if not is_translucent(actor):
                continue
            GL.glDepthMask(True)
            GL.glColorMask(False, False, False, False)
            self._lay_depth(frame, number)
            GL.glColorMask(True, True, True, True)
            GL.glDepthMask(False)
            GL.glEnable(GL.GL_BLEND)
            # The picture stays opaque: with its alpha below 1 Qt would take bright colours for more than full.
            GL.glBlendFuncSeparate(GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA, GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
            self._draw_lit(frame, number)
            GL.glDisable(GL.GL_BLEND)

    def draw_depth(self, scene: Scene, clip_from_world: FloatArray) -> None:
        """Draw the bodies that cast a shadow, as depths alone."""
        self._begin(scene)
        view = {"clip_from_world": clip_from_world, "window_from_clip": np.eye(4), "eye": np.zeros(3)}
        for number, actor in enumerate(scene.actors):
            if casts_shadow(actor):
                program, mesh = self._ready(scene, number, ("depth",), view | {"sight": -clip_from_world[2, :3]})
                program.set(nudge=0.0)
                mesh.draw()

    def draw_ids(self, frame: Frame, window_from_clip: FloatArray) -> None:
        """Draw numbers of actors and joints, each plus one, into a picture that holds a part of the frame's."""
        self._begin(frame.scene)
        view = frame.view_uniforms() | {"window_from_clip": window_from_clip}
        for number, actor in enumerate(frame.scene.actors):
            program, mesh = self._ready(frame.scene, number, ("id",), view)
            program.set(
                actor=number,
                n_joints=len(actor.body.skeleton.joints),
                only_hot=actor.only_hot,
                heated=actor.heat is not None,
                nudge=GHOST_GAP_M if actor.ghost else 0.0,
            )
            mesh.draw()

    def release(self) -> None:
        """Give everything back to the driver."""
        for _, mesh in self._meshes.values():
            mesh.release()
        for program in self._programs.values():
            program.release()
        self._meshes.clear()
        self._programs.clear()
        for thing in (self._palette, self._marks, self._heat):
            thing.release()

    def _begin(self, scene: Scene) -> None:
        """Start a pass over `scene`; drop the meshes of bodies that left it, but for a few that may come back."""
        self._prepared.clear()
        used = {_mesh_key(scene, number) for number in range(len(scene.actors))}
        spare = [key for key in self._meshes if key not in used]
        for key in spare[: max(0, len(spare) - _SPARE_MESHES)]:
            self._meshes.pop(key)[1].release()

    def _lay_depth(self, frame: Frame, number: int) -> None:
        actor = frame.scene.actors[number]
        if actor.only_hot:
            self._draw_lit(frame, number)  # which knows what is not seen at all
            return
        program, mesh = self._ready(frame.scene, number, ("depth",), frame.view_uniforms)
        program.set(nudge=GHOST_GAP_M if actor.ghost else 0.0)
        mesh.draw()

    def _draw_lit(self, frame: Frame, number: int) -> None:
        actor = frame.scene.actors[number]
        kind = ["lit", *(["GLOSS"] if frame.gloss else []), *(["SUN"] if frame.sun is not None else [])]
        if actor.look is Look.WIRE:
            kind.append("WIRE")
        program, mesh = self._ready(
            frame.scene, number, tuple(kind), lambda: frame.view_uniforms() | frame.light_uniforms()
        )
        self._heat.bind(0)
        program.set(**_paint(frame.scene, number))
        if actor.look is Look.WIRE:
            width, height = frame.size
            fine = max(1.0, height / 900.0)
            program.set(pixels=(width / 2, height / 2), wire=frame.theme.wire, wire_width=_WIRE_HALF_WIDTH * fine)
        mesh.draw()

    def _ready(self, scene: Scene, number: int, kind: tuple[str, ...], view: Any) -> tuple[Program, Mesh]:
        """Return the program for an actor, in use and told the actor's pose, and its mesh in its shape.

        `view` are the uniforms of the pass, or what makes them; they are set once for each program.
        """
        actor = scene.actors[number]
        n_joints = len(actor.body.skeleton.joints)
        if n_joints >= self.max_joints:
            raise FormatError(
                "the body has too many joints to draw", wanted=f"at most {self.max_joints - 1}", got=str(n_joints)
            )
        mesh = self._mesh(scene, number)
        program = self._program(kind, mesh.n_groups)
        program.use()
        if program.number not in self._prepared:
            self._prepared.add(program.number)
            program.set(**(view() if callable(view) else view))
        self._palette.write(palette_rows(actor.skin_matrices()))
        if actor.heat is not None or actor.look is Look.SEGMENTS:
            self._marks.write(mark_rows(segment_colours(actor.body), actor.heat))
        return program, mesh

    def _program(self, kind: tuple[str, ...], n_groups: int) -> Program:
        key = (*kind, str(n_groups))
        if key not in self._programs:
            shade = {"lit": "body.frag", "depth": "depth.frag", "id": "id.frag"}[kind[0]]
            sizes = {"ROWS": 3 * self.max_joints, "MARKS": self.max_joints, "GROUPS": n_groups}
            flags = dict.fromkeys(kind[1:], 1)
            geometry = "wire.geom" if "WIRE" in flags else None
            program = Program("body.vert", shade, geometry, **sizes, **flags)
            program.block("Palette", 0)
            program.block("Marks", 1)
            self._programs[key] = program
        return self._programs[key]

    def _mesh(self, scene: Scene, number: int) -> Mesh:
        key, body = _mesh_key(scene, number), scene.actors[number].body
        if key not in self._meshes:
            self._meshes[key] = (body, Mesh(body.surface, body.displacers))
        mesh = self._meshes[key][1]
        mesh.displace(scene.actors[number].displacer_weights())
        return mesh


def is_translucent(actor: Actor) -> bool:
    """Whether what is behind the actor may be seen through it."""
    return actor.ghost or actor.only_hot or actor.alpha < 1.0 or actor.look is Look.XRAY


def _paint(scene: Scene, number: int) -> dict[str, Any]:
    """The uniforms of one actor."""
    actor = scene.actors[number]
    tint = actor.tint if actor.tint is not None else GHOST_TINT if actor.ghost else None
    return {
        "tint": (*tint, 0.82) if tint is not None else (0.0, 0.0, 0.0, 0.0),
        "alpha": float(actor.alpha if not actor.ghost or actor.alpha < 1.0 else GHOST_ALPHA),
        "ghost": float(actor.ghost),
        "xray": float(actor.look is Look.XRAY),
        "segments": actor.look is Look.SEGMENTS,
        "nudge": GHOST_GAP_M if actor.ghost else 0.0,
        "heated": actor.heat is not None,
        "only_hot": float(actor.only_hot),
        "selected": _joint_of(scene.selected, number),
        "hovered": _joint_of(scene.hovered, number),
    }


def _joint_of(mark: tuple[int, int] | None, actor: int) -> int:
    return mark[1] if mark is not None and mark[0] == actor else -1


def _mesh_key(scene: Scene, number: int) -> tuple[int, ...]:
    """Bodies of one surface share a mesh, but where each may have a shape of its own."""
    body = scene.actors[number].body
    if not body.displacers:
        return (id(body.surface),)
    rank = sum(1 for actor in scene.actors[:number] if actor.body.surface is body.surface)
    return id(body.surface), id(body.displacers), rank
