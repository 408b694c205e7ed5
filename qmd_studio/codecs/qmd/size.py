"""The size of a QMD payload in closed form: equation 4 of the paper, its last term being 4m bytes."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.codecs.qmd.settings import index_bytes

SEGMENT_HEADER_BYTES = 13
"""n_d, m and FDF as int32 and b as one byte."""


@dataclass(frozen=True, slots=True)
class SizeBreakdown:
    """The bytes of a payload and what they are spent on; the parts add up to `bytes`."""

    bytes: int
    header_bytes: int
    table_bytes: int
    exact_bytes: int
    index_bytes: int
    pose_bytes: int


def n_segments(n_rows: int, segment: int) -> int:
    """Return how many segments of `segment` rows (0 = all) hold `n_rows` differences.

    A motion of one frame has no difference; it is held by one segment of no rows, which carries the initial pose.
    """
    return -(-n_rows // segment) if segment and n_rows else 1


def payload_size(n_rows: int, n_columns: int, fdf: int, bits: int, segment: int = 0) -> SizeBreakdown:
    """Return the exact size of the payload for `n_rows` differences (the paper's n: frames - 1) of `n_columns` (m).

    `fdf` is 0 to m, `bits` 8 to 16, `segment` the rows of a segment, 0 for one segment.
    """
    segments = n_segments(n_rows, segment)
    header = segments * SEGMENT_HEADER_BYTES
    table = segments * 4 * 2**bits
    exact = n_rows * 4 * fdf
    index = n_rows * index_bytes(bits) * (n_columns - fdf)
    pose = 4 * n_columns
    return SizeBreakdown(
        bytes=header + table + exact + index + pose,
        header_bytes=header,
        table_bytes=table,
        exact_bytes=exact,
        index_bytes=index,
        pose_bytes=pose,
    )
