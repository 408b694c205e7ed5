"""Which drag and which verb the mouse buttons and keys mean in the viewport: Blender's scheme and Maya's together."""

from __future__ import annotations

import math
from enum import Enum, auto

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent

from qmd_studio.render.camera import Camera

_ORBIT_RADIANS = 2.6
"""How far a drag over the picture's whole height turns the camera."""


class Drag(Enum):
    """What a drag does to the camera."""

    ORBIT = auto()
    PAN = auto()
    ZOOM = auto()


def drag_of(button: Qt.MouseButton, modifiers: Qt.KeyboardModifier) -> Drag | None:
    """Return what a drag with `button` means, or None."""
    shift = bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
    ctrl = bool(modifiers & Qt.KeyboardModifier.ControlModifier)
    alt = bool(modifiers & Qt.KeyboardModifier.AltModifier)
    if button == Qt.MouseButton.LeftButton:
        return Drag.PAN if shift else Drag.ORBIT
    if button == Qt.MouseButton.MiddleButton:
        return Drag.PAN if shift or alt else Drag.ZOOM if ctrl else Drag.ORBIT
    if button == Qt.MouseButton.RightButton and alt:
        return Drag.ZOOM
    return None


def dragged(camera: Camera, drag: Drag, moved: QPointF) -> Camera:
    """Return the camera after a drag by `moved`, in heights of the picture, to the right and down."""
    if drag is Drag.ORBIT:
        return camera.orbit(moved.x() * _ORBIT_RADIANS, -moved.y() * _ORBIT_RADIANS)
    if drag is Drag.PAN:
        return camera.pan(moved.x(), -moved.y())
    return camera.zoom(math.exp(2.5 * (moved.x() - moved.y())))


def verb_of(event: QKeyEvent) -> str | None:
    """Return "frame_all", "frame_selection", "orthographic" or a view preset for a key, or None."""
    modifiers = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
    keypad = bool(event.modifiers() & Qt.KeyboardModifier.KeypadModifier)
    shift = modifiers == Qt.KeyboardModifier.ShiftModifier
    ctrl = modifiers == Qt.KeyboardModifier.ControlModifier
    if event.key() == Qt.Key.Key_F and (shift or not modifiers):
        return "frame_all" if shift else "frame_selection"
    if not (keypad or not modifiers or ctrl):
        return None
    if event.key() == Qt.Key.Key_5 and not ctrl:
        return "orthographic"
    if event.key() == Qt.Key.Key_Period and keypad:
        return "frame_selection"
    presets = {Qt.Key.Key_1: ("front", "back"), Qt.Key.Key_3: ("left", "right"), Qt.Key.Key_7: ("top", "bottom")}
    pair = presets.get(Qt.Key(event.key()))
    return pair[1 if ctrl else 0] if pair else None
