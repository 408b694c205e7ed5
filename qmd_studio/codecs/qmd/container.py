"""The container of both versions: 64 bytes before the payload, and the skeleton block after it.

Version 1 holds the paper's payload, version 2 that of the compact profile. The layout is written out byte by byte in
resources/help/qmd-format.md and qmd-compact.md; the numbers here are those pages'.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass

from qmd_studio import __version__
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import FormatError
from qmd_studio.motion.motion import check_frame_rate

MAGIC = b"QMD\x1a"
VERSION = 1
COMPACT_VERSION = 2
HEADER = struct.Struct("<4sHHIQIdB3xfII16s")
"""Magic, version, header bytes, checksum, payload bytes, skeleton bytes, fps, encoder, k, RQT, n_d, software."""

_CHECKSUM_AT, _CHECKSUM_END = 8, 12
_ENCODER_CODES = {Encoder.PAPER: 1, Encoder.PLAIN: 2, Encoder.CLOSED: 3, Encoder.BOUNDED: 4}
_EQUAL_WIDTH_CODE = 5
_COMPACT_CODE = 6
_ENCODER_NAMES = {code: str(encoder) for encoder, code in _ENCODER_CODES.items()} | {
    _EQUAL_WIDTH_CODE: "paper",
    _COMPACT_CODE: "compact",
}


@dataclass(frozen=True, slots=True)
class Container:
    """A file taken apart, its checksum proven: what stands around the payload, and views of the two parts.

    `version` says which payload it is. All but that, `fps` and the parts is provenance; nothing in it is needed to
    decode. `max_error_mm` is what the bounded encoder was held to, infinite for the others.
    """

    version: int
    fps: float
    encoder: str
    buckets: Buckets
    k: float
    max_error_mm: float
    rqt: int
    segment: int
    software: str
    payload: memoryview
    skeleton_block: memoryview


def looks_like_qmd(head: bytes) -> bool:
    """Return whether a file that starts with `head` is a QMD file of any version."""
    return head.startswith(b"QMD")


def build(payload: bytes, skeleton_block: bytes, fps: float, settings: QmdSettings) -> bytes:
    """Return the whole file for a payload of version 1 and a skeleton block (empty: none)."""
    if settings.encoder is Encoder.BOUNDED:
        provenance = (_encoder_code(settings), settings.max_error_mm, settings.rqt, 0)
    else:
        provenance = (_encoder_code(settings), settings.k, settings.rqt, settings.segment)
    return _build(VERSION, payload, skeleton_block, fps, provenance)


def build_compact(payload: bytes, skeleton_block: bytes, fps: float, segment: int) -> bytes:
    """Return the whole file for a payload of version 2 in segments of `segment` frames (0: one)."""
    return _build(COMPACT_VERSION, payload, skeleton_block, fps, (_COMPACT_CODE, 0.0, 0, segment))


def _build(
    version: int, payload: bytes, skeleton_block: bytes, fps: float, provenance: tuple[int, float, int, int]
) -> bytes:
    sizes = (len(payload), len(skeleton_block))
    software = f"qmd-studio {__version__}".encode()[:16]
    header = bytearray(HEADER.pack(MAGIC, version, HEADER.size, 0, *sizes, fps, *provenance, software))
    checksum = zlib.crc32(skeleton_block, zlib.crc32(payload, _header_checksum(header)))
    struct.pack_into("<I", header, _CHECKSUM_AT, checksum)
    return b"".join((header, payload, skeleton_block))


def parse(data: bytes) -> Container:
    """Take a file apart.

    Raises `FormatError` where it is no QMD file, of a later version, shorter or longer than it says, or damaged.
    """
    if not data.startswith(MAGIC):
        raise FormatError(
            "this is not a QMD file",
            at="byte 0",
            wanted=f"the bytes {MAGIC.hex(' ')}",
            got=bytes(data[:4]).hex(" ") or "the end of the file",
            hint="qmd info says what a file is, and qmd convert turns other formats into each other",
        )
    if len(data) < HEADER.size:
        raise FormatError(
            "the file ends inside its header", wanted=f"{HEADER.size} bytes", got=str(len(data)), hint=_INCOMPLETE
        )
    _, version, header_bytes, checksum, payload_bytes, block_bytes, fps, *provenance = HEADER.unpack_from(data)
    if version not in (VERSION, COMPACT_VERSION) or header_bytes != HEADER.size:
        raise FormatError(
            "this version of the QMD format is not known",
            at="byte 4",
            wanted=f"version {VERSION} or {COMPACT_VERSION} with {HEADER.size} header bytes",
            got=f"version {version} with {header_bytes}",
            hint="Open it with a newer studio",
        )
    total = HEADER.size + payload_bytes + block_bytes
    if len(data) != total:
        raise FormatError(
            "the file is not as long as its header says", at="byte 12", wanted=f"{total} bytes", got=str(len(data)),
            hint=_INCOMPLETE,
        )  # fmt: skip
    view = memoryview(data)
    found = zlib.crc32(view[HEADER.size :], _header_checksum(data))
    if found != checksum:
        raise FormatError(
            "the checksum does not fit: the file is damaged",
            at=f"byte {_CHECKSUM_AT}",
            wanted=f"{checksum:08x}",
            got=f"{found:08x}",
            hint=_INCOMPLETE,
        )
    check_frame_rate(fps, at="byte 24")
    code, parameter, rqt, segment, software = provenance
    bounded = code == _ENCODER_CODES[Encoder.BOUNDED]
    return Container(
        version=version,
        fps=fps,
        encoder=_ENCODER_NAMES.get(code, "other"),
        buckets=Buckets.WIDTH if code == _EQUAL_WIDTH_CODE else Buckets.FREQUENCY,
        k=math.inf if bounded else parameter,
        max_error_mm=parameter if bounded else math.inf,
        rqt=rqt,
        segment=segment,
        software=software.rstrip(b"\0").decode("ascii", "replace"),
        payload=view[HEADER.size : HEADER.size + payload_bytes],
        skeleton_block=view[HEADER.size + payload_bytes :],
    )


def _encoder_code(settings: QmdSettings) -> int:
    if settings.encoder is Encoder.PAPER and settings.buckets is Buckets.WIDTH:
        return _EQUAL_WIDTH_CODE
    return _ENCODER_CODES[settings.encoder]


_INCOMPLETE = "Fetch or copy the file again"


def _header_checksum(data: bytes | bytearray) -> int:
    """Return the CRC-32 of the header without the four bytes that hold the checksum."""
    return zlib.crc32(memoryview(data)[_CHECKSUM_END : HEADER.size], zlib.crc32(memoryview(data)[:_CHECKSUM_AT]))
