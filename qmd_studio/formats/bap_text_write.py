"""Motions of body animation parameters written as text; `bap_text` says what the text looks like."""

from __future__ import annotations

import re

import numpy as np

from qmd_studio.arrays import BoolArray, IntArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.bap import N_BAPS, N_DEFINED_BAPS, bap_table
from qmd_studio.motion.motion import Motion

MAX_FILE_VALUE = 2**31 - 1


def write_bap_text(motion: Motion) -> bytes:
    """Return `motion` as .bap text: 3.1 with masks of 186, or 3.2 with 296 where extensions are used.

    Values are rounded to the file's units. A value is left out where the motion's mask leaves it out and it has not
    changed. Raises `FormatError` for a skeleton whose columns are not body animation parameters.
    """
    raw, given = _file_values(motion)
    n_mask = N_BAPS if given[:, N_DEFINED_BAPS:].any() else N_DEFINED_BAPS
    name = re.sub(r"[\s#]+", "_", motion.name).strip("_") or "motion"
    version = "3.1" if n_mask == N_DEFINED_BAPS else "3.2"
    fps = int(motion.fps) if motion.fps == int(motion.fps) else motion.fps
    parts = [f"{version} {name} {fps!r} {motion.n_frames}"]
    for frame in range(motion.n_frames):
        mask = given[frame, :n_mask]
        parts.append(" ".join("1" if bit else "0" for bit in mask))
        parts.append(" ".join(map(str, [frame, *raw[frame, :n_mask][mask].tolist()])))
    return ("\n".join(parts) + "\n").encode()


def _file_values(motion: Motion) -> tuple[IntArray, BoolArray]:
    """Return integers in file units and what is to be given, both (n_frames, 296) by parameter number."""
    ids = [column.bap_id for column in motion.skeleton.columns]
    numbers = [bap_id for bap_id in ids if bap_id is not None]
    if not numbers or len(numbers) != len(ids):
        raise FormatError(
            "a .bap file cannot hold this motion",
            wanted="a motion of body animation parameters",
            got=f"one on the skeleton {motion.skeleton.name!r} ({motion.skeleton.kind})",
            hint="It would need retargeting; save it in the format it came in, or as QMD",
        )
    scaled = motion.X / [bap_table()[bap_id - 1].si_per_unit for bap_id in numbers]
    if np.abs(scaled).max() > MAX_FILE_VALUE:
        frame, column = np.unravel_index(np.argmax(np.abs(scaled)), scaled.shape)
        place = f"frame {frame}, column {motion.skeleton.columns[column].name}"
        raise FormatError("a value is too large for a .bap file", at=place, wanted=f"at most {MAX_FILE_VALUE}")
    places = np.array(numbers, dtype=np.int64) - 1
    raw = np.zeros((motion.n_frames, N_BAPS), dtype=np.int64)
    raw[:, places] = np.rint(scaled)
    given = np.zeros(raw.shape, dtype=np.bool_)
    given[:, places] = True if motion.mask is None else motion.mask
    return raw, given | (np.diff(raw, axis=0, prepend=0) != 0)
