"""One way to encode one motion, found by a contender, and the search along a single knob."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from qmd_studio.arrays import Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class Coding:
    """`setting` in words; `encode` makes the payload anew; `decode` makes (n_frames, n_columns) float32 of its bytes.

    `file` puts a payload into its container, skeleton included; None where the payload has no container of its own.
    """

    setting: str
    encode: Callable[[], bytes]
    decode: Callable[[bytes], Float32Array]
    file: Callable[[bytes], bytes] | None = None


def last_that_holds(holds: Callable[[float], bool], sure: float, hopeless: float, steps: int = 11) -> float:
    """Return how far one can go from `sure` towards `hopeless`, by bisection; `sure` where not even that holds."""
    if not holds(sure):
        return sure
    for _ in range(steps):
        middle = (sure + hopeless) / 2
        if holds(middle):
            sure = middle
        else:
            hopeless = middle
    return sure
