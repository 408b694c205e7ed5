"""OpenGL as the renderer uses it: error checking off but for debugging, and programs made from shader files."""

from __future__ import annotations

import ctypes
import os
from typing import Any

import numpy as np
import OpenGL

from qmd_studio.arrays import FloatArray
from qmd_studio.assets import resource
from qmd_studio.errors import QmdStudioError

_DEBUG = bool(os.environ.get("QMD_GL_DEBUG"))
OpenGL.ERROR_CHECKING = _DEBUG  # a check after each of some hundred calls a frame costs more than the calls
OpenGL.ERROR_LOGGING = _DEBUG

from OpenGL import GL  # noqa: E402  the switches above work only before this
from OpenGL.raw.GL.VERSION.GL_2_0 import glVertexAttribPointer as _attribute  # noqa: E402

SOFTWARE_NAMES = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader", "gdi generic")


class GraphicsError(QmdStudioError):
    """The graphics driver cannot do what the viewport needs."""


def require_version() -> None:
    """Raise `GraphicsError` unless the current context has OpenGL 3.3."""
    text = GL.glGetString(GL.GL_VERSION)
    version = text.decode("ascii", "replace") if text else "no OpenGL"
    try:
        major, minor = (int(part) for part in version.split()[0].split(".")[:2])
    except ValueError:
        major, minor = 0, 0
    if (major, minor) < (3, 3):
        hint = "Update the graphics driver, or start with LIBGL_ALWAYS_SOFTWARE=1 to draw on the processor"
        raise GraphicsError("the 3-D view cannot start", wanted="OpenGL 3.3", got=version, hint=hint)


def renderer_name() -> str:
    """Return the name of what draws, such as "llvmpipe (LLVM 15.0.6, 256 bits)"."""
    text = GL.glGetString(GL.GL_RENDERER)
    return text.decode("utf-8", "replace") if text else "unknown"


def is_software(name: str) -> bool:
    """Whether `name` (GL_RENDERER) is a renderer that runs on the processor."""
    return any(word in name.lower() for word in SOFTWARE_NAMES)


class Program:
    """Linked shaders from resources/shaders, whose uniforms are set by name.

    `defines` are written after the first line of each; between vertex and fragment shader a `geometry` shader may
    stand. Raises `GraphicsError` with the driver's own words.
    """

    def __init__(self, vertex: str, fragment: str, geometry: str | None = None, **defines: int) -> None:
        lines = "".join(f"#define {name} {value}\n" for name, value in defines.items())
        self.number: int = GL.glCreateProgram()
        shaders = [_shader(GL.GL_VERTEX_SHADER, vertex, lines), _shader(GL.GL_FRAGMENT_SHADER, fragment, lines)]
        if geometry is not None:
            shaders.append(_shader(GL.GL_GEOMETRY_SHADER, geometry, lines))
        for shader in shaders:
            GL.glAttachShader(self.number, shader)
        GL.glLinkProgram(self.number)
        for shader in shaders:
            GL.glDetachShader(self.number, shader)
            GL.glDeleteShader(shader)
        if not GL.glGetProgramiv(self.number, GL.GL_LINK_STATUS):
            raise GraphicsError(f"{vertex} and {fragment} do not link", got=_log(GL.glGetProgramInfoLog(self.number)))
        self._places: dict[str, int] = {}

    def use(self) -> None:
        """Make this the program that draws."""
        GL.glUseProgram(self.number)

    def block(self, name: str, binding: int) -> None:
        """Tie the uniform block `name` to a binding point."""
        index = GL.glGetUniformBlockIndex(self.number, name)
        GL.glUniformBlockBinding(self.number, index, binding)

    def set(self, **values: Any) -> None:
        """Set uniforms of the program in use: a float, an int, a vector of 2 to 4, or a matrix (4, 4)."""
        for name, value in values.items():
            place = self._place(name)
            if isinstance(value, (bool, int)):
                GL.glUniform1i(place, int(value))
            elif isinstance(value, float):
                GL.glUniform1f(place, value)
            elif isinstance(value, np.ndarray) and value.shape == (4, 4):
                GL.glUniformMatrix4fv(place, 1, GL.GL_TRUE, np.ascontiguousarray(value, dtype=np.float32))
            else:
                (GL.glUniform2f, GL.glUniform3f, GL.glUniform4f)[len(value) - 2](place, *(float(v) for v in value))

    def release(self) -> None:
        """Give the program back to the driver."""
        GL.glDeleteProgram(self.number)

    def _place(self, name: str) -> int:
        if name not in self._places:
            self._places[name] = int(GL.glGetUniformLocation(self.number, name))
        return self._places[name]


def layout_vertices(stride: int, *attributes: tuple[int, int, int]) -> None:
    """Tell the bound arrays that vertices are `stride` bytes of floats: (location, number of floats, first byte).

    The raw call: PyOpenGL's own asks the window system for the context, which it guesses wrong where Qt uses another.
    """
    for location, n_values, start in attributes:
        GL.glEnableVertexAttribArray(location)
        _attribute(location, n_values, GL.GL_FLOAT, False, stride, ctypes.c_void_p(start))


def palette_rows(matrices: FloatArray) -> Any:
    """Return the upper three rows of (n, 4, 4) matrices, float32 (3 n, 4), as the shaders hold them."""
    return np.ascontiguousarray(matrices[:, :3, :], dtype=np.float32).reshape(-1, 4)


def _shader(kind: Any, name: str, defines: str) -> int:
    head, rest = resource("shaders", name).read_text(encoding="utf-8").split("\n", 1)
    shader: int = GL.glCreateShader(kind)
    GL.glShaderSource(shader, f"{head}\n{defines}{rest}")
    GL.glCompileShader(shader)
    if not GL.glGetShaderiv(shader, GL.GL_COMPILE_STATUS):
        raise GraphicsError(f"the shader {name} does not compile", got=_log(GL.glGetShaderInfoLog(shader)))
    return shader


def _log(text: bytes | str) -> str:
    return text.decode("utf-8", "replace").strip() if isinstance(text, bytes) else str(text).strip()
