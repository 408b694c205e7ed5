"""The .qmd file as the registry and `qmd info` see it: recognise, write with the defaults, describe.

Reading with a skeleton given beside the file is the registry's, for a codec does not know the formats.
"""

from __future__ import annotations

from typing import Any

from qmd_studio.codecs.compact import file as compact
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

    Keys: profile ("paper" for version 1, "compact" for version 2), frames, dofs, fps, segments, encoder (a name of
    `Encoder`, "compact" or "other"), software, payload_bytes, skeleton_bytes, bytes, and segment: the rows of d in the
    first segment, or in version 2 the frames of one, 0 for one segment. Version 1 also has fdf, bits, buckets, k, rqt
    and max_error_mm (infinite but for the bounded encoder), version 2 block, the frames from key to key. Raises
    `FormatError` for a damaged file.
    """
    parts = container.parse(data)
    about = compact.describe(parts) if parts.version == container.COMPACT_VERSION else _describe_paper(parts)
    return about | {
        "fps": parts.fps,
        "encoder": parts.encoder,
        "software": parts.software,
        "payload_bytes": len(parts.payload),
        "skeleton_bytes": len(parts.skeleton_block),
        "bytes": len(data),
    }


def _describe_paper(parts: container.Container) -> dict[str, Any]:
    contents = unpack(parts.payload)
    first = contents.segments[0]
    return {
        "profile": "paper",
        "frames": contents.n_frames,
        "dofs": contents.n_columns,
        "fdf": first.fdf,
        "bits": first.bits,
        "segment": first.n_rows,
        "segments": len(contents.segments),
        "buckets": str(parts.buckets),
        "k": parts.k,
        "rqt": parts.rqt,
        "max_error_mm": parts.max_error_mm,
    }
