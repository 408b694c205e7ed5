"""An OpenGL 3.3 context without a window, a screen or Qt, by EGL: on a graphics card where one may be used, else Mesa.

Numbers and rules are those of the EGL 1.5 specification and of the extensions EXT_device_enumeration,
EXT_platform_device, MESA_platform_surfaceless and KHR_surfaceless_context.
"""

from __future__ import annotations

import ctypes
import ctypes.util
from collections.abc import Iterator
from ctypes import POINTER, byref, c_char_p, c_int32, c_uint32, c_void_p
from typing import Any

from qmd_studio.render.gl import GraphicsError

INSTALL_HINT = (
    "Install EGL and OpenGL (Debian and Ubuntu: libegl1 libgl1 libegl-mesa0), "
    "or run the command on a virtual screen, such as xvfb-run"
)
_MAX_DEVICES = 16
_DEVICE, _SURFACELESS = 0x313F, 0x31DD
_OPENGL_API = 0x30A2
_NONE = 0x3038
_CONFIG = (0x3033, 0x0001, 0x3040, 0x0008, _NONE)  # a surface that is a pbuffer, drawn to by OpenGL
_CONTEXT = (0x3098, 3, 0x30FB, 3, 0x30FD, 1, _NONE)  # version 3.3, core profile
_PBUFFER = (0x3057, 16, 0x3056, 16, _NONE)  # what is drawn goes to framebuffers of the renderer's own


class EglContext:
    """A context of its own, made current at once; `close` gives it back. For one thread.

    Raises `GraphicsError` where the machine has no EGL, or none that can do OpenGL 3.3.
    """

    def __init__(self) -> None:
        self._egl = _library()
        self._display: c_void_p | None = None
        self._surface: c_void_p | None = None
        self._context: c_void_p | None = None
        for display in _displays(self._egl):
            if self._start(c_void_p(display)):
                break
        else:
            raise GraphicsError(
                "there is nothing to draw with out of sight", wanted="EGL with OpenGL 3.3", hint=INSTALL_HINT
            )

    def make_current(self) -> None:
        """Draw with this context from now on; raises `GraphicsError` where another one is still in use."""
        if not self._egl.eglMakeCurrent(self._display, self._surface, self._surface, self._context):
            raise GraphicsError("the off-screen context cannot be used", got=f"EGL error {self._egl.eglGetError():#x}")

    def done_current(self) -> None:
        """Leave the thread without a context."""
        self._egl.eglMakeCurrent(self._display, None, None, None)

    def close(self) -> None:
        """Give the context back to the driver; what was made in it is gone."""
        if self._context is not None:
            self.done_current()
            self._egl.eglDestroyContext(self._display, self._context)
            self._egl.eglDestroySurface(self._display, self._surface)
            self._context = None

    def _start(self, display: c_void_p) -> bool:
        """Make a context on `display` and make it current, if that goes."""
        egl = self._egl
        if not egl.eglInitialize(display, None, None) or not egl.eglBindAPI(_OPENGL_API):
            return False
        config, count = c_void_p(), c_int32()
        if not egl.eglChooseConfig(display, _ints(_CONFIG), byref(config), 1, byref(count)) or not count.value:
            return False
        surface = egl.eglCreatePbufferSurface(display, config, _ints(_PBUFFER))
        context = egl.eglCreateContext(display, config, None, _ints(_CONTEXT))
        if context and egl.eglMakeCurrent(display, surface, surface, context):
            self._display, self._surface, self._context = display, c_void_p(surface), c_void_p(context)
            return True
        if context:
            egl.eglDestroyContext(display, c_void_p(context))
        if surface:
            egl.eglDestroySurface(display, c_void_p(surface))
        return False


def _ints(values: tuple[int, ...]) -> Any:
    return (c_int32 * len(values))(*values)


def _library() -> Any:
    for name in ("libEGL.so.1", ctypes.util.find_library("EGL")):
        try:
            return _typed(ctypes.CDLL(name)) if name else None
        except (OSError, AttributeError):
            continue
    raise GraphicsError("there is nothing to draw with out of sight", wanted="EGL", hint=INSTALL_HINT)


def _typed(egl: Any) -> Any:
    """Declare what the functions take and return: a handle is as wide as a pointer."""
    handle, ints = c_void_p, POINTER(c_int32)
    for name, result, arguments in (
        ("eglGetProcAddress", handle, [c_char_p]),
        ("eglGetDisplay", handle, [handle]),
        ("eglInitialize", c_uint32, [handle, ints, ints]),
        ("eglBindAPI", c_uint32, [c_uint32]),
        ("eglChooseConfig", c_uint32, [handle, ints, POINTER(handle), c_int32, ints]),
        ("eglCreatePbufferSurface", handle, [handle, handle, ints]),
        ("eglCreateContext", handle, [handle, handle, handle, ints]),
        ("eglMakeCurrent", c_uint32, [handle, handle, handle, handle]),
        ("eglDestroyContext", c_uint32, [handle, handle]),
        ("eglDestroySurface", c_uint32, [handle, handle]),
        ("eglGetError", c_int32, []),
    ):
        function = getattr(egl, name)
        function.restype, function.argtypes = result, arguments
    return egl


def _displays(egl: Any) -> Iterator[int]:
    """Yield what may be drawn with, the best first: each device, Mesa without a device, whatever is the default."""
    platform_display = _extension(egl, b"eglGetPlatformDisplayEXT", c_void_p, [c_uint32, c_void_p, POINTER(c_int32)])
    if platform_display is not None:
        for device in _devices(egl):
            yield from _some(platform_display(_DEVICE, device, None))
        yield from _some(platform_display(_SURFACELESS, None, None))
    yield from _some(egl.eglGetDisplay(None))


def _devices(egl: Any) -> list[int | None]:
    query = _extension(egl, b"eglQueryDevicesEXT", c_uint32, [c_int32, POINTER(c_void_p), POINTER(c_int32)])
    found, count = (c_void_p * _MAX_DEVICES)(), c_int32()
    if query is None or not query(_MAX_DEVICES, found, byref(count)):
        return []
    return list(found[: count.value])


def _extension(egl: Any, name: bytes, result: Any, arguments: list[Any]) -> Any:
    address = egl.eglGetProcAddress(name)
    return ctypes.CFUNCTYPE(result, *arguments)(address) if address else None


def _some(display: int | None) -> Iterator[int]:
    if display:
        yield display
