"""Primitives given in metres of the default body, put into a figure's field at the figure's own places and sizes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from avatars.make.field import BODY, UNION, Field
from avatars.make.figure import Figure


@dataclass(frozen=True, slots=True)
class Placed:
    """Takes a part's name before what `Field` takes, and scales it as that part of the figure is scaled."""

    field: Field
    figure: Figure

    def ellipsoid(self, part, centre, radii, *, turn=None, k=0.01, register=BODY, op=UNION):
        """Join an ellipsoid; one that is turned is scaled evenly."""
        scale = self.figure.scale(part)
        factor = scale if turn is None else self.even(part)
        centre = self.figure.place(part, centre)
        radii = np.asarray(radii, dtype=np.float64) * factor
        self.field.ellipsoid(centre, radii, turn=turn, k=k * self.even(part), register=register, op=op)

    def cone(self, part, a, b, ra, rb, *, k=0.005, register=BODY, op=UNION):
        """Join a round cone, its radii scaled evenly."""
        size = self.even(part)
        a, b = self.figure.place(part, [a, b])
        self.field.cone(a, b, ra * size, rb * size, k=k * size, register=register, op=op)

    def loft(self, part, axis, knots, *, caps=(0.02, 0.02), k=0.01, register=BODY):
        """Join a loft along an axis."""
        knots = np.asarray(knots, dtype=np.float64)
        others = [i for i in range(3) if i != axis]
        points = np.zeros((len(knots), 3))
        points[:, axis], points[:, others] = knots[:, 0], knots[:, 1:3]
        points, scale = self.figure.place(part, points), self.figure.scale(part)
        rows = np.concatenate([points[:, [axis]], points[:, others], knots[:, 3:] * scale[others]], axis=1)
        caps = (caps[0] * scale[axis], caps[1] * scale[axis])
        self.field.loft(axis, rows, caps=caps, k=k * self.even(part), register=register)

    def join(self, source, *, into, k, levels):
        """Join a register into another, the reach going from k[0] to k[1] between two levels (part, y)."""
        between = tuple(self.level(*level) for level in levels)
        size = self.even(levels[0][0])
        self.field.join(source, into=into, k=(k[0], k[1] * size), between=between)

    def thicken(self, part, amount, normal, offset, width, *, register=BODY):
        """Grow a register beyond a plane; `offset` is along a normal that lies on an axis."""
        axis = int(np.argmax(np.abs(normal)))
        point = np.zeros(3)
        point[axis] = offset * normal[axis]
        moved = self.figure.place(part, point)[axis] * normal[axis]
        self.field.thicken(amount * self.even(part), normal, moved, width, register=register)

    def above(self, part, y, *, k=0.004, register=BODY):
        """Cut away what lies under a level."""
        self.field.above(self.level(part, y), k=k, register=register)

    def level(self, part, y) -> float:
        """Return where a level of the default body is in the figure."""
        return float(self.figure.place(part, [0.0, y, 0.0])[1])

    def even(self, part) -> float:
        """Return the part's scale as one number."""
        return float(np.cbrt(self.figure.scale(part).prod()))
