"""Who takes part in a comparison. A codec more is a row more in `CONTENDERS`.

All encode the same matrix, (n_frames, n_columns) float32 radians and ASF length units, into bytes that hold all of it
but the skeleton, and decode those very bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.codecs.rivals import lossless
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.coding import Coding
from qmd_studio.tuning.contenders_qmd import Compact, Version1
from qmd_studio.tuning.contenders_range import RangeDelta


class Entrant(Protocol):
    """A contender on one motion. Where nothing meets what is asked, it answers with what comes nearest, or raises
    `CodecError` with the reason.
    """

    def for_error(self, mean_mm: float) -> Coding:
        """Return the coding of the fewest bytes whose mean joint error is at most `mean_mm`."""
        ...

    def for_size(self, n_bytes: int) -> Coding:
        """Return the coding of the least error whose payload has at most `n_bytes`."""
        ...


@dataclass(frozen=True, slots=True)
class Contender:
    """`name` as the table has it; `enter` takes a motion; `is_qmd` for the formats of this project.

    `lacks` says what is missing here for it to take part, "" where nothing is.
    """

    name: str
    enter: Callable[[Motion], Entrant]
    is_qmd: bool = False
    lacks: Callable[[], str] = str


class Lossless:
    """A contender without a knob: whatever is asked, it keeps every bit of the float32 values."""

    def __init__(
        self,
        encode: Callable[[Float32Array], bytes],
        decode: Callable[[bytes, int], Float32Array],
        motion: Motion,
    ) -> None:
        matrix, n_columns = codec_matrix(motion), motion.skeleton.n_columns
        self._coding = Coding("lossless", lambda: encode(matrix), lambda data: decode(data, n_columns))

    def for_error(self, mean_mm: float) -> Coding:
        """Return the one coding there is."""
        return self._coding

    def for_size(self, n_bytes: int) -> Coding:
        """Return the one coding there is."""
        return self._coding


def _zstd_lacks() -> str:
    return "" if lossless.has_zstd() else "zstd: not in this Python (before 3.14, pip install backports.zstd)"


PAPER = "QMD paper"

CONTENDERS = (
    Contender(PAPER, partial(Version1, Encoder.PAPER), is_qmd=True),
    Contender("QMD plain", partial(Version1, Encoder.PLAIN), is_qmd=True),
    Contender("QMD closed", partial(Version1, Encoder.CLOSED), is_qmd=True),
    Contender("QMD compact, 120 frames", partial(Compact, 120), is_qmd=True),
    Contender("QMD compact, whole clip", partial(Compact, 0), is_qmd=True),
    Contender("range + delta + pcodec", RangeDelta),
    Contender("pcodec lossless", partial(Lossless, lossless.pcodec_bytes_of, lossless.pcodec_matrix)),
    Contender("zstd of float32", partial(Lossless, lossless.zstd_bytes_of, lossless.zstd_matrix), lacks=_zstd_lacks),
    Contender("zip of float32", partial(Lossless, lossless.zip_bytes_of, lossless.zip_matrix)),
    Contender("float32 raw", partial(Lossless, lossless.raw_bytes_of, lossless.raw_matrix)),
)
