"""Joints as dots and bones as lines over the picture, for bodies that are seen through."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from OpenGL import GL

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.render.camera import Camera
from qmd_studio.render.frame import Frame
from qmd_studio.render.gl import Program, layout_vertices
from qmd_studio.render.scene import Actor, Look

_DOT_SHARE, _BONE_SHARE = 0.085, 0.045
"""The radii of a joint and of a bone's thick end, as shares of the bone's length."""
_DOT_PIXELS, _BONE_PIXELS = (1.7, 4.6), (0.9, 2.7)
"""The least and the greatest that they have in logical pixels."""
_THIN = 0.45
_SLACK_PIXELS = 2.5
_ROW = 12
_GHOST = (0.30, 0.58, 1.0)


class BoneMarks:
    """Draws the joints and bones of the actors that are seen through."""

    def __init__(self) -> None:
        self._programs = {False: Program("bones.vert", "bones.frag"), True: Program("bones.vert", "bones.frag", PICK=1)}
        self._array: int = GL.glGenVertexArrays(1)
        self._buffer: int = GL.glGenBuffers(1)
        GL.glBindVertexArray(self._array)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffer)
        layout_vertices(4 * (_ROW + 2), (0, 2, 0), (1, 4, 8), (2, 2, 24), (3, 4, 32), (4, 2, 48))
        GL.glBindVertexArray(0)

    def draw(self, frame: Frame, pixel_ratio: float) -> None:
        """Draw over the picture as it is; blending of premultiplied colours must be on."""
        rows = self._rows(frame, pixel_ratio)
        if len(rows):
            dark = frame.scene.dark
            program = self._programs[False]
            program.use()
            program.set(
                size=frame.size,
                window_from_clip=np.eye(4),
                outline=(0.05, 0.06, 0.08, 0.75) if dark else (1.0, 1.0, 1.0, 0.85),
                outline_width=1.1 * pixel_ratio,
            )
            self._draw(rows)

    def draw_ids(self, frame: Frame, window_from_clip: FloatArray, pixel_ratio: float) -> None:
        """Draw the numbers of actors and joints, each plus one, into a picture that holds a part of the frame's."""
        rows = self._rows(frame, pixel_ratio)
        if len(rows):
            program = self._programs[True]
            program.use()
            program.set(size=frame.size, window_from_clip=window_from_clip, slack=_SLACK_PIXELS * pixel_ratio)
            self._draw(rows)

    def release(self) -> None:
        """Give everything back to the driver."""
        for program in self._programs.values():
            program.release()
        GL.glDeleteVertexArrays(1, [self._array])
        GL.glDeleteBuffers(1, [self._buffer])

    def _rows(self, frame: Frame, pixel_ratio: float) -> FloatArray:
        shown = [number for number, actor in enumerate(frame.scene.actors) if actor.look is Look.XRAY]
        parts = [_marks_of(frame, number, pixel_ratio) for number in shown]
        return _quads(np.concatenate(parts), 4.0 * pixel_ratio) if parts else np.zeros((0, _ROW + 2))

    def _draw(self, rows: FloatArray) -> None:
        data = np.ascontiguousarray(rows, dtype=np.float32)
        GL.glBindVertexArray(self._array)
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffer)
        GL.glBufferData(GL.GL_ARRAY_BUFFER, data.nbytes, data, GL.GL_STREAM_DRAW)
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, len(data))


def bone_ends(actor: Actor) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return where the bones start and end (n, 3), metres, and the joint (n,) that each turns with.

    A bone goes from a joint to a child of it, or to an end site.
    """
    carrier, child, site_joint, site_offset = _bones(actor.body.skeleton)
    world = np.asarray(actor.world_from_joint, dtype=np.float64)
    tips = np.einsum("nij,nj->ni", world[site_joint, :3, :3], site_offset) + world[site_joint, :3, 3]
    at = world[:, :3, 3]
    ends = np.concatenate([at[child], tips])
    joints = np.concatenate([carrier, site_joint])
    return at[joints], ends, joints


@lru_cache(maxsize=16)
def _bones(skeleton: Skeleton) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    children = [i for i, joint in enumerate(skeleton.joints) if joint.parent >= 0]
    carrier = np.array([skeleton.joints[i].parent for i in children], dtype=np.intp)
    sites = skeleton.end_sites
    offsets = np.array([site.offset for site in sites], dtype=np.float64).reshape(-1, 3)
    return carrier, np.array(children, dtype=np.intp), np.array([s.joint for s in sites], dtype=np.intp), offsets


def _marks_of(frame: Frame, number: int, pixel_ratio: float) -> FloatArray:
    """One actor's bones, then its joints, the farthest first: rows of line 4, radii 2, tint 4, actor, joint."""
    actor = frame.scene.actors[number]
    start, end, carrier = bone_ends(actor)
    length = np.linalg.norm(end - start, axis=1)
    reach = np.zeros(len(actor.body.skeleton.joints))
    np.maximum.at(reach, carrier, length)
    at = actor.joint_positions()
    thick = _radii(frame, start, length * _BONE_SHARE, np.array(_BONE_PIXELS) * pixel_ratio)
    dots = _radii(frame, at, reach * _DOT_SHARE, np.array(_DOT_PIXELS) * pixel_ratio)
    strong = [mark[1] for mark in (frame.scene.selected, frame.scene.hovered) if mark is not None and mark[0] == number]
    tints = np.tile([*_tint(frame, actor), 1.0], (len(at), 1))
    tints[strong, :3] = frame.theme.joint_mark
    dots[strong] *= 1.4
    bones = _rows_of(frame, (start, end), np.stack([thick, thick * _THIN], axis=1), tints[carrier])
    joints = _rows_of(frame, (at, at), np.stack([dots, dots], axis=1), tints)
    who = [np.column_stack([np.full(len(j), number), j]) for j in (carrier, np.arange(len(at)))]
    rows = [
        np.concatenate([part, names], axis=1)[_seen_order(frame, places)]
        for part, names, places in ((bones, who[0], (start + end) / 2), (joints, who[1], at))
    ]
    rows = [part[np.isfinite(part).all(axis=1)] for part in rows]
    return np.concatenate(rows)


def _tint(frame: Frame, actor: Actor) -> tuple[float, float, float]:
    return _GHOST if actor.ghost else frame.theme.bone


def _rows_of(frame: Frame, ends: tuple[FloatArray, FloatArray], radii: FloatArray, tints: FloatArray) -> FloatArray:
    lines = [_pixels(frame.camera, places, frame.size) for places in ends]
    return np.concatenate([*lines, radii, tints], axis=1)


def _pixels(camera: Camera, places: FloatArray, size: tuple[int, int]) -> FloatArray:
    """Where places (n, 3) are in the picture, pixels from its lower left corner; NaN behind the eye."""
    return np.asarray((camera.project(places, size[0] / size[1]) + 1) / 2 * size)


def _radii(frame: Frame, places: FloatArray, metres: FloatArray, limits: FloatArray) -> FloatArray:
    camera = frame.camera
    depth = (camera.eye - places) @ camera.backward
    nearness = 1.0 if camera.orthographic else camera.distance / np.maximum(depth, 1e-3)
    return np.asarray(np.clip(metres * nearness * frame.size[1] / 2 / camera.half_height, *limits))


def _seen_order(frame: Frame, places: FloatArray) -> IntArray:
    return np.argsort(places @ frame.camera.backward, kind="stable")


def _quads(marks: FloatArray, room: float) -> FloatArray:
    """Two triangles about each mark, (6 n, 2 + 12): the corner, then the mark."""
    start, end, radii = marks[:, :2], marks[:, 2:4], marks[:, 4:6].max(axis=1, keepdims=True) + room
    along = end - start
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 1e-6, along / np.maximum(length, 1e-6), [1.0, 0.0]) * radii
    side = np.stack([-along[:, 1], along[:, 0]], axis=1)
    a, b, c, d = start - along - side, end + along - side, end + along + side, start - along + side
    corners = np.stack([a, b, c, a, c, d], axis=1)
    return np.concatenate([corners, np.repeat(marks[:, None], 6, axis=1)], axis=2).reshape(-1, _ROW + 2)
