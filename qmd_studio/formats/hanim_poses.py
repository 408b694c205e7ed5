"""The poses that a figure keeps (HAnimPose, X3D 4.1), as frames of a motion where the file has no other."""

from __future__ import annotations

import numpy as np

from qmd_studio.formats.hanim_figure import Figure
from qmd_studio.formats.hanim_motion import Track, joint_numbers
from qmd_studio.formats.hanim_view import View, axis_angle_matrix, kind_of, label, vector
from qmd_studio.formats.scene_graph import title
from qmd_studio.motion.hanim_names import canonical_joint

POSES_FPS, HELD = 5.0, 5
"""A pose stands for a second."""
MAX_POSES = 1000
_NO_TURN = (0.0, 0.0, 1.0, 0.0)


def read_poses(view: View, figure: Figure) -> Track | None:
    """Return the pose in which the figure stands and after it those that its file keeps; None where it keeps none.

    A pose's joints are found by name; joints that it leaves out stay as they stand.
    """
    nodes = view.every("HAnimPose")
    if not nodes:
        return None
    if len(nodes) > MAX_POSES:
        view.notes.append(f"the file has {len(nodes)} poses; the first {MAX_POSES} are opened")
    nodes = nodes[:MAX_POSES]
    track = Track(POSES_FPS, HELD * (1 + len(nodes)), name="poses")
    numbers = joint_numbers(figure)
    for place, node in enumerate(nodes, start=1):
        frames = slice(HELD * place, HELD * (place + 1))
        for _, child in view.children(node):
            joint = numbers.get(label(child), numbers.get(canonical_joint(label(child))))
            if kind_of(child) != "HAnimJoint" or joint is None:
                continue
            if joint not in track.turns:
                standing = axis_angle_matrix(vector(figure.joints[joint], "rotation", _NO_TURN))
                track.turns[joint] = np.tile(standing, (track.n_frames, 1, 1))
            track.turns[joint][frames] = axis_angle_matrix(vector(child, "rotation", _NO_TURN))
    names = ", ".join(label(node) or title(node) for node in nodes)
    view.notes.append(f"the file has no motion but poses, a second each after the one it stands in: {names}")
    return track
