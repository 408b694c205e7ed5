"""The ways to see two sides of one motion."""

from __future__ import annotations

from enum import StrEnum

from qmd_studio.project.state import Side
from qmd_studio.render.panes import Layout


class View(StrEnum):
    """How the sides A and B are shown, in the order of the buttons."""

    A = "a"
    """Side A alone."""
    WIPE = "wipe"
    """A left of a line that can be drawn, B right of it."""
    BESIDE = "beside"
    """A and B in a picture each."""
    GHOST = "ghost"
    """B as a ghost over A."""
    DIFFERENCE = "difference"
    """What of B is not where it is in A, coloured by how far it is off; A faintly."""
    B = "b"
    """Side B alone."""

    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides that are shown, in the order in which they are drawn: a faint A after what it must not hide."""
        return {View.A: (Side.A,), View.B: (Side.B,), View.DIFFERENCE: (Side.B, Side.A)}.get(self, (Side.A, Side.B))


COMPARING = (View.WIPE, View.BESIDE, View.GHOST, View.DIFFERENCE)
"""The views that show both sides."""

LAYOUTS = {View.WIPE: Layout.WIPE, View.BESIDE: Layout.BESIDE}
"""How a view shares the picture, where both sides are not in one."""
