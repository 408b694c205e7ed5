"""An honest axis for errors: from zero up where it is linear, whole decades where it is logarithmic."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray

_DECADES = 4
_SMALLEST_TOP_MM = 1e-6


@dataclass(frozen=True, slots=True)
class ErrorAxis:
    """From `bottom` to `top` in mm, with `ticks` ascending from one to the other."""

    bottom: float
    top: float
    ticks: tuple[float, ...]
    logarithmic: bool

    @classmethod
    def over(cls, largest_mm: float, *, logarithmic: bool) -> ErrorAxis:
        """Return the axis that holds errors from 0 to `largest_mm` ≥ 0.

        Linear: 0 to the next 1, 2 or 5 times a power of ten. Logarithmic: the four decades up to the next power of ten;
        what is below the lowest is drawn on it.
        """
        largest = max(largest_mm, _SMALLEST_TOP_MM)
        decade = math.ceil(math.log10(largest) - 1e-9)
        if logarithmic:
            ticks = tuple(10.0**power for power in range(decade - _DECADES, decade + 1))
            return cls(ticks[0], ticks[-1], ticks, logarithmic=True)
        top = next(
            step * 10.0 ** (decade - 1) for step in (1, 2, 5, 10) if step * 10.0 ** (decade - 1) >= largest * (1 - 1e-9)
        )
        return cls(0.0, top, (0.0, top / 2, top), logarithmic=False)

    def heights(self, error_mm: FloatArray) -> FloatArray:
        """Return how high each error stands, 0 at the bottom to 1 at the top, of the same shape."""
        if not self.logarithmic:
            return np.clip(error_mm / self.top, 0.0, 1.0)
        powers = np.log10(np.maximum(error_mm, self.bottom) / self.bottom)
        return np.clip(powers / math.log10(self.top / self.bottom), 0.0, 1.0)
