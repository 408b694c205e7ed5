"""The decoder in Python, as that in C is held against it: the same poses, or a refusal at the same byte."""

import re

from qmd_studio.codecs.compact.decode import decode_payload as decode_compact
from qmd_studio.codecs.compact.payload import unpack as unpack_compact
from qmd_studio.codecs.qmd.container import COMPACT_VERSION, parse
from qmd_studio.codecs.qmd.decode import decode_payload
from qmd_studio.codecs.qmd.payload import unpack
from qmd_studio.errors import FormatError


def assert_same(decoder, data):
    """Check that C and Python agree on `data`, be it good or not; return what C said.

    The skeleton block is left aside: in C it is the host's affair.
    """
    ours = decoder.decode(data)
    try:
        parts = parse(data)
        poses = poses_of(parts)
    except FormatError as error:
        _assert_refused(ours, error)
        return ours
    assert ours.status == "END", f"Python takes this; {ours.status} at byte {ours.error_at}"
    assert ours.fps == parts.fps
    assert data[ours.skeleton] == bytes(parts.skeleton_block)
    assert ours.frames == len(poses)
    assert ours.poses.tobytes() == poses.tobytes()
    return ours


def poses_of(parts):
    """Return the poses (n_frames, n_columns) float32 in a file taken apart, of either version."""
    if parts.version == COMPACT_VERSION:
        return decode_compact(unpack_compact(parts.payload))
    return decode_payload(unpack(parts.payload))


def _assert_refused(ours, error):
    assert ours.status not in ("OK", "END"), f"Python refuses this: {error}"
    byte = re.fullmatch(r"byte (\d+)", error.at or "")
    assert byte is None or ours.error_at == int(byte[1]), f"{ours.status} at {ours.error_at}; Python says {error}"
