"""What all that is drawn of one scene in one picture has to know: where it is seen from, and how it is lit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.render.camera import Camera
from qmd_studio.render.scene import Scene
from qmd_studio.render.sun import SUN_FROM, Sunlight
from qmd_studio.render.theme import DARK, LIGHT, StageTheme


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A scene through a camera, `size` in pixels of the picture that is drawn into. `gloss` is for highlights."""

    scene: Scene
    camera: Camera
    size: tuple[int, int]
    clip_from_world: FloatArray
    gloss: bool = False
    sun: Sunlight | None = None

    @property
    def theme(self) -> StageTheme:
        """The colours of the stage."""
        return DARK if self.scene.dark else LIGHT

    def view_uniforms(self) -> dict[str, Any]:
        """Return what the bodies' vertex shader asks of a whole frame."""
        return {
            "clip_from_world": self.clip_from_world,
            "window_from_clip": np.eye(4),
            "eye": self.camera.eye,
            "sight": -self.camera.backward if self.camera.orthographic else np.zeros(3),
        }

    def light_uniforms(self) -> dict[str, Any]:
        """Return what the bodies' fragment shader asks of a whole frame."""
        right = self.camera.right
        frame = np.stack([right, np.array([0.0, 1.0, 0.0]), np.cross(right, [0.0, 1.0, 0.0])], axis=1)
        theme = self.theme
        return {
            "key_from": _unit(frame @ (-0.50, 0.72, 0.62)),
            "fill_from": _unit(frame @ (0.85, 0.15, 0.45)),
            "sky_light": theme.sky_light,
            "ground_light": theme.ground_light,
            "key_light": theme.key_light,
            "fill_light": theme.fill_light,
            "rim_light": theme.rim_light,
            "accent": theme.accent,
            "ground_y": float(self.scene.ground_y),
            "heat_map": 0,
        } | (self.sun_uniforms() if self.sun is not None else {})

    def sun_uniforms(self) -> dict[str, Any]:
        """Return what shaders that know the sun ask."""
        assert self.sun is not None
        return {
            "sun_from": SUN_FROM,
            "sun_from_world": self.sun.sun_from_world,
            "sun_map": 2,
            "sun_reach": self.sun.pixel_m,
        }


def _unit(vector: FloatArray) -> FloatArray:
    return np.asarray(vector / np.linalg.norm(vector))
