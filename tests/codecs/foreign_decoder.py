"""A decoder written from resources/help/qmd-format.md alone, with nothing but the standard library."""

import json
import struct
import zlib


def decode(data):
    """Return (fps, poses as lists in file units, the skeleton block's object or None)."""
    assert data[:4] == bytes.fromhex("514d441a")
    version, header_bytes, checksum = struct.unpack_from("<HHI", data, 4)
    assert (version, header_bytes) == (1, 64)
    assert zlib.crc32(data[:8] + data[12:]) == checksum
    payload_bytes, block_bytes, fps = struct.unpack_from("<QId", data, 12)
    assert len(data) == 64 + payload_bytes + block_bytes

    at, end, pose = 64, 64 + payload_bytes, None
    poses = []
    while at < end:
        rows, m, fdf, bits = struct.unpack_from("<iiiB", data, at)
        at += 13
        if pose is None:
            pose = list(struct.unpack_from(f"<{m}f", data, at))
            at += 4 * m
            poses.append(pose)
        table = struct.unpack_from(f"<{2**bits}f", data, at)
        at += 4 * 2**bits
        exact = struct.unpack_from(f"<{rows * fdf}f", data, at)
        at += 4 * rows * fdf
        width, letter = (1, "B") if bits == 8 else (2, "H")
        positions = struct.unpack_from(f"<{rows * (m - fdf)}{letter}", data, at)
        at += width * rows * (m - fdf)
        for row in range(rows):
            steps = list(exact[row * fdf : (row + 1) * fdf])
            steps += [table[i] for i in positions[row * (m - fdf) : (row + 1) * (m - fdf)]]
            pose = [as_f32(value + step) for value, step in zip(pose, steps, strict=True)]
            poses.append(pose)
    assert at == end
    return fps, poses, skeleton_block(data[end:])


def as_f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def skeleton_block(block):
    if not block:
        return None
    (length,) = struct.unpack_from("<I", block)
    text = zlib.decompress(block[4:])
    assert len(text) == length
    return json.loads(text.decode("utf-8"))
