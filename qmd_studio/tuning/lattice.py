"""The settings that a grid allows one motion, and which of them are next to each other."""

from __future__ import annotations

import math
from typing import TypeAlias

from qmd_studio.tuning.grid import Grid
from qmd_studio.tuning.trial import Evaluator

Point: TypeAlias = tuple[int, int, int]
"""FDF, b and n_d (0: one segment)."""


class Lattice:
    """The `points` of a grid that may be tried on an evaluator's motion; raises `CodecError` for impossible bounds."""

    def __init__(self, grid: Grid, evaluator: Evaluator) -> None:
        self.lines: dict[tuple[int, int], list[int]] = {}
        """By b and n_d, the FDFs allowed, ascending."""
        for column in grid.columns(evaluator.motion):
            for bits in column.bits:
                self.lines.setdefault((bits, column.segment), []).append(column.fdf)
        for values in self.lines.values():
            values.sort()
        self.points = frozenset((fdf, *line) for line, values in self.lines.items() for fdf in values)
        self._axes = (
            sorted({fdf for fdf, _, _ in self.points}),
            sorted({bits for bits, _ in self.lines}),
            sorted({segment for _, segment in self.lines}, key=rows_of),
        )

    @property
    def bits(self) -> list[int]:
        """The index widths, ascending."""
        return self._axes[1]

    @property
    def segments(self) -> list[int]:
        """The segment lengths, the shortest first and one segment last."""
        return self._axes[2]

    def around(self, point: Point, step: int) -> list[Point]:
        """Return the neighbours of `point` that are allowed: `step` places along FDF, one along b and n_d."""
        at = [axis.index(value) for axis, value in zip(self._axes, point, strict=True)]
        found = []
        for which, distance in ((0, step), (0, -step), (1, 1), (1, -1), (2, 1), (2, -1)):
            place = at[which] + distance
            if 0 <= place < len(self._axes[which]):
                moved = list(point)
                moved[which] = self._axes[which][place]
                found.append((moved[0], moved[1], moved[2]))
        return [neighbour for neighbour in found if neighbour in self.points]


def rows_of(segment: int) -> float:
    """Return the rows of a segment for comparison: 0, one segment for all, is more than any number."""
    return segment or math.inf
