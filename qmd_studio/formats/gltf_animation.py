"""The animation of a glTF file: what each channel holds, and its values at any times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.gltf_document import Document, accessor, item, listed, name_of, record, whole
from qmd_studio.motion.motion import FRAME_RATES, check_frame_rate
from qmd_studio.motion.rotation import between_quaternions

USUAL_FPS = 30.0
_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3, "weights": 1}
_GUESSED_FPS = (1.0, 240.0)
MAX_FRAMES = 1_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """A channel: `values` (K, w) at `times` (K,) seconds; CUBICSPLINE has (K, 3, w): in-tangent, value, out-tangent."""

    node: int
    path: str
    times: FloatArray
    values: FloatArray
    interpolation: str


def tracks_of(document: Document) -> list[Track]:
    """Return the channels of the first animation that has any; raises `FormatError` for damaged ones."""
    animations = [item(document, "animations", k) for k in range(len(listed(document.root, "animations")))]
    n_nodes = len(listed(document.root, "nodes"))
    for number, animation in enumerate(animations):
        tracks = []
        samplers = listed(animation, "samplers")
        for k, channel in enumerate(listed(animation, "channels")):
            at = f"animation {number}, channel {k}"
            if not isinstance(channel, dict):
                raise FormatError("this is no object", at=at)
            target = record(channel, "target")
            path = target.get("path")
            if "node" not in target or path not in _WIDTHS:
                document.note("channels that move no node are left out")
                continue
            node = whole(target["node"], at, below=n_nodes)
            sampler = samplers[whole(channel.get("sampler"), at, below=len(samplers))]
            track = _track(document, node, str(path), sampler if isinstance(sampler, dict) else {}, at=at)
            if len(track.times):
                tracks.append(track)
        if tracks:
            if len(animations) > 1:
                name = name_of(animation, f"animation {number}")
                document.note(f"the file has {len(animations)} animations; {name!r} is played")
            return tracks
    return []


def sampled(track: Track, times: FloatArray) -> FloatArray:
    """Return the values (n, w) of a channel at `times` (n,), held before its first key and after its last."""
    keys = track.times
    values = track.values[:, 1] if track.interpolation == "CUBICSPLINE" else track.values
    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    after = np.clip(np.searchsorted(keys, times, side="right"), 1, len(keys) - 1)
    step = (keys[after] - keys[after - 1])[:, None]
    part = np.clip((times - keys[after - 1])[:, None] / step, 0.0, 1.0)
    first, second = values[after - 1], values[after]
    if track.interpolation == "STEP":
        return np.where(part >= 1.0, second, first)
    if track.interpolation == "CUBICSPLINE":
        out, into = step * track.values[after - 1, 2], step * track.values[after, 0]
        square, cube = part**2, part**3
        return np.asarray(
            (2 * cube - 3 * square + 1) * first
            + (cube - 2 * square + part) * out
            + (3 * square - 2 * cube) * second
            + (cube - square) * into
        )
    if track.path == "rotation":
        return between_quaternions(_unit(first), _unit(second), part)
    return np.asarray(first + part * (second - first))


def frame_times(tracks: list[Track], fps: float) -> FloatArray:
    """Return the times (n_frames,) in seconds at which the tracks are sampled; raises `FormatError` for too many."""
    check_frame_rate(fps, at="the frame rate")
    start = min(float(track.times[0]) for track in tracks)
    end = max(float(track.times[-1]) for track in tracks)
    n_frames = round((end - start) * fps) + 1
    if n_frames > MAX_FRAMES:
        raise FormatError("the animation is too long", wanted=f"at most {MAX_FRAMES} frames", got=str(n_frames))
    return start + np.arange(n_frames) / fps


def guessed_fps(tracks: list[Track]) -> float:
    """Return the rate of the keys of the track that has most of them, a whole number where it is nearly one."""
    times = max((track.times for track in tracks), key=len)
    if len(times) < 2:
        return USUAL_FPS
    rate = 1.0 / float(np.median(np.diff(times)))
    if math.isclose(rate, round(rate), rel_tol=0.01):
        rate = float(round(rate))
    return min(max(rate, _GUESSED_FPS[0], FRAME_RATES[0]), _GUESSED_FPS[1])


def _track(document: Document, node: int, path: str, sampler: dict[str, object], *, at: str) -> Track:
    times = accessor(document, sampler.get("input"), width=1)[:, 0].astype(np.float64)
    if (np.diff(times) <= 0).any() or (times < 0).any() or (times > 1e6).any():
        raise FormatError("the times of an animation do not rise", at=at, wanted="seconds, each above the one before")
    interpolation = sampler.get("interpolation", "LINEAR")
    if interpolation not in ("LINEAR", "STEP", "CUBICSPLINE"):
        raise FormatError("an unknown way to go from key to key", at=at, got=str(interpolation)[:40])
    values = accessor(document, sampler.get("output"), width=_WIDTHS[path]).astype(np.float64)
    per_key = 3 if interpolation == "CUBICSPLINE" else 1
    width = values.shape[1]
    if path == "weights" and len(times):
        width = len(values) // (len(times) * per_key)
    if not width or values.size != len(times) * per_key * width:
        wanted = f"{len(times) * per_key} keys"
        raise FormatError("an animation's times and values differ", at=at, wanted=wanted, got=str(len(values)))
    shape = (len(times), 3, width) if per_key == 3 else (len(times), width)
    return Track(node, path, times, values.reshape(shape), str(interpolation))


def _unit(quaternions: FloatArray) -> FloatArray:
    return np.asarray(quaternions / np.maximum(np.linalg.norm(quaternions, axis=1, keepdims=True), 1e-30))
