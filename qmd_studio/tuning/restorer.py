"""What a player shows of a reduced motion, column after column in single precision: a search asks it of every trial."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array, IntArray
from qmd_studio.motion.in_between import JUMP
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind
from qmd_studio.tuning.reduction import Reduction


class Restorer:
    """Makes of decodings of the reduced `original` what `Reduction.restore` makes of them.

    `held` (n_columns,) is where the columns stay that the reduction drops, in the units that are decoded.
    """

    def __init__(self, original: Motion, reduction: Reduction, held: Float32Array) -> None:
        self._kept = reduction.kept_columns(original.skeleton)
        before, place = np.divmod(np.arange(original.n_frames), reduction.fps_divisor)
        self._before, self._share = before, (place / reduction.fps_divisor).astype(np.float32)
        self._still = np.repeat(held[:, np.newaxis], original.n_frames, axis=1)
        columns = [c for c, kept in zip(original.skeleton.columns, self._kept, strict=True) if kept]
        self._turns = np.array([c.kind is ColumnKind.ROTATION for c in columns], dtype=np.bool_)
        self._owners: IntArray = np.array([c.joint for c in columns], dtype=np.int64)

    def restored(self, decoded: Float32Array) -> Float32Array:
        """Return (n_columns, n_frames) of the original for `decoded`, the columns and frames that were kept."""
        steps = np.diff(decoded, axis=1, append=decoded[:, -1:])
        flips = (np.abs(steps) > JUMP) & self._turns[:, np.newaxis]
        for joint in np.unique(self._owners[flips.any(axis=1)]):
            columns = np.flatnonzero(self._owners == joint)
            steps[np.ix_(columns, flips[columns].any(axis=0))] = 0.0
        result = self._still.copy()
        result[self._kept] = decoded[:, self._before] + steps[:, self._before] * self._share
        return result
