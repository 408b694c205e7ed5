"""X3D figures (H-Anim, ISO/IEC 19774): skeleton, segments and skin of a humanoid, in the XML encoding.

A thin reader: joint centres, the meshes of segments, the skin, and the pose in which the figure stands. Animation in
the file (HAnimMotion, interpolators, HAnimPose) is left alone.
"""

from __future__ import annotations

import re

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.length_unit import stature
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.formats.x3d_humanoid import Figure, find_figure, pose_of, skeleton_of
from qmd_studio.formats.x3d_mesh import surface_of
from qmd_studio.formats.x3d_scene import parse_scene
from qmd_studio.motion.motion import Motion

POSE_FPS = 30.0
"""The rate of the one frame that a figure without motion stands in."""

_SNIFF = re.compile(rb"<(?:!DOCTYPE\s+)?X3D\b")
_PLAUSIBLE_M = (0.3, 3.0)


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is X3D in XML."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<") and _SNIFF.search(head) is not None


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read the humanoid of an X3D file, with its body where it has meshes, and one frame: the pose it stands in.

    Raises `FormatError` naming the node and field.
    """
    scene = parse_scene(data)
    figure = find_figure(scene, options.metres_per_unit)
    skeleton = skeleton_of(figure)
    surface, notes = surface_of(scene, figure)
    body = None
    if surface is not None:
        body = Body(skeleton.name, skeleton, surface, _bind(figure))
    name = options.path.stem if options.path else ""
    motion = Motion(skeleton, pose_of(figure, skeleton), options.fps or POSE_FPS, name=name)
    height = stature(skeleton)
    if not _PLAUSIBLE_M[0] <= height <= _PLAUSIBLE_M[1]:
        notes += (f"the figure is {height:.2f} m tall in the file's metres; set the length unit if that is not meant",)
    return Loaded(skeleton, motion, body, warnings=tuple(figure.warnings), notes=notes)


def _bind(figure: Figure) -> FloatArray:
    """Return world_from_joint at rest (n_joints, 4, 4): frames parallel to the humanoid's, at the centres."""
    bind = np.tile(np.eye(4), (len(figure.centres), 1, 1))
    bind[:, :3, 3] = figure.centres
    return bind


FORMAT = Format(name="x3d", title="X3D figure", suffixes=(".x3d",), sniff=sniff, read=read)
