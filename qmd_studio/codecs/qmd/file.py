"""The .qmd file as the registry and `qmd info` see it: recognise, write with the defaults, describe.

Reading with a skeleton given beside the file is the registry's, for a codec does not know the formats.
"""

from __future__ import annotations

from typing import Any

from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.payload import unpack
from qmd_studio.motion.motion import Motion

SUFFIX = ".qmd"


def sniff(head: bytes) -> bool:
    """Return whether a file that starts with `head` is a QMD file."""
    return container.looks_like_qmd(head)


def write(motion: Motion) -> bytes:
    """Return a motion as a QMD file with the default settings and its skeleton."""
    return encode(motion).data


def describe(data: bytes) -> dict[str, Any]:
    """Return what a QMD file says of itself, without decoding the motion.

    Keys: frames, dofs, fps, fdf, bits, segment (rows of d in the first segment), segments, encoder (a name of
    `Encoder`, or "other"), buckets, k, rqt, max_error_mm (infinite but for the bounded encoder), software,
    payload_bytes, skeleton_bytes, bytes. Raises `FormatError` for a damaged file.
    """
    parts = container.parse(data)
    contents = unpack(parts.payload)
    first = contents.segments[0]
    return {
        "frames": contents.n_rows + 1,
        "dofs": len(contents.pose),
        "fps": parts.fps,
        "fdf": first.fdf,
        "bits": first.bits,
        "segment": first.n_rows,
        "segments": len(contents.segments),
        "encoder": parts.encoder,
        "buckets": str(parts.buckets),
        "k": parts.k,
        "rqt": parts.rqt,
        "max_error_mm": parts.max_error_mm,
        "software": parts.software,
        "payload_bytes": len(parts.payload),
        "skeleton_bytes": len(parts.skeleton_block),
        "bytes": len(data),
    }
