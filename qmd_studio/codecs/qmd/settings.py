"""What a QMD encoder may be told: the paper's three parameters, which encoder, and its own constants."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

from qmd_studio.errors import CodecError

MIN_BITS, MAX_BITS = 8, 16
"""The paper's range of b (section 5.1): an index takes one byte at 8 and two above."""

_MAX_U32 = 2**32 - 1

_LARGEST_K = 1000.0
"""Beyond it no weight but the lowest level's is left in double precision: as good as infinite."""


class Encoder(StrEnum):
    """How the indices are chosen. Every decoder plays the files of any."""

    PAPER = "paper"
    """The paper's own: each index from the original difference, so that errors add up along the motion."""
    CLOSED = "closed"
    """From what the decoder still lacks, so that errors do not add up, and the indices of a frame together, by what
    they do to the joints."""
    PLAIN = "plain"
    """The closed loop without kinematics: each index by itself from what the decoder still lacks."""
    BOUNDED = "bounded"
    """As CLOSED, with FDF, b and segments sought so that no joint is ever further off than a given distance."""


class Buckets(StrEnum):
    """How the paper's encoder parts the differences into the buckets of its table."""

    FREQUENCY = "frequency"
    """Each bucket takes an equal share of the values, as the paper's words have it and its figures bear out."""
    WIDTH = "width"
    """Each bucket takes an equal share of the range, as the paper's formula for `freq` has it (section 3.1, step 2)."""


@dataclass(frozen=True, slots=True)
class QmdSettings:
    """The settings of one encoding.

    `fdf` is the paper's FDF, the number of leading columns kept as float32 (default 6: the root). `bits` is b, the
    width of an index (default 8; table of 2^b entries). `segment` is n_d, the rows of d in a segment (0: one segment).
    `k`, `rqt` and `buckets` matter to the paper's encoder only: entries are weighted by 1/level^k (default infinite:
    the lowest level in the bucket alone counts), and values are sorted into buckets as round(value * rqt), the paper's
    M. `max_error_mm` matters to the bounded encoder only, which finds `fdf`, `bits` and segments by itself.
    """

    fdf: int = 6
    bits: int = MIN_BITS
    segment: int = 0
    encoder: Encoder = Encoder.CLOSED
    k: float = math.inf
    rqt: int = 10_000
    buckets: Buckets = Buckets.FREQUENCY
    max_error_mm: float = 1.0

    def checked(self, n_columns: int, n_rows: int) -> QmdSettings:
        """Return these settings for a motion of `n_columns` and `n_rows` differences.

        A segment longer than the motion becomes one segment (0). FDF, b and n_d of the bounded encoder, which finds its
        own, become their least. Raises `CodecError` for anything out of range.
        """
        if self.encoder is Encoder.BOUNDED and (self.fdf, self.bits, self.segment) != (0, MIN_BITS, 0):
            return replace(self, fdf=0, bits=MIN_BITS, segment=0).checked(n_columns, n_rows)
        _check_range("FDF", self.fdf, 0, n_columns)
        _check_range("b", self.bits, MIN_BITS, MAX_BITS)
        _check_range("n_d", self.segment, 0, _MAX_U32)
        _check_range("RQT", self.rqt, 1, _MAX_U32)
        if math.isnan(self.k) or self.k < 0:
            raise CodecError("k is out of range", wanted="0 or more, or infinite", got=str(self.k))
        if not (math.isfinite(self.max_error_mm) and self.max_error_mm > 0):
            raise CodecError("the bound is not a distance", wanted="millimetres above 0", got=str(self.max_error_mm))
        segment = 0 if self.segment >= n_rows else self.segment
        k = math.inf if self.k > _LARGEST_K else self.k
        return replace(self, segment=segment, encoder=Encoder(self.encoder), k=k, buckets=Buckets(self.buckets))

    def fitted(self, n_columns: int) -> QmdSettings:
        """Return these settings with FDF lowered where the motion has fewer columns than that."""
        return replace(self, fdf=min(self.fdf, n_columns))


def index_bytes(bits: int) -> int:
    """Return the bytes of one index of `bits` bits: the paper's ⌈b/8⌉."""
    return -(-bits // 8)


def _check_range(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high:
        raise CodecError(f"{name} is out of range", wanted=f"{low} to {high}", got=str(value))
