"""The ten-line rival on one motion: how many levels its columns need."""

from __future__ import annotations

from functools import partial

from qmd_studio.codecs.compact.attempt import Meter
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.codecs.rivals import range_delta
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.coding import Coding, last_that_holds

_FEWEST_BITS, _MOST_BITS = 1.0, 24.0


class RangeDelta:
    """Steps over each column's range; the knob is the bits of a value, not only whole ones."""

    def __init__(self, motion: Motion) -> None:
        self._matrix, self._meter = codec_matrix(motion), Meter(motion)

    def for_error(self, mean_mm: float) -> Coding:
        """Return the fewest levels whose mean joint error is at most `mean_mm`."""

        def holds(bits: float) -> bool:
            decoded = range_delta.rounded(self._matrix, bits)
            return bool(self._meter.distances_mm(decoded).mean() <= mean_mm)

        return self._coding(last_that_holds(holds, _MOST_BITS, _FEWEST_BITS))

    def for_size(self, n_bytes: int) -> Coding:
        """Return the most levels that fit into `n_bytes`."""
        return self._coding(
            last_that_holds(
                lambda bits: len(range_delta.encode(self._matrix, bits)) <= n_bytes, _FEWEST_BITS, _MOST_BITS
            )
        )

    def _coding(self, bits: float) -> Coding:
        n_columns = self._matrix.shape[1]
        return Coding(
            f"{bits:.1f} bits of the range",
            partial(range_delta.encode, self._matrix, bits),
            lambda data: range_delta.decode(data, n_columns),
        )
