"""The motion in a figure's file: HAnimMotion, interpolators with routes, or the one pose that the figure stands in."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_displacers import Found
from qmd_studio.formats.hanim_figure import Figure
from qmd_studio.formats.hanim_interpolators import Routed, quaternion_matrices, read_routes
from qmd_studio.formats.hanim_motion import Track, read_hanim_motion
from qmd_studio.formats.hanim_poses import read_poses
from qmd_studio.formats.hanim_skeleton import motion_values, skeleton_of
from qmd_studio.formats.hanim_view import (
    View,
    axis_angle_matrix,
    compose,
    kind_of,
    label,
    stretch_matrix,
    vector,
)
from qmd_studio.formats.scene_graph import title
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind

POSE_FPS = 30.0
"""The rate of the one frame that a figure without motion stands in."""
MAX_VALUES = 20_000_000
"""Longer motions are refused: frames of one joint ask for values of all."""
_NO_TURN = (0.0, 0.0, 1.0, 0.0)
_ORIGIN = (0.0, 0.0, 0.0)


@dataclass(slots=True)
class Animation:
    """The turns and moves of joints, where the humanoid itself goes (n_frames, 4, 4), and weights of displacers."""

    track: Track
    spaces: FloatArray | None = None
    weights: dict[str, FloatArray] = field(default_factory=dict)


def motion_of(view: View, figure: Figure, displacers: list[Found], fps: float | None) -> Motion:
    """Return the file's motion on the figure's skeleton, of one frame where nothing moves."""
    routed = read_routes(view, len(figure.joints))
    track = read_hanim_motion(view, figure)
    from_routes = track is None
    if track is None:
        track = Track(routed.fps, routed.n_frames)
    elif routed.channels:
        routed.fps, routed.n_frames = track.fps, track.n_frames
    animation = Animation(track)
    _take_routes(figure, routed, animation, displacers)
    if from_routes and not (track.turns or track.moves or animation.weights or animation.spaces is not None):
        track = animation.track = read_poses(view, figure) or Track(POSE_FPS, 1)
    _take_pose(figure, track)
    _say_what_is_left(view, figure, routed, displacers, posed=track.name == "poses")
    return _motion(figure, animation, displacers, fps)


def _motion(figure: Figure, animation: Animation, displacers: list[Found], fps: float | None) -> Motion:
    track = animation.track
    movers = {joint for joint, move in track.moves.items() if np.any(move)}
    weighed = [(found.name, found.joint) for found in displacers if found.name in animation.weights]
    skeleton = skeleton_of(figure, movers, weighed)
    n_frames, spaces = track.n_frames, animation.spaces
    if n_frames * max(skeleton.n_columns, 1) > MAX_VALUES:
        got = f"{n_frames} frames of {len(figure.joints)} joints"
        raise FormatError("the motion is too long", wanted=f"at most {MAX_VALUES} numbers", got=got)
    if spaces is not None and len(spaces) != n_frames:
        spaces = np.resize(spaces, (n_frames, 4, 4))
    X = motion_values(figure, skeleton, track.turns, track.moves, n_frames=n_frames, spaces=spaces)
    for number, column in enumerate(skeleton.columns):
        if column.kind is ColumnKind.OPAQUE:
            X[:, number] = animation.weights[column.name]
    return Motion(skeleton, X, fps or track.fps)


def _take_routes(figure: Figure, routed: Routed, animation: Animation, displacers: list[Found]) -> None:
    track = animation.track
    for joint, node in enumerate(figure.joints):
        turn, move = routed.sampled(node, "rotation"), routed.sampled(node, "translation")
        if turn is not None and turn.shape[1] == 4 and joint not in track.turns:
            track.turns[joint] = quaternion_matrices(turn)
        if move is not None and move.shape[1] == 3 and joint not in track.moves:
            track.moves[joint] = move
    animation.spaces = _spaces(figure, routed)
    for found in displacers:
        weight = routed.sampled(found.node, "weight")
        if weight is not None and weight.shape[1] == 1:
            animation.weights[found.name] = weight[:, 0]


def _spaces(figure: Figure, routed: Routed) -> FloatArray | None:
    """Return the humanoid's own way to metres in each frame, None where it stands."""
    humanoid = figure.humanoid
    turn, move = routed.sampled(humanoid, "rotation"), routed.sampled(humanoid, "translation")
    if turn is None and move is None:
        return None
    centre, still = vector(humanoid, "center", _ORIGIN), vector(humanoid, "translation", _ORIGIN)
    stretch = stretch_matrix(humanoid)
    own = axis_angle_matrix(vector(humanoid, "rotation", _NO_TURN))
    turns = own[None] if turn is None or turn.shape[1] != 4 else quaternion_matrices(turn)
    moves = still[None] if move is None or move.shape[1] != 3 else move
    first = compose(still, own @ stretch, centre)
    outer = figure.space @ np.linalg.inv(first)  # the unit of length alone
    linear = turns @ stretch
    result = np.tile(np.eye(4), (max(len(turns), len(moves)), 1, 1))
    result[:, :3, :3] = linear
    result[:, :3, 3] = moves + centre - linear @ centre
    return np.asarray(outer @ result)


def _take_pose(figure: Figure, track: Track) -> None:
    """Let the joints that nothing moves stand as their own fields say."""
    for joint, node in enumerate(figure.joints):
        if joint not in track.turns:
            turn = axis_angle_matrix(vector(node, "rotation", _NO_TURN))
            if not np.array_equal(turn, np.eye(3)):
                track.turns[joint] = turn[None]
        if joint not in track.moves:
            move = vector(node, "translation", _ORIGIN)
            if move.any():
                track.moves[joint] = move[None]


def _say_what_is_left(view: View, figure: Figure, routed: Routed, displacers: list[Found], *, posed: bool) -> None:
    """Name what routes drive and nothing shows, the scripts and sensors, and the poses."""
    shown = {id(node) for node in (*figure.joints, figure.humanoid, *(found.node for found in displacers))}
    for channel in routed.channels:
        kind = kind_of(channel.node)
        if id(channel.node) in shown and channel.field in ("rotation", "translation", "weight"):
            continue
        if kind.startswith("HAnim") or id(channel.node) in shown:
            view.warn(channel.node, f"its {channel.field} is animated, which is not played")
    ignored = sorted(
        {node.type for node in view.scene_nodes() if node.type == "Script" or node.type.endswith("Sensor")}
    )
    ignored = [kind for kind in ignored if kind != "TimeSensor"]
    if ignored:
        view.notes.append(f"ignored: {', '.join(ignored)}")
    if view.every("CoordinateInterpolator"):
        view.warnings.append("CoordinateInterpolators move points of meshes, which is not played")
    poses = [label(node) or title(node) for node in view.every("HAnimPose")]
    if poses and not posed:
        view.notes.append(f"poses in the file, which plays its motion: {', '.join(poses)}")
