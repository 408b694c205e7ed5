"""HAnimMotion: frames of joints by name and BVH-like channels (ISO/IEC 19774-2), degrees and the figure's own units."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.formats.hanim_figure import Figure
from qmd_studio.formats.hanim_view import View, flag, kind_of, label, number, raw_numbers, text
from qmd_studio.formats.scene_graph import Listed, Node
from qmd_studio.motion.hanim_names import canonical_joint
from qmd_studio.motion.motion import FRAME_RATES
from qmd_studio.motion.rotation import axis_rotation

_IGNORED = "IGNORED"
_DIRECT = ["Zrotation", "Yrotation", "Xrotation"]


@dataclass(slots=True)
class Track:
    """What moves a figure: turns (n_frames, 3, 3), or angles (n_frames, 3) about z, y, x, and moves by joint number."""

    fps: float
    n_frames: int
    turns: dict[int, FloatArray] = field(default_factory=dict)
    moves: dict[int, FloatArray] = field(default_factory=dict)
    name: str = ""


def read_hanim_motion(view: View, figure: Figure) -> Track | None:
    """Return the first HAnimMotion of the figure that plays: an enabled one where there is any; None without."""
    nodes = [child for place, child in view.children(figure.humanoid) if kind_of(child) == "HAnimMotion"]
    nodes += [node for node in view.every("HAnimMotion") if all(node is not other for other in nodes)]
    nodes.sort(key=lambda node: not flag(node, "enabled", True))
    tracks = [track for node in nodes if (track := _track(view, figure, node)) is not None]
    if len(tracks) > 1:
        others = ", ".join(repr(track.name) for track in tracks[1:])
        view.notes.append(f"the file has {len(tracks)} motions; the first is played, not {others}")
    return tracks[0] if tracks else None


def word_of(name: str) -> str:
    """Return a joint's name as the one word that the list of joints takes."""
    return re.sub(r"[\s,]+", "_", name) or "_"


def joint_numbers(figure: Figure) -> dict[str, int]:
    """Return the number of each joint by its name, as one word and in H-Anim's other spellings too."""
    numbers = {name: number for number, name in reversed(list(enumerate(figure.names)))}
    numbers = {word_of(name): number for name, number in numbers.items()} | numbers
    return {canonical_joint(name): number for name, number in numbers.items()} | numbers


def _track(view: View, figure: Figure, node: Node) -> Track | None:
    joints = text(node, "joints").replace(",", " ").split()
    groups = _channels(view, node)
    if not joints and not groups:
        return None
    if len(joints) != len(groups):
        view.warn(node, f"it names {len(joints)} joints and channels for {len(groups)}; the shorter list counts")
    width = sum(len(group) for group in groups)
    values = raw_numbers(node, "values")
    if width == 0 or len(values) < width:
        view.warn(node, f"it has {len(values)} values and {width} channels, too few for a frame; it is left out")
        return None
    if len(values) % width:
        view.warn(node, f"its {len(values)} values are no multiple of {width} channels; the last frame is left out")
    table = _chosen(view, node, values[: len(values) // width * width].reshape(-1, width))
    if not np.isfinite(table).all():
        view.warn(node, "some of its values are not finite; they are taken as 0")
        table = np.where(np.isfinite(table), table, 0.0)
    track = Track(_rate(view, node), len(table), name=label(node))
    numbers = joint_numbers(figure)
    enabled = _enabled(node, width)
    start = 0
    unknown = []
    for name, group in zip(joints, groups, strict=False):
        joint = numbers.get(name, numbers.get(canonical_joint(name)))
        if name != _IGNORED and joint is None:
            unknown.append(name)
        elif joint is not None:
            kept = [k for k in range(len(group)) if enabled[start + k]]
            _read_channels(track, joint, [group[k] for k in kept], table[:, [start + k for k in kept]])
        start += len(group)
    if unknown:
        view.warn(node, f"the figure has no joint {', '.join(unknown[:8])}; what it says of them is left out")
    return track


def _channels(view: View, node: Node) -> list[list[str]]:
    """Return each joint's channels: a count and as many names, again and again."""
    words = text(node, "channels").replace(",", " ").split()
    groups: list[list[str]] = []
    place = 0
    while place < len(words):
        if not words[place].isdecimal():
            view.warn(node, f"a count of channels is wanted, not {words[place][:20]!r}; what follows is left out")
            break
        count = min(int(words[place][:6]), 6)
        groups.append([word[:1].upper() + word[1:].lower() for word in words[place + 1 : place + 1 + count]])
        if len(groups[-1]) < count:
            view.warn(node, "the last joint has fewer channels than it counts")
        place += 1 + count
    return groups


def _enabled(node: Node, width: int) -> list[bool]:
    """Return which channels play, those that channelsEnabled does not reach among them."""
    value = node.get("channelsEnabled")
    value = value.value if isinstance(value, Listed) else value
    words = value.replace(",", " ").split() if isinstance(value, str) else value if isinstance(value, tuple) else ()
    flags = [str(word).lower() != "false" for word in words[:width]]
    return flags + [True] * (width - len(flags))


def _chosen(view: View, node: Node, table: FloatArray) -> FloatArray:
    """Return the frames from startFrame to endFrame, every frameIncrement-th."""
    last = len(table) - 1
    start, end = int(number(node, "startFrame", 0.0)), int(number(node, "endFrame", 0.0))
    if end <= start:
        start, end = (0, last) if start == 0 or start > last else (start, last)
    if start < 0 or end > last:
        view.warn(node, f"its frames {start} to {end} are not all there; those there are, are played")
    step = int(number(node, "frameIncrement", 1.0)) or 1
    frames = table[max(start, 0) : min(end, last) + 1]
    if len(frames) == 0:
        frames = table
    return frames[::step] if abs(step) < len(frames) else frames


def _rate(view: View, node: Node) -> float:
    duration = number(node, "frameDuration", 0.1)
    low, high = FRAME_RATES
    if not duration > 0 or not low <= 1 / duration <= high:
        view.warn(node, f"a frame of {duration:g} s cannot be; 0.1 s is taken")
        return 10.0
    rate = 1 / duration
    return float(round(rate)) if math.isclose(rate, round(rate), rel_tol=1e-6) else rate


def _read_channels(track: Track, joint: int, group: list[str], values: FloatArray) -> None:
    """Take a joint's channels; rotations multiply in their order, left to right."""
    moves = np.zeros((len(values), 3))
    turn: FloatArray = np.tile(np.eye(3), (len(values), 1, 1))
    rotations = [channel for channel in group if channel.endswith("rotation")]
    direct = rotations == _DIRECT
    for column, channel in enumerate(group):
        axis = "XYZ".find(channel[0])
        if axis < 0:
            continue
        if channel.endswith("position"):
            moves[:, axis] = values[:, column]
        elif channel.endswith("rotation") and not direct:
            turn = turn @ axis_rotation(axis, np.radians(values[:, column]))
    if direct:
        track.turns[joint] = np.radians(values[:, [group.index(channel) for channel in _DIRECT]])
    elif rotations:
        track.turns[joint] = turn
    if len(rotations) < len(group):
        track.moves[joint] = moves
