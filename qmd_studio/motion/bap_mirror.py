"""Left for right: a pose of the H-Anim body as a mirror shows it.

In the mirror x points the other way: a turn about x stays as it is, turns about y and z change their sense, and so does
a move along x. Which value that is for the parameter of the other side follows from the two signs in the table.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.motion.bap import N_BAPS, Bap, bap_skeleton, bap_table, column_of
from qmd_studio.motion.skeleton import ColumnKind


def mirrored(X: FloatArray) -> FloatArray:
    """Return the mirror image of X (..., 186 or 296) in radians and metres; extension values stay where they are.

    It is its own inverse.
    """
    X = np.asarray(X, dtype=np.float64)
    source, factor = _mirror_table()
    n_columns = X.shape[-1]
    return np.asarray(X[..., source[:n_columns]] * factor[:n_columns])


def opposite(bap_id: int) -> int:
    """Return the parameter of the other side; one of the middle is its own."""
    name = bap_table()[bap_id - 1].name
    other = {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]
    return next(parameter.id for parameter in bap_table() if parameter.name == other)


@lru_cache(maxsize=1)
def _mirror_table() -> tuple[IntArray, FloatArray]:
    """Return, for each column, the column that its mirrored value comes from and the factor on it."""
    source, factor = np.arange(N_BAPS), np.ones(N_BAPS)
    for column, parameter in enumerate(bap_skeleton(extensions=True).columns):
        own = bap_table()[(parameter.bap_id or 0) - 1]
        other = bap_table()[opposite(own.id) - 1]
        source[column], factor[column] = column_of(other.id), _factor(own, other)
    return source, factor


def _factor(own: Bap, other: Bap) -> float:
    if own.kind is ColumnKind.OPAQUE:
        return 1.0
    flips = (own.axis == 0) if own.kind is ColumnKind.TRANSLATION else (own.axis != 0)
    return float(own.sign * other.sign * (-1 if flips else 1))
