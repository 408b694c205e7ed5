"""Bytes that may be packed by gzip (RFC 1952): unpacked up to a bound, so that a small file cannot fill the memory."""

from __future__ import annotations

import gzip
import zlib

from qmd_studio.errors import FormatError

MAX_UNPACKED = 192 << 20
"""More bytes than this are not unpacked."""
_MAGIC = b"\x1f\x8b"
_STEP = 1 << 20
_MOST_RATIO = 200
"""Text packs by a factor of three to ten, long runs of equal numbers by some forty."""


def unpacked(data: bytes, limit: int = MAX_UNPACKED) -> bytes:
    """Return what `data` holds: itself, unless gzip has packed it.

    Raises `FormatError` where the packing is damaged, or where it holds more than `limit` bytes or so much more than
    it is large itself that it must be made to do harm.
    """
    if not data.startswith(_MAGIC):
        return data
    limit = min(limit, _STEP + _MOST_RATIO * len(data))
    pieces: list[bytes] = []
    total = 0
    rest = data
    try:
        while rest.startswith(_MAGIC):
            machine = zlib.decompressobj(16 + zlib.MAX_WBITS)
            while not machine.eof:
                piece = machine.decompress(rest, _STEP)
                rest = machine.unconsumed_tail
                if not piece and not rest and not machine.eof:
                    raise FormatError(
                        "the gzip packing ends too early", wanted="its end", got=f"{total} bytes unpacked"
                    )
                pieces.append(piece)
                total += len(piece)
                if total > limit:
                    raise FormatError("the gzip packing holds too much", wanted=f"at most {limit} bytes")
            rest = machine.unused_data
    except zlib.error:
        raise FormatError("the gzip packing is damaged", at=f"after {total} unpacked bytes") from None
    return b"".join(pieces)


def head(data: bytes, count: int) -> bytes:
    """Return the first `count` bytes of what `data` holds, b"" where its packing is damaged there."""
    if not data.startswith(_MAGIC):
        return data[:count]
    try:
        return zlib.decompressobj(16 + zlib.MAX_WBITS).decompress(data[: 1 << 16], count)
    except zlib.error:
        return b""


def packed(data: bytes) -> bytes:
    """Return `data` packed by gzip, without name or time so that equal content makes equal files."""
    return gzip.compress(data, compresslevel=9, mtime=0)
