"""The camera of the viewport: orbit, pan, zoom, frame and view presets, as values. World is +Y up, metres."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from qmd_studio.arrays import FloatArray

HALF_TURN = math.pi
PITCH_LIMIT = math.radians(89.9)
_GLIDE_S = 0.07
MIN_DISTANCE, MAX_DISTANCE = 0.02, 2_000.0
PRESETS = MappingProxyType(
    {
        "front": (0.0, 0.0),
        "back": (HALF_TURN, 0.0),
        "left": (HALF_TURN / 2, 0.0),
        "right": (-HALF_TURN / 2, 0.0),
        "side": (HALF_TURN / 2, 0.0),
        "top": (0.0, PITCH_LIMIT),
        "bottom": (0.0, -PITCH_LIMIT),
        "three-quarter": (math.radians(32.0), math.radians(9.0)),
    }
)
"""Yaw and pitch in radians by name. A figure faces +Z, so that "front" looks along -Z; "side" shows its left side."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera that looks at `target` (metres) from `distance`, turned by `yaw` about +Y, then raised by `pitch`.

    Angles are in radians; yaw 0 looks along -Z. `fov` is the vertical field of view. An orthographic camera shows at
    its target what the perspective one would.
    """

    target: tuple[float, float, float] = (0.0, 0.95, 0.0)
    distance: float = 4.2
    yaw: float = PRESETS["three-quarter"][0]
    pitch: float = PRESETS["three-quarter"][1]
    fov: float = math.radians(32.0)
    orthographic: bool = False

    @property
    def backward(self) -> FloatArray:
        """The unit vector from the target to the eye."""
        level = math.cos(self.pitch)
        return np.array([level * math.sin(self.yaw), math.sin(self.pitch), level * math.cos(self.yaw)])

    @property
    def right(self) -> FloatArray:
        """The unit vector to the right of the picture."""
        return np.array([math.cos(self.yaw), 0.0, -math.sin(self.yaw)])

    @property
    def up(self) -> FloatArray:
        """The unit vector to the top of the picture."""
        return np.cross(self.backward, self.right)

    @property
    def eye(self) -> FloatArray:
        """The eye's position, metres."""
        return np.array(self.target) + self.distance * self.backward

    @property
    def half_height(self) -> float:
        """Half the height of the picture at the target, metres."""
        return self.distance * math.tan(self.fov / 2)

    def orbit(self, right: float, up: float) -> Camera:
        """Return the camera after a drag of the scene by radians to the right and up of the picture."""
        pitch = max(-PITCH_LIMIT, min(PITCH_LIMIT, self.pitch - up))
        return replace(self, yaw=math.remainder(self.yaw - right, math.tau), pitch=pitch)

    def pan(self, right: float, up: float) -> Camera:
        """Return the camera after a drag of the scene by fractions of the picture's height."""
        moved = np.array(self.target) - 2 * self.half_height * (right * self.right + up * self.up)
        return replace(self, target=_vector(moved))

    def carried(self, moved: ArrayLike) -> Camera:
        """Return the camera moved by `moved` (3,) metres of the world, what it looks at with it."""
        return replace(self, target=_vector(np.array(self.target) + np.asarray(moved)))

    def zoom(self, factor: float, anchor: tuple[float, float] = (0.0, 0.0)) -> Camera:
        """Return the camera `factor` times as near, what lies under `anchor` staying under it.

        `anchor` is in half heights of the picture from its centre, to the right and up.
        """
        distance = max(MIN_DISTANCE, min(MAX_DISTANCE, self.distance / factor))
        shift = self.half_height * (1.0 - distance / self.distance)
        target = np.array(self.target) + shift * (anchor[0] * self.right + anchor[1] * self.up)
        return replace(self, distance=distance, target=_vector(target))

    def preset(self, name: str) -> Camera:
        """Return the camera turned to one of `PRESETS`; raises `KeyError` for another name."""
        yaw, pitch = PRESETS[name]
        return replace(self, yaw=yaw, pitch=pitch)

    def frame(self, points: ArrayLike, aspect: float, margin: float = 1.12) -> Camera:
        """Return the camera moved so that all `points` (n, 3) are in the picture, turned as it is.

        `aspect` is width by height; without a finite point the camera stays.
        """
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return self
        axes = np.stack([self.right, self.up, self.backward])
        seen = points @ axes.T
        centre = (seen.min(axis=0) + seen.max(axis=0)) / 2
        offset = np.abs(seen - centre)
        tangent = math.tan(self.fov / 2) / margin
        across = np.maximum(offset[:, 1], offset[:, 0] / aspect) / tangent
        depth = 0.0 if self.orthographic else np.maximum(seen[:, 2] - centre[2], 0.0)
        distance = float(np.clip(np.max(across + depth), 0.15, MAX_DISTANCE))
        return replace(self, target=_vector(centre @ axes), distance=distance)

    def towards(self, goal: Camera, fraction: float) -> Camera:
        """Return the camera `fraction` (0 to 1) of the way to `goal`, the short way round."""
        if fraction >= 1.0:
            return goal
        target = np.array(self.target) + fraction * (np.array(goal.target) - np.array(self.target))
        yaw = self.yaw + fraction * math.remainder(goal.yaw - self.yaw, math.tau)
        return replace(
            goal,
            target=_vector(target),
            distance=self.distance * (goal.distance / self.distance) ** fraction,
            yaw=math.remainder(yaw, math.tau),
            pitch=self.pitch + fraction * (goal.pitch - self.pitch),
        )

    def glided(self, goal: Camera, passed_s: float) -> Camera:
        """Return the camera after a while of its soft glide to `goal`, which it reaches before a pixel is missing."""
        return goal if self.is_near(goal) else self.towards(goal, 1.0 - math.exp(-passed_s / _GLIDE_S))

    def is_near(self, goal: Camera) -> bool:
        """Whether `goal` would give the same picture to within a fraction of a pixel."""
        turned = abs(math.remainder(goal.yaw - self.yaw, math.tau)) + abs(goal.pitch - self.pitch)
        moved = float(np.linalg.norm(np.subtract(goal.target, self.target))) / self.half_height
        return turned + moved + abs(math.log(goal.distance / self.distance)) < 1e-3

    def view(self) -> FloatArray:
        """Return camera_from_world (4, 4); the camera looks along its own -Z."""
        matrix = np.eye(4)
        matrix[:3, :3] = np.stack([self.right, self.up, self.backward])
        matrix[:3, 3] = -matrix[:3, :3] @ self.eye
        return matrix

    def clip_planes(self, scene_radius: float) -> tuple[float, float]:
        """Return near and far in metres for a scene of `scene_radius` about the target."""
        reach = max(scene_radius, self.half_height)
        if self.orthographic:
            return -20.0 * reach - self.distance, 20.0 * reach + self.distance
        return max(self.distance / 200.0, 0.005), self.distance + 30.0 * reach

    def projection(self, aspect: float, scene_radius: float = 5.0) -> FloatArray:
        """Return clip_from_camera (4, 4) in OpenGL's convention."""
        near, far = self.clip_planes(scene_radius)
        matrix = np.zeros((4, 4))
        if self.orthographic:
            matrix[0, 0] = 1.0 / (self.half_height * aspect)
            matrix[1, 1] = 1.0 / self.half_height
            matrix[2, 2] = -2.0 / (far - near)
            matrix[2, 3] = -(far + near) / (far - near)
            matrix[3, 3] = 1.0
        else:
            focal = 1.0 / math.tan(self.fov / 2)
            matrix[0, 0], matrix[1, 1] = focal / aspect, focal
            matrix[2, 2] = -(far + near) / (far - near)
            matrix[2, 3] = -2.0 * far * near / (far - near)
            matrix[3, 2] = -1.0
        return matrix

    def ray(self, x: float, y: float, aspect: float) -> tuple[FloatArray, FloatArray]:
        """Return the origin and unit direction of the sight through a place in the picture (-1 to 1, right and up)."""
        across = self.half_height * (x * aspect * self.right + y * self.up)
        if self.orthographic:
            return np.array(self.target) + across + self.distance * self.backward, -self.backward
        direction = across - self.distance * self.backward
        return self.eye, direction / np.linalg.norm(direction)

    def project(self, points: ArrayLike, aspect: float) -> FloatArray:
        """Return where `points` (n, 3) are in the picture (n, 2), -1 to 1 right and up; NaN behind the eye."""
        seen = (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.eye) @ self.view()[:3, :3].T
        depth = np.full(len(seen), self.distance) if self.orthographic else -seen[:, 2]
        depth = np.where(depth > 0, depth, np.nan)
        scale = 1.0 / (depth * math.tan(self.fov / 2))
        return np.stack([seen[:, 0] * scale / aspect, seen[:, 1] * scale], axis=1)


def _vector(values: FloatArray) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))
