"""A motion for a figure that is being built: as HAnimMotion, or as interpolators that a TimeSensor drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.hanim_build import Built
from qmd_studio.formats.hanim_motion import word_of
from qmd_studio.formats.scene_graph import Node, Route
from qmd_studio.motion.as_euler import euler_zyx
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind

_STILL_M = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Each joint's turn (n_frames, J, 3, 3) and move (n_frames, J, 3), as H-Anim has them, and who moves (J,)."""

    turns: FloatArray
    moves: FloatArray
    movers: tuple[bool, ...]


def add_hanim_motion(built: Built, body: Body, motion: Motion) -> None:
    """Add `motion` as an HAnimMotion; weights of displacers, which that cannot hold, as interpolators.

    Rotations are Rx · Ry · Rz and listed so: a player that has heed of the channels' order and one that takes them by
    their axes (X_ITE of 2023 did, whatever their order) then show the same.
    """
    pose = _pose(body, motion)
    names: list[str] = []
    channels: list[str] = []
    columns: list[FloatArray] = []
    for joint, row in enumerate(body.skeleton.joints):
        names.append(word_of(row.name))
        angles = np.degrees(_angles(pose.turns[:, joint]))
        if pose.movers[joint]:
            channels.append("6 Xposition Yposition Zposition Xrotation Yrotation Zrotation")
            columns += [pose.moves[:, joint], angles]
        else:
            channels.append("3 Xrotation Yrotation Zrotation")
            columns.append(angles)
    values = np.concatenate(columns, axis=1)
    node = Node("HAnimMotion", "hanim_motion")
    node.fields += [
        ("name", motion.name or "motion"),
        ("loop", True),
        ("frameDuration", np.array([1 / motion.fps])),
        ("endFrame", np.array([motion.n_frames - 1])),
        ("joints", " ".join(names)),
        ("channels", " ".join(channels)),
        ("values", _short(values).ravel()),
    ]
    built.humanoid.fields.append(("motions", node))
    _add_weights(built, motion)


def add_interpolators(built: Built, body: Body, motion: Motion) -> None:
    """Add `motion` as interpolators with a TimeSensor and routes; one of one frame as the pose of the joints."""
    pose = _pose(body, motion)
    for joint, node in enumerate(built.joints):
        rotation = _axis_angles(pose.turns[:, joint])
        if motion.n_frames == 1:
            if rotation[0, 3]:
                node.fields.insert(2, ("rotation", rotation[0]))
            if pose.moves[0, joint].any():
                node.fields.insert(2, ("translation", _short(pose.moves[0, joint])))
            continue
        if rotation[:, 3].any():
            _drive(built, motion, node, ("OrientationInterpolator", "rotation", rotation))
        if pose.movers[joint] and pose.moves[:, joint].any():
            _drive(built, motion, node, ("PositionInterpolator", "translation", _short(pose.moves[:, joint])))
    _add_weights(built, motion)


def _add_weights(built: Built, motion: Motion) -> None:
    for number, column in enumerate(motion.skeleton.columns):
        node = built.displacers.get(column.name)
        if column.kind is ColumnKind.OPAQUE and node is not None:
            values = motion.X[:, number : number + 1]
            if motion.n_frames == 1:
                node.fields = [(k, values[0] if k == "weight" else v) for k, v in node.fields]
            else:
                _drive(built, motion, node, ("ScalarInterpolator", "weight", values))


def _drive(built: Built, motion: Motion, node: Node, driver: tuple[str, str, FloatArray]) -> None:
    """Add an interpolator of (kind, field, values) and the routes from the clock to it and from it to the field."""
    kind, field, values = driver
    root = built.scene.root
    if not any(isinstance(value, Node) and value.name == "clock" for _, value in root.fields):
        cycle = (motion.n_frames - 1) / motion.fps
        clock = Node("TimeSensor", "clock", [("cycleInterval", np.array([cycle])), ("loop", True)])
        root.fields.append(("children", clock))
    name = f"{node.name}_{field}"
    keys = np.arange(motion.n_frames) / (motion.n_frames - 1)
    root.fields.append(("children", Node(kind, name, [("key", keys), ("keyValue", values.ravel())])))
    root.fields.append(("", Route("clock", "fraction_changed", name, "set_fraction")))
    root.fields.append(("", Route(name, "value_changed", node.name or "", f"set_{field}")))


def _pose(body: Body, motion: Motion) -> Pose:
    """Return what each joint does away from the binding pose, in frames that are parallel to the figure's there."""
    skeleton = body.skeleton
    world = world_from_joint(skeleton, motion.X)
    away = world[..., :3, :3] @ np.swapaxes(body.bind[:, :3, :3], 1, 2)
    centres = body.bind[:, :3, 3]
    turns, moves = away.copy(), np.empty((*world.shape[:2], 3))
    for joint, row in enumerate(skeleton.joints):
        place = world[:, joint, :3, 3]
        if row.parent < 0:
            moves[:, joint] = place - centres[joint]
            continue
        back = np.swapaxes(away[:, row.parent], 1, 2)
        turns[:, joint] = back @ away[:, joint]
        step = np.einsum("fij,fj->fi", back, place - world[:, row.parent, :3, 3])
        moves[:, joint] = step - (centres[joint] - centres[row.parent])
    moves = np.where(np.abs(moves) < _STILL_M, 0.0, moves)
    moving = {c.joint for c in skeleton.columns if c.kind is ColumnKind.TRANSLATION}
    movers = tuple(
        row.parent < 0 or joint in moving or bool(moves[:, joint].any()) for joint, row in enumerate(skeleton.joints)
    )
    return Pose(turns, moves, movers)


def _angles(turns: FloatArray) -> FloatArray:
    """Return angles (n_frames, 3) x, y, z with Rx · Ry · Rz = `turns`: the transpose has them backwards."""
    return np.asarray(-euler_zyx(np.swapaxes(turns, 1, 2))[:, ::-1])


def _axis_angles(turns: FloatArray) -> FloatArray:
    """Return axes and angles (n, 4) of rotations (n, 3, 3); no turn is about z."""
    from scipy.spatial.transform import Rotation

    vectors = Rotation.from_matrix(turns).as_rotvec()
    angle = np.linalg.norm(vectors, axis=1, keepdims=True)
    small = angle < 1e-12
    axis = np.where(small, [0.0, 0.0, 1.0], vectors / np.where(small, 1.0, angle))
    return np.concatenate([axis, np.where(small, 0.0, angle)], axis=1)


def _short(values: FloatArray) -> FloatArray:
    """Return numbers to ten decimals: degrees and metres far finer than any motion is known."""
    return np.round(values, 10) + 0.0
