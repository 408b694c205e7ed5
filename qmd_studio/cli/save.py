"""How the verbs write motions: in the format that the suffix names, with whatever its readers need beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from qmd_studio import registry, storage
from qmd_studio.cli.report import Report, Value
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf_amc import companion, find_skeleton
from qmd_studio.formats.loaded import Format, ReadOptions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton, Vector3

_SAME_M = 1e-6
"""Bones that differ by less are the same: text files round their lengths."""


def save_motion(path: Path, motion: Motion) -> Report:
    """Write `motion` to `path` and report it; an AMC gets its ASF beside it where no other reader would find one.

    Raises `FormatError` where the format cannot hold the motion, `StorageError` where the disk refuses.
    """
    target, data = _encoded(path, motion)
    warnings: tuple[str, ...] = ()
    lines = [("written", str(path))]
    if target.name == "amc":
        beside, warnings = _skeleton_beside(path, motion)
        if beside:
            storage.write_atomic(*beside)
            lines.append(("skeleton", str(beside[0])))
    storage.write_atomic(path, data)
    frames, dofs = motion.X.shape
    lines.append(("motion", f"{frames:,} frames × {dofs} degrees of freedom, {motion.fps:g} fps"))
    values: dict[str, Value] = {
        "file": str(path),
        "format": target.name,
        "frames": frames,
        "fps": motion.fps,
        "dofs": dofs,
        "bytes": len(data),
    }
    return Report(values, lines, warnings)


def _encoded(path: Path, motion: Motion) -> tuple[Format, bytes]:
    try:
        return registry.format_for(path), registry.encode_motion(path.suffix, motion)
    except FormatError as error:
        raise error.located(path) from None


def _skeleton_beside(path: Path, motion: Motion) -> tuple[tuple[Path, bytes] | None, tuple[str, ...]]:
    """Return the ASF to write for the AMC at `path`, if any, and what the user should know."""
    if _found_skeleton_fits(path, motion.skeleton):
        return None, ()
    beside = companion(path, motion)
    if beside:
        return beside, ()
    taken = path.with_suffix(".asf")
    return None, (f"{taken}: belongs to another skeleton and was left alone; {path.name} will not open with it",)


def _found_skeleton_fits(path: Path, skeleton: Skeleton) -> bool:
    try:
        found = _bones(registry.open_file(find_skeleton(ReadOptions(path=path))).skeleton)
    except FormatError:
        return False
    wanted = _bones(skeleton)
    return found.keys() == wanted.keys() and all(
        np.allclose(found[name], offset, rtol=0, atol=_SAME_M) for name, offset in wanted.items()
    )


def _bones(skeleton: Skeleton) -> dict[str, Vector3]:
    joints = {joint.name: joint.offset for joint in skeleton.joints}
    return joints | {site.name: site.offset for site in skeleton.end_sites}
