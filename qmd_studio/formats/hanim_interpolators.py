"""Interpolators and their routes: keys driven by a TimeSensor, sampled evenly (ISO/IEC 19775-1, clauses 8 and 19)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.hanim_view import View, flag, kind_of, number, numbers
from qmd_studio.formats.scene_graph import Node, Route
from qmd_studio.motion.motion import FRAME_RATES
from qmd_studio.motion.rotation import between_quaternions

SAMPLED_FPS = 30.0
_FEWEST_FPS = 5.0
MOST_FRAMES = 20_000
MOST_POSES = 1_000_000
"""The most frames, and frames times joints, that are made where keys do not come evenly."""
_KINDS = {"OrientationInterpolator": 4, "PositionInterpolator": 3, "ScalarInterpolator": 1}


@dataclass(slots=True)
class Channel:
    """One field of a node that is driven: keys (n,) 0 to 1, values (n, w), by a sensor of `cycle_s` seconds."""

    node: Node
    field: str
    keys: FloatArray
    values: FloatArray
    cycle_s: float
    loops: bool


@dataclass(slots=True)
class Routed:
    """All that routes drive, and the rate and length at which it is sampled."""

    channels: list[Channel] = field(default_factory=list)
    fps: float = SAMPLED_FPS
    n_frames: int = 1

    def sampled(self, node: Node, name: str) -> FloatArray | None:
        """Return the values (n_frames, w) of a field that is driven, rotations as axis and angle; None for others."""
        for channel in self.channels:
            if channel.node is node and channel.field == name:
                return _sample(channel, np.arange(self.n_frames) / self.fps)
        return None


def read_routes(view: View, n_joints: int) -> Routed:
    """Return what TimeSensors drive in the scene, directly or through one interpolator, for a figure of `n_joints`."""
    named = view.named()
    routes = view.routes()
    cycles = _driven_by_time(view, routes, named)
    routed = Routed()
    for route in routes:
        source, target = named.get(route.from_node), named.get(route.to_node)
        if source is None or target is None:
            view.warnings.append(
                f"a ROUTE from {route.from_node!r} to {route.to_node!r} has an end that does not exist"
            )
            continue
        channel = _channel(view, route, (source, target), cycles)
        if channel is not None:
            routed.channels.append(channel)
    _choose_rate(view, routed, n_joints)
    return routed


def bare(name: str) -> str:
    """Return a field's name without the prefix set_ or the ending _changed."""
    return name.removeprefix("set_").removesuffix("_changed")


def _driven_by_time(view: View, routes: list[Route], named: dict[str, Node]) -> dict[int, Node]:
    """Return the TimeSensor of each node whose fraction one sets, by the node's id."""
    found: dict[int, Node] = {}
    for route in routes:
        source, target = named.get(route.from_node), named.get(route.to_node)
        if source is None or target is None or kind_of(source) != "TimeSensor":
            continue
        if bare(route.from_field) == "fraction" and bare(route.to_field) == "fraction":
            found[id(target)] = source
    return found


def _channel(view: View, route: Route, ends: tuple[Node, Node], cycles: dict[int, Node]) -> Channel | None:
    source, target = ends
    kind, name = kind_of(source), bare(route.to_field)
    if kind == "TimeSensor" and bare(route.from_field) == "fraction" and name != "fraction":
        ramp = np.array([0.0, 1.0])
        return Channel(target, name, ramp, ramp[:, None], _cycle(view, source), flag(source, "loop", False))
    width = _KINDS.get(kind)
    sensor = cycles.get(id(source))
    if width is None or sensor is None or bare(route.from_field) != "value":
        return None
    try:
        keys, values = numbers(source, "key"), numbers(source, "keyValue")
    except FormatError as problem:
        view.warn(source, f"{problem.message}; it is left out")
        return None
    count = min(len(keys), len(values) // width)
    if count < len(keys) or count * width < len(values):
        view.warn(source, f"it has {len(keys)} keys and {len(values)} values of {width} each; {count} are used")
    if count == 0:
        return None
    keys = keys[:count]
    if (np.diff(keys) < 0).any():
        view.warn(source, "its keys go back; each is taken as not before the one ahead of it")
        keys = np.maximum.accumulate(keys)
    table = values[: count * width].reshape(count, width)
    return Channel(target, name, keys, table, _cycle(view, sensor), flag(sensor, "loop", False))


def _cycle(view: View, sensor: Node) -> float:
    cycle = number(sensor, "cycleInterval", 1.0)
    if not 1e-3 <= cycle <= 1e6:
        view.warn(sensor, f"a cycle of {cycle:g} s cannot be played; 1 s is taken")
        return 1.0
    return cycle


def _choose_rate(view: View, routed: Routed, n_joints: int) -> None:
    """Sample at the keys where all are even and as many, as in a motion that was saved, else 30 times a second."""
    moving = [channel for channel in routed.channels if len(channel.keys) > 1]
    if not moving:
        return
    longest = max(channel.cycle_s for channel in moving)
    counts = {len(channel.keys) for channel in moving}
    count = counts.pop()
    even = not counts and all(np.allclose(channel.keys, np.linspace(0, 1, count), atol=1e-7) for channel in moving)
    if even and count > 2 and all(channel.cycle_s == longest for channel in moving):
        rate = (count - 1) / longest
        if _FEWEST_FPS <= rate <= FRAME_RATES[1]:
            routed.fps = round(rate, 9) if abs(rate - round(rate, 9)) < 1e-12 else rate
            routed.n_frames = count
            return
    routed.n_frames = round(longest * SAMPLED_FPS) + 1
    most = min(MOST_FRAMES, MOST_POSES // max(n_joints, len(moving)))
    if routed.n_frames > most:
        view.notes.append(f"the animation lasts {longest:g} s; the first {most / SAMPLED_FPS:g} s are opened")
        routed.n_frames = max(most, 1)


def _sample(channel: Channel, time_s: FloatArray) -> FloatArray:
    cycles = time_s / channel.cycle_s
    fraction = np.minimum(cycles, 1.0)
    if channel.loops:  # the end of a cycle is its last key, as the sensor reports it, not the first of the next
        fraction = np.where(cycles <= 1.0, cycles, np.mod(cycles, 1.0))
    keys, values = channel.keys, channel.values
    right = np.clip(np.searchsorted(keys, fraction, side="right"), 1, max(len(keys) - 1, 1))
    if len(keys) == 1:
        return np.broadcast_to(values[0], (len(fraction), values.shape[1])).copy()
    left = right - 1
    width = keys[right] - keys[left]
    share = np.clip((fraction - keys[left]) / np.where(width > 0, width, 1.0), 0.0, 1.0)
    share = np.where(width > 0, share, 1.0)[:, None]
    if values.shape[1] != 4 or channel.field not in ("rotation", "orientation"):
        return np.asarray(values[left] * (1 - share) + values[right] * share)
    turns = _quaternions(values)
    return between_quaternions(turns[left], turns[right], share)


def quaternion_matrices(quaternion: FloatArray) -> FloatArray:
    """Return matrices (n, 3, 3) of unit quaternions (n, 4), the real part first."""
    w, x, y, z = quaternion.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _quaternions(rotation: FloatArray) -> FloatArray:
    """Return unit quaternions (n, 4) of axes of any length and angles (n, 4)."""
    length = np.linalg.norm(rotation[:, :3], axis=1, keepdims=True)
    axis = rotation[:, :3] / np.where(length > 0, length, 1.0)
    half = np.where(length > 0, rotation[:, 3:] / 2, 0.0)
    return np.concatenate([np.cos(half), np.sin(half) * axis], axis=1)
