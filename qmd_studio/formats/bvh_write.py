"""Motion to BVH text, in the unit of the file it came from and with digits enough to read back equal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.frame_rate import frame_time_text
from qmd_studio.motion.as_euler import as_euler
from qmd_studio.motion.channels import channel_of, default_site_name, has_channels
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind, Skeleton

_DECIMALS = 10
_ROUNDED_BELOW = 1e5
"""Larger values have no 10 decimals in a float; `%.12g` alone rounds them."""
_NUMBER = "%.12g"
_DEEPEST_INDENT = 24
"""Deeper joints are not indented further, so that a long chain does not grow with the square of its length."""


def write(motion: Motion) -> bytes:
    """Return a BVH file that holds `motion`; skeletons of other kinds are written by `as_euler`.

    What was read from BVH is written value for value to 1e-9, and writing that again gives the same bytes. Raises
    `FormatError` for a name that BVH cannot hold.
    """
    if not has_channels(motion.skeleton):
        motion = as_euler(motion)
    skeleton = motion.skeleton
    turns = np.array([column.kind is ColumnKind.ROTATION for column in skeleton.columns], dtype=np.bool_)
    values = motion.X / np.where(turns, np.radians(1.0), skeleton.metres_per_unit)
    row = " ".join([_NUMBER] * skeleton.n_columns)
    lines = _hierarchy(skeleton)
    lines += ["MOTION", f"Frames: {motion.n_frames}", f"Frame Time: {frame_time_text(motion.fps)}"]
    lines += [row % tuple(frame) for frame in _rounded(values).tolist()]
    return ("\n".join(lines) + "\n").encode()


def _hierarchy(skeleton: Skeleton) -> list[str]:
    channels: list[list[str]] = [[] for _ in skeleton.joints]
    for column in skeleton.columns:
        channels[column.joint].append(channel_of(column))
    sites: list[list[tuple[str, Sequence[float]]]] = [[] for _ in skeleton.joints]
    for site in skeleton.end_sites:
        sites[site.joint].append((site.name, site.offset))
    lines = ["HIERARCHY"]
    path: list[int] = []
    for index, joint in enumerate(skeleton.joints):
        while path and path[-1] != joint.parent:
            path.pop()
            lines.append(_indent(len(path)) + "}")
        keyword = "JOINT" if path else "ROOT"
        lines += _opened(
            f"{keyword} {_checked(joint.name)}", joint.offset, depth=len(path), unit=skeleton.metres_per_unit
        )
        path.append(index)
        inner = _indent(len(path))
        lines.append(" ".join([f"{inner}CHANNELS {len(channels[index])}", *channels[index]]))
        for name, offset in sites[index]:
            title = "End Site" if name == default_site_name(joint.name) else f"End Site {_checked(name)}"
            lines += _opened(title, offset, depth=len(path), unit=skeleton.metres_per_unit)
            lines.append(inner + "}")
    lines += [_indent(depth) + "}" for depth in range(len(path) - 1, -1, -1)]
    return lines


def _opened(title: str, offset: Sequence[float], *, depth: int, unit: float) -> list[str]:
    outer = _indent(depth)
    numbers = " ".join(_NUMBER % value for value in _rounded(np.array(offset) / unit).tolist())
    return [outer + title, outer + "{", f"{_indent(depth + 1)}OFFSET {numbers}"]


def _rounded(values: FloatArray) -> FloatArray:
    """Round to ten decimals, so that noise of computing is not written out; no -0."""
    return np.where(np.abs(values) < _ROUNDED_BELOW, np.round(values, _DECIMALS), values) + 0.0


def _indent(depth: int) -> str:
    return "\t" * min(depth, _DEEPEST_INDENT)


def _checked(name: str) -> str:
    if not name or name != name.strip() or any(letter in "{}" or not letter.isprintable() for letter in name):
        raise FormatError(
            "a BVH file cannot hold this name", at=f"joint {name!r}", wanted="printable, without braces, not empty"
        )
    return name
