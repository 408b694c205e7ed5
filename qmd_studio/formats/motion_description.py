"""What CSV and NPZ files say of a motion beside its numbers: one JSON object with frame rate, name and skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.motion.skeleton_json import json_text, parse_json, skeleton_from_json, skeleton_to_json

VERSION = 1


@dataclass(frozen=True, slots=True)
class Description:
    """The object's content: `n_frames` tells a whole file from one that was cut off."""

    skeleton: Skeleton
    fps: float
    name: str
    n_frames: int

    def loaded(self, X: FloatArray, mask: BoolArray | None, options: ReadOptions) -> Loaded:
        """Return what the file held; raises `FormatError` where X (n_frames, n_columns) or the mask does not fit."""
        if len(X) != self.n_frames:
            raise FormatError(
                "the file does not hold the frames that it says",
                wanted=f"{self.n_frames} frames",
                got=str(len(X)),
                hint="The file is cut off or was edited; get a whole copy",
            )
        fps = options.fps if options.fps is not None else self.fps
        return Loaded(self.skeleton, Motion(self.skeleton, X, fps, name=self.name, mask=mask))


def describe(motion: Motion) -> str:
    """Return the JSON text for `motion`, in one line."""
    values: dict[str, Any] = {
        "version": VERSION,
        "fps": motion.fps,
        "name": motion.name,
        "frames": motion.n_frames,
        "units": {"angle": "rad", "length": "m"},
        "skeleton": skeleton_to_json(motion.skeleton),
    }
    return json_text(values)


def parse_description(text: str | bytes) -> Description:
    """Parse what `describe` wrote; raises `FormatError` for every value that is missing or of the wrong type."""
    values = parse_json(text)
    version = values.get("version")
    if version != VERSION:
        hint = "A newer version of the studio wrote it" if isinstance(version, int) and version > VERSION else None
        raise FormatError(
            "the description is of another version", wanted=str(VERSION), got=repr(version)[:40], hint=hint
        )
    fps, name, n_frames = values.get("fps"), values.get("name"), values.get("frames")
    if isinstance(fps, bool) or not isinstance(fps, int | float) or not 0 < fps <= 1e300:
        raise FormatError("the description has no frame rate", at="fps", wanted="a positive number")
    if not isinstance(name, str):
        raise FormatError("the description has no name", at="name", wanted="a text")
    if isinstance(n_frames, bool) or not isinstance(n_frames, int):
        raise FormatError("the description has no number of frames", at="frames", wanted="a whole number")
    return Description(skeleton_from_json(values.get("skeleton")), float(fps), name, n_frames)
