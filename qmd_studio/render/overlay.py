"""Marks over the picture: the triad of axes in the corner and the ring about a joint."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.render.camera import Camera
from qmd_studio.render.gl import Program, layout_vertices
from qmd_studio.render.scene import Colour
from qmd_studio.render.theme import StageTheme

TRIAD_RADIUS = 34.0
"""Half the size of the triad in logical pixels; it sits `TRIAD_INSET` from the top right corner."""
TRIAD_INSET = 54.0
_AXES = np.eye(3)
_PRESET_OF_AXIS = ("left", "top", "front", "right", "bottom", "back")


def triad_tips(camera: Camera) -> FloatArray:
    """Return where the tips of +X, +Y, +Z, -X, -Y, -Z stand, (6, 3): right, up, and towards the eye, from -1 to 1."""
    frame = np.stack([camera.right, camera.up, camera.backward])
    return np.concatenate([_AXES, -_AXES]) @ frame.T


def triad_preset(camera: Camera, right: float, up: float) -> str | None:
    """Return the view preset under a click `right` and `up` of the triad's centre in its radii, or None."""
    tips = triad_tips(camera)
    away = np.hypot(tips[:, 0] - right, tips[:, 1] - up)
    near = np.flatnonzero(away < 0.30)
    return _PRESET_OF_AXIS[near[np.argmax(tips[near, 2])]] if len(near) else None


class Overlay:
    """Draws flat coloured triangles given in pixels."""

    def __init__(self) -> None:
        self._program = Program("marks.vert", "marks.frag")
        self._array: int = GL.glGenVertexArrays(1)
        self._buffer: int = GL.glGenBuffers(1)
        GL.glBindVertexArray(self._array)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffer)
        layout_vertices(28, (0, 3, 0), (1, 4, 12))
        GL.glBindVertexArray(0)

    def triad(self, camera: Camera, size: tuple[float, float], theme: StageTheme) -> None:
        """Draw the axes in the top right corner of a picture of `size` logical pixels."""
        centre = np.array([size[0] - TRIAD_INSET, size[1] - TRIAD_INSET])
        tips = triad_tips(camera)
        rows = []
        for k in np.argsort(tips[:, 2]):
            colour = (theme.axis_x, theme.axis_y, theme.axis_z)[k % 3]
            at = centre + TRIAD_RADIUS * tips[k, :2]
            strength = 0.72 + 0.28 * (tips[k, 2] + 1) / 2
            if k < 3:
                rows += [_line(centre, at, 1.3, (*colour, strength)), _disc(at, 7.5, (*colour, strength))]
            else:
                rows.append(_disc(at, 4.5, (*colour, 0.42)))
        self._draw(np.concatenate(rows), size)

    def ring(self, at: FloatArray, size: tuple[float, float], colour: Colour) -> None:
        """Draw a ring about a place (2,) in logical pixels from the lower left corner."""
        rows = [_annulus(at, (5.2, 9.2), (0.0, 0.0, 0.0, 0.30)), _annulus(at, (6.0, 8.4), (*colour, 1.0))]
        self._draw(np.concatenate([*rows, _disc(at, 2.0, (*colour, 1.0))]), size)

    def _draw(self, rows: FloatArray, size: tuple[float, float]) -> None:
        data = np.ascontiguousarray(rows, dtype=np.float32)
        matrix = np.diag([2.0 / size[0], 2.0 / size[1], 1.0, 1.0])
        matrix[:2, 3] = -1.0
        self._program.use()
        self._program.set(clip_from_mark=matrix)
        GL.glBindVertexArray(self._array)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffer)
        GL.glBufferData(GL.GL_ARRAY_BUFFER, data.nbytes, data, GL.GL_STREAM_DRAW)
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, len(data))

    def release(self) -> None:
        """Give everything back to the driver."""
        self._program.release()
        GL.glDeleteVertexArrays(1, [self._array])
        GL.glDeleteBuffers(1, [self._buffer])


def _strip(inner: FloatArray, outer: FloatArray, paints: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Triangles (n, 7) between two closed rings of places (k, 2), each with its own paint (4,)."""
    rings = []
    for ring, paint in ((inner, paints[0]), (outer, paints[1])):
        rings.append(np.column_stack([ring, np.zeros(len(ring)), np.broadcast_to(paint, (len(ring), 4))]))
    a, b = rings
    c, d = np.roll(a, -1, axis=0), np.roll(b, -1, axis=0)
    return np.stack([a, b, d, a, d, c], axis=1).reshape(-1, 7)


def _annulus(at: FloatArray, radii: tuple[float, float], paint: tuple[float, ...]) -> FloatArray:
    """A ring with edges a pixel soft."""
    angle = np.linspace(0, math.tau, 40, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    full, none = np.array(paint), np.array([*paint[:3], 0.0])
    inside, outside = radii
    steps = [
        (max(inside - 0.5, 0.0), none),
        (inside + 0.5, full),
        (max(outside - 0.5, 0.0), full),
        (outside + 0.5, none),
    ]
    if inside <= 0:
        steps = [(0.0, full), *steps[2:]]
    parts = [_strip(at[:2] + r * circle, at[:2] + s * circle, (p, q)) for (r, p), (s, q) in pairwise(steps)]
    return np.concatenate(parts)


def _disc(at: FloatArray, radius: float, paint: tuple[float, ...]) -> FloatArray:
    return _annulus(at, (0.0, radius), paint)


def _line(start: FloatArray, end: FloatArray, half_width: float, paint: tuple[float, ...]) -> FloatArray:
    along = end - start
    length = float(np.hypot(*along))
    if length < 1e-6:
        return np.zeros((0, 7))
    side = np.array([-along[1], along[0]]) / length
    full, none = np.array(paint), np.array([*paint[:3], 0.0])
    offsets = [(-half_width - 0.5, none), (-half_width + 0.5, full), (half_width - 0.5, full), (half_width + 0.5, none)]
    rows = []
    for (o, p), (q, r) in pairwise(offsets):
        corners = [(start + o * side, p), (end + o * side, p), (end + q * side, r), (start + q * side, r)]
        points = [np.concatenate([place, [0.0], colour]) for place, colour in corners]
        rows += [points[0], points[1], points[2], points[0], points[2], points[3]]
    return np.stack(rows)
