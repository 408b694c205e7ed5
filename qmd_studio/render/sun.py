"""The sun's own picture of the bodies, by which the renderer knows what it does not reach: one soft shadow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.render.gl import GraphicsError
from qmd_studio.render.scene import Actor, Look

SUN_FROM = np.array([-0.42, 0.80, 0.44]) / np.linalg.norm([-0.42, 0.80, 0.44])
"""The direction to the sun, which stands still: before the figure, high on its right."""
_MARGIN = 0.14
"""How far skin may reach beyond its joints, as a share of the body's size."""


@dataclass(frozen=True, slots=True, eq=False)
class Sunlight:
    """How the sun sees the bodies: `sun_from_world` (4, 4) in OpenGL's clip space; `pixel_m` is a pixel of its map."""

    sun_from_world: FloatArray
    pixel_m: float


def casts_shadow(actor: Actor) -> bool:
    """Whether the actor is solid enough to take light away."""
    return not actor.ghost and not actor.only_hot and actor.alpha >= 1.0 and actor.look is not Look.XRAY


def sunlight_on(actors: Sequence[Actor], n_pixels: int) -> Sunlight | None:
    """Return how the sun sees those of the `actors` that cast a shadow, on a square of `n_pixels`; None for none."""
    clouds = []
    for actor in filter(casts_shadow, actors):
        joints = actor.joint_positions()
        reach = max(_MARGIN * float(np.linalg.norm(np.ptp(actor.body.bind[:, :3, 3], axis=0))), 0.08)
        clouds += [joints - reach, joints + reach]
    if not clouds or not np.isfinite(points := np.concatenate(clouds)).all():
        return None
    right = np.cross([0.0, 1.0, 0.0], SUN_FROM)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(SUN_FROM, right), SUN_FROM])
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    half = np.maximum((high - low) / 2, 0.05)
    half[:2] = half[:2].max()
    matrix = np.eye(4)
    matrix[:3, :3] = axes / half[:, None] * np.array([1.0, 1.0, -1.0])[:, None]
    matrix[:3, 3] = -matrix[:3, :3] @ (axes.T @ ((low + high) / 2))
    return Sunlight(matrix, float(2 * half[0] / n_pixels))


class SunMap:
    """A square picture of depths that shaders compare places with."""

    def __init__(self, n_pixels: int) -> None:
        self.n_pixels = n_pixels
        self._framebuffer: int = GL.glGenFramebuffers(1)
        self._texture: int = GL.glGenTextures(1)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)
        for name, value in (
            (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_BORDER),
            (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_BORDER),
            (GL.GL_TEXTURE_COMPARE_MODE, GL.GL_COMPARE_REF_TO_TEXTURE),
            (GL.GL_TEXTURE_COMPARE_FUNC, GL.GL_LEQUAL),
        ):
            GL.glTexParameteri(GL.GL_TEXTURE_2D, name, value)
        GL.glTexParameterfv(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_BORDER_COLOR, np.ones(4, dtype=np.float32))
        form, kind = GL.GL_DEPTH_COMPONENT, GL.GL_UNSIGNED_INT
        GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, GL.GL_DEPTH_COMPONENT24, n_pixels, n_pixels, 0, form, kind, None)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_TEXTURE_2D, self._texture, 0)
        GL.glDrawBuffer(GL.GL_NONE)
        GL.glReadBuffer(GL.GL_NONE)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            self.release()
            raise GraphicsError("the driver gives no map for shadows", got=f"{n_pixels} × {n_pixels}")

    def begin(self) -> None:
        """Draw into the map from now on, with a little distance against a surface that shades itself."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        GL.glViewport(0, 0, self.n_pixels, self.n_pixels)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(True)
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        GL.glEnable(GL.GL_POLYGON_OFFSET_FILL)
        GL.glPolygonOffset(2.0, 4.0)

    def end(self) -> None:
        """Let the map be read, as texture unit 2."""
        GL.glDisable(GL.GL_POLYGON_OFFSET_FILL)
        GL.glActiveTexture(GL.GL_TEXTURE0 + 2)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)

    def release(self) -> None:
        """Give the map back to the driver."""
        GL.glDeleteFramebuffers(1, [self._framebuffer])
        GL.glDeleteTextures([self._texture])
