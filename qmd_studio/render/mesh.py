"""A body's surface and pose on the graphics card."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.avatar.humanoid import Displacer, Surface
from qmd_studio.avatar.skinning import displaced
from qmd_studio.render.gl import layout_vertices

MAX_GROUPS = 3
"""Vertices follow their joints in groups of four; of more than twelve the strongest twelve are followed."""
_SHAPE_LAYOUT = ((0, 3, 0), (1, 3, 12))
_SHAPE_STRIDE = 24


class Mesh:
    """The vertices and triangles of one surface: bindings uploaded once, the shape as displacers change it.

    `n_groups` is how many groups of four joints its vertices follow.
    """

    def __init__(self, surface: Surface, displacers: Sequence[Displacer] = ()) -> None:
        self._surface, self._displacers = surface, tuple(displacers)
        self._weights = np.zeros(len(self._displacers))
        self._moving = _moving_rows(surface, self._displacers)
        joints, weights = influences(surface)
        self.n_groups = joints.shape[1] // 4
        groups = [part[:, 4 * g : 4 * g + 4] for g in range(self.n_groups) for part in (joints, weights)]
        bindings = np.ascontiguousarray(np.concatenate([surface.colours, *groups], axis=1), dtype=np.float32)
        shape = np.ascontiguousarray(np.concatenate([surface.vertices, surface.normals], axis=1), dtype=np.float32)
        faces = np.ascontiguousarray(surface.faces, dtype=np.uint32)
        self.n_indices = int(faces.size)
        self._array: int = GL.glGenVertexArrays(1)
        self._buffers = [int(b) for b in GL.glGenBuffers(3)]
        GL.glBindVertexArray(self._array)
        _fill(GL.GL_ARRAY_BUFFER, self._buffers[0], shape)
        layout_vertices(_SHAPE_STRIDE, *_SHAPE_LAYOUT)
        _fill(GL.GL_ARRAY_BUFFER, self._buffers[1], bindings)
        layout_vertices(
            12 + 32 * self.n_groups, (2, 3, 0), *((3 + k, 4, 12 + 16 * k) for k in range(2 * self.n_groups))
        )
        _fill(GL.GL_ELEMENT_ARRAY_BUFFER, self._buffers[2], faces)
        GL.glBindVertexArray(0)

    def displace(self, weights: FloatArray) -> None:
        """Give the surface the shape of these weights of its displacers; only what can move is uploaded, if at all."""
        if self._moving is None or np.array_equal(weights, self._weights):
            return
        self._weights = np.array(weights, dtype=np.float64)
        first, last = self._moving
        vertices, normals = displaced(self._surface, self._displacers, self._weights)
        rows = np.concatenate([vertices[first:last], normals[first:last]], axis=1).astype(np.float32)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffers[0])
        GL.glBufferSubData(GL.GL_ARRAY_BUFFER, first * _SHAPE_STRIDE, rows.nbytes, rows)

    def draw(self) -> None:
        """Draw the triangles with the program in use."""
        GL.glBindVertexArray(self._array)
        GL.glDrawElements(GL.GL_TRIANGLES, self.n_indices, GL.GL_UNSIGNED_INT, None)

    def release(self) -> None:
        """Give the buffers back to the driver."""
        GL.glDeleteVertexArrays(1, [self._array])
        GL.glDeleteBuffers(len(self._buffers), self._buffers)


class UniformBlock:
    """A buffer of vec4 at a binding point, written anew for each actor."""

    def __init__(self, binding: int, n_rows: int) -> None:
        self.binding, self.n_rows = binding, n_rows
        self._buffer: int = GL.glGenBuffers(1)
        GL.glBindBuffer(GL.GL_UNIFORM_BUFFER, self._buffer)
        GL.glBufferData(GL.GL_UNIFORM_BUFFER, n_rows * 16, None, GL.GL_STREAM_DRAW)

    def write(self, rows: Any) -> None:
        """Write float32 rows (n, 4), n at most `n_rows`, and bind the block."""
        GL.glBindBuffer(GL.GL_UNIFORM_BUFFER, self._buffer)
        GL.glBufferData(GL.GL_UNIFORM_BUFFER, self.n_rows * 16, None, GL.GL_STREAM_DRAW)
        GL.glBufferSubData(GL.GL_UNIFORM_BUFFER, 0, rows.nbytes, rows)
        GL.glBindBufferBase(GL.GL_UNIFORM_BUFFER, self.binding, self._buffer)

    def release(self) -> None:
        """Give the buffer back to the driver."""
        GL.glDeleteBuffers(1, [self._buffer])


def influences(surface: Surface) -> tuple[Any, Float32Array]:
    """Return the joints and weights that are drawn, (V, 4 g) each, the strongest first; g is at most `MAX_GROUPS`.

    Weights that are left out beyond the strongest twelve are made up for by the others.
    """
    weights = surface.weights.astype(np.float64)
    order = np.argsort(-np.abs(weights), axis=1, kind="stable")
    n_used = int(np.count_nonzero(weights, axis=1).max(initial=1))
    n_groups = min(MAX_GROUPS, max(1, (n_used + 3) // 4))
    order = order[:, : 4 * n_groups]
    joints, kept = np.take_along_axis(surface.joints, order, axis=1), np.take_along_axis(weights, order, axis=1)
    if n_used > 4 * n_groups:
        lost, sums = weights.sum(axis=1) - kept.sum(axis=1), kept.sum(axis=1)
        cut = (np.abs(lost) > 1e-9) & (np.abs(sums) > 1e-9)
        kept[cut] *= (1.0 + lost[cut] / sums[cut])[:, None]
    room = ((0, 0), (0, 4 * n_groups - joints.shape[1]))
    return np.pad(np.where(kept != 0.0, joints, 0), room), np.pad(kept, room).astype(np.float32)


def mark_rows(colours: FloatArray, heat: FloatArray | None) -> Any:
    """Return each joint's colour (n, 3) and heat (n,), NaN for none, as the shader holds them: float32 (n, 4)."""
    rows = np.full((len(colours), 4), -1.0, dtype=np.float32)
    rows[:, :3] = colours
    if heat is not None:
        rows[: len(heat), 3] = np.where(np.isfinite(heat), np.clip(heat, 0.0, 1.0), -1.0)
    return rows


def _moving_rows(surface: Surface, displacers: Sequence[Displacer]) -> tuple[int, int] | None:
    """The first row and the one after the last that any displacer can change, its normal included; None for none."""
    if not displacers:
        return None
    moved = np.zeros(len(surface.vertices), dtype=bool)
    for displacer in displacers:
        moved[displacer.vertices] = True
    touched = surface.faces[moved[surface.faces].any(axis=1)]
    rows = np.concatenate([np.flatnonzero(moved), touched.ravel()])
    return (int(rows.min()), int(rows.max()) + 1) if len(rows) else None


def _fill(kind: Any, buffer: int, data: Any) -> None:
    GL.glBindBuffer(kind, buffer)
    GL.glBufferData(kind, data.nbytes, data, GL.GL_STATIC_DRAW)
