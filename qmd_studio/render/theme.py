"""The colours and lights of the stage, for light and dark windows. Linear for light, sRGB for backdrop and lines."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.render.scene import Colour


@dataclass(frozen=True, slots=True)
class StageTheme:
    """How the stage looks: backdrop and lines in sRGB 0 to 1, lights in linear units."""

    top: Colour
    bottom: Colour
    glow: Colour
    line: Colour
    line_strength: float
    axis_x: Colour
    axis_y: Colour
    axis_z: Colour
    shadow_strength: float
    sky_light: Colour
    ground_light: Colour
    key_light: Colour
    fill_light: Colour
    rim_light: Colour
    accent: Colour
    bone: Colour
    joint_mark: Colour
    wire: Colour
    sun_strength: float


LIGHT = StageTheme(
    top=(0.86, 0.885, 0.915),
    bottom=(0.775, 0.79, 0.81),
    glow=(0.07, 0.065, 0.06),
    line=(0.36, 0.40, 0.45),
    line_strength=0.46,
    axis_x=(0.80, 0.25, 0.27),
    axis_y=(0.33, 0.62, 0.20),
    axis_z=(0.20, 0.43, 0.83),
    shadow_strength=0.42,
    sky_light=(0.56, 0.60, 0.66),
    ground_light=(0.25, 0.235, 0.22),
    key_light=(0.92, 0.86, 0.78),
    fill_light=(0.13, 0.16, 0.21),
    rim_light=(0.16, 0.18, 0.21),
    accent=(1.0, 0.36, 0.04),
    bone=(0.13, 0.22, 0.36),
    joint_mark=(0.93, 0.38, 0.05),
    wire=(0.12, 0.17, 0.25),
    sun_strength=0.22,
)
DARK = StageTheme(
    top=(0.105, 0.115, 0.135),
    bottom=(0.155, 0.165, 0.185),
    glow=(0.085, 0.09, 0.10),
    line=(0.60, 0.65, 0.72),
    line_strength=0.30,
    axis_x=(0.88, 0.33, 0.35),
    axis_y=(0.50, 0.76, 0.30),
    axis_z=(0.33, 0.56, 0.95),
    shadow_strength=0.55,
    sky_light=(0.36, 0.40, 0.46),
    ground_light=(0.12, 0.115, 0.115),
    key_light=(0.88, 0.82, 0.74),
    fill_light=(0.10, 0.14, 0.22),
    rim_light=(0.30, 0.35, 0.42),
    accent=(1.0, 0.36, 0.04),
    bone=(0.84, 0.90, 0.98),
    joint_mark=(1.0, 0.56, 0.20),
    wire=(0.05, 0.06, 0.08),
    sun_strength=0.42,
)
