"""The colour map of errors and other scalars: dark blue through grey to bright yellow, safe for the colour-blind."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from qmd_studio.arrays import FloatArray

_STOPS = np.array(  # sRGB; lightness rises evenly, and hue goes from blue to yellow, which all can tell apart
    [
        (0.055, 0.130, 0.330),
        (0.145, 0.245, 0.490),
        (0.370, 0.360, 0.500),
        (0.560, 0.490, 0.480),
        (0.760, 0.620, 0.400),
        (0.930, 0.770, 0.280),
        (1.000, 0.930, 0.400),
    ]
)


def heat_colours(values: ArrayLike) -> FloatArray:
    """Return sRGB colours (..., 3) from 0 to 1 of `values` (...) from 0 to 1; outside, the ends' colours."""
    at = np.clip(np.asarray(values, dtype=np.float64), 0.0, 1.0) * (len(_STOPS) - 1)
    places = np.arange(len(_STOPS))
    return np.stack([np.interp(at, places, _STOPS[:, k]) for k in range(3)], axis=-1)


def linear(colours: ArrayLike) -> FloatArray:
    """Return sRGB colours from 0 to 1 in linear light."""
    c = np.asarray(colours, dtype=np.float64)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
