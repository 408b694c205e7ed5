"""A body's surface and pose on the graphics card."""

from __future__ import annotations

from typing import Any

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Surface
from qmd_studio.render.gl import layout_vertices

_LAYOUT = ((0, 3, 0), (1, 3, 12), (2, 3, 24), (3, 4, 36), (4, 4, 52))
_STRIDE = 68


class Mesh:
    """The vertices and triangles of one surface, uploaded once."""

    def __init__(self, surface: Surface) -> None:
        parts = (surface.vertices, surface.normals, surface.colours, surface.joints, surface.weights)
        rows = np.ascontiguousarray(np.concatenate(parts, axis=1), dtype=np.float32)
        faces = np.ascontiguousarray(surface.faces, dtype=np.uint32)
        self.n_indices = int(faces.size)
        self._array: int = GL.glGenVertexArrays(1)
        self._buffers = [int(b) for b in GL.glGenBuffers(2)]
        GL.glBindVertexArray(self._array)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffers[0])
        GL.glBufferData(GL.GL_ARRAY_BUFFER, rows.nbytes, rows, GL.GL_STATIC_DRAW)
        GL.glBindBuffer(GL.GL_ELEMENT_ARRAY_BUFFER, self._buffers[1])
        GL.glBufferData(GL.GL_ELEMENT_ARRAY_BUFFER, faces.nbytes, faces, GL.GL_STATIC_DRAW)
        layout_vertices(_STRIDE, *_LAYOUT)
        GL.glBindVertexArray(0)

    def draw(self) -> None:
        """Draw the triangles with the program in use."""
        GL.glBindVertexArray(self._array)
        GL.glDrawElements(GL.GL_TRIANGLES, self.n_indices, GL.GL_UNSIGNED_INT, None)

    def release(self) -> None:
        """Give the buffers back to the driver."""
        GL.glDeleteVertexArrays(1, [self._array])
        GL.glDeleteBuffers(2, self._buffers)


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


def heat_rows(heat: FloatArray) -> Any:
    """Return the heat of each joint (n,), NaN for none, as the shader holds it: float32, four to a row, -1 for none."""
    rows = np.full((len(heat) + 3) // 4 * 4, -1.0, dtype=np.float32)
    rows[: len(heat)] = np.where(np.isfinite(heat), np.clip(heat, 0.0, 1.0), -1.0)
    return rows.reshape(-1, 4)
