"""Whole files of the compact profile: a motion encoded for a target, in the container with its skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from qmd_studio.codecs.compact.payload import unpack
from qmd_studio.codecs.compact.progress import UNWATCHED, Watch
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, slots=True, eq=False)
class EncodedCompact:
    """An encoding: `data` the whole file, the bytes of its two parts, and the motion that it decodes to."""

    data: bytes
    payload_bytes: int
    skeleton_bytes: int
    decoded: Motion


def encode(
    motion: Motion, settings: CompactSettings, *, with_skeleton: bool = True, watch: Watch = UNWATCHED
) -> EncodedCompact:
    """Encode a motion as a compact QMD file that keeps to the error that `settings` ask for.

    Raises `CodecError` for settings out of range, a motion that the profile cannot hold, and an error that it cannot
    keep to; `EncodingCancelledError` where `watch` stops it.
    """
    from qmd_studio.codecs.compact.target import meet_target  # whoever only reads a file waits for no encoder

    settings = settings.checked(motion.n_frames)
    outcome = meet_target(motion, settings, watch)
    block = pack_skeleton_block(motion) if with_skeleton else b""
    return EncodedCompact(
        data=container.build_compact(outcome.payload, block, motion.fps, settings.segment),
        payload_bytes=len(outcome.payload),
        skeleton_bytes=len(block),
        decoded=motion.with_values(motion_matrix(outcome.decoded, motion.skeleton)),
    )


def describe(parts: container.Container) -> dict[str, Any]:
    """Return what a file says of its compact payload: frames, dofs, segment (0: one for all), segments and block."""
    contents = unpack(parts.payload)
    return {
        "profile": "compact",
        "frames": contents.n_frames,
        "dofs": contents.n_columns,
        "segment": contents.segment,
        "segments": len(contents.streams),
        "block": contents.block,
    }
