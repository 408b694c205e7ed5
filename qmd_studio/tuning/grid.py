"""The settings a search may choose from: bounds that a person can see and change."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion

_FLOAT_BYTES = 4
MOST_SETTINGS = 2_000_000
"""A grid of more is refused: naming its settings alone would fill the memory."""

_MOST_STOPS = 1_000
"""Segment lengths of the wide grid; motions of over 30,000 frames have them in larger steps."""

_STEP = 30
"""The paper's step of n_d (section 5.3)."""


@dataclass(frozen=True, slots=True)
class Column:
    """The settings that share FDF and segmentation (0: one segment) and differ in their index widths."""

    fdf: int
    segment: int
    bits: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Grid:
    """All combinations of `fdf`, `bits` and `segments` (0: one segment) whose payload has at most `largest_bytes`."""

    fdf: tuple[int, ...]
    bits: tuple[int, ...]
    segments: tuple[int, ...]
    largest_bytes: int | None = None

    def unbounded(self) -> Grid:
        """Return this grid with files of any size."""
        return replace(self, largest_bytes=None)

    def columns(self, motion: Motion) -> Iterator[Column]:
        """Yield the settings allowed for `motion`, those of one segmentation together.

        FDF beyond the motion's columns are left out, segments that hold all rows become 0; nothing comes twice.
        Raises `CodecError` for bounds that no QMD file can have.
        """
        self._check()
        n_rows, n_columns = motion.n_frames - 1, motion.skeleton.n_columns
        segments = dict.fromkeys(0 if segment >= n_rows else segment for segment in self.segments)
        for segment in segments:
            for fdf in dict.fromkeys(self.fdf):
                bits = [b for b in dict.fromkeys(self.bits) if self._fits(n_rows, n_columns, fdf, b, segment)]
                if fdf <= n_columns and bits:
                    yield Column(fdf, segment, tuple(bits))

    def _fits(self, n_rows: int, n_columns: int, fdf: int, bits: int, segment: int) -> bool:
        limit = self.largest_bytes
        return limit is None or payload_size(n_rows, n_columns, fdf, bits, segment).bytes <= limit

    def _check(self) -> None:
        for name, values, low, high in (
            ("FDF", self.fdf, 0, None),
            ("b", self.bits, MIN_BITS, MAX_BITS),
            ("n_d", self.segments, 0, None),
        ):
            wrong = next((v for v in values if v < low or (high is not None and v > high)), None)
            if wrong is not None or not values:
                wanted = f"{low} to {high}" if high is not None else f"{low} or more"
                raise CodecError(f"the grid's {name} is out of range", wanted=wanted, got=str(wrong))
        count = len(self.fdf) * len(self.bits) * len(self.segments)
        if count > MOST_SETTINGS:
            raise CodecError(
                "the grid holds too many settings",
                wanted=f"at most {MOST_SETTINGS:,}",
                got=f"{count:,}",
                hint="Name fewer values of FDF, b or n_d",
            )


def raw_bytes(motion: Motion) -> int:
    """Return the bytes of the raw motion, all values as float32: the paper's "original"."""
    return motion.n_frames * motion.skeleton.n_columns * _FLOAT_BYTES


def paper_grid(motion: Motion) -> Grid:
    """Return the grid that the paper's Table 2 shows: FDF 1, 6, …, 26, b 8 to 10, n_d in multiples of 30.

    No file may be larger than the raw motion. A motion of fewer than 30 rows has one segment.
    """
    segments = tuple(range(_STEP, motion.n_frames, _STEP)) or (0,)
    return Grid(tuple(range(1, 27, 5)), (8, 9, 10), segments, raw_bytes(motion))


def wide_grid(motion: Motion) -> Grid:
    """Return the grid of every FDF but the last, every b, n_d in multiples of 30 and one segment.

    A very long motion has n_d in multiples of more, so that there are `_MOST_STOPS` of them at most.
    No file may be larger than the raw motion: without that bound bytes times DEF is least where nearly all is exact.
    """
    step = _STEP * math.ceil(motion.n_frames / (_STEP * _MOST_STOPS))
    segments = (*range(step, motion.n_frames - 1, step), 0)
    fdf = tuple(range(max(motion.skeleton.n_columns, 1)))
    return Grid(fdf, tuple(range(MIN_BITS, MAX_BITS + 1)), segments, raw_bytes(motion))
