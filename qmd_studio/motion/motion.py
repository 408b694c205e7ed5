"""A motion: the matrix X on a skeleton, with its frame rate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.motion.skeleton import LARGEST, ColumnKind, Skeleton

_Scalar = TypeVar("_Scalar", bound=np.generic)

ASF_UNIT_M = 0.0254 / 0.45
"""The length unit of the CMU ASF files in metres (1/0.45 inch): the unit of DEF and of QMD's table values."""

FRAME_RATES = (1e-3, 1e5)
"""The least and the highest number of frames a second that is taken for one."""


def check_frame_rate(fps: float, *, at: str | None = None) -> None:
    """Raise `FormatError` for a number of frames a second that nothing plays; `at` says where it stands."""
    low, high = FRAME_RATES
    if not low <= fps <= high:
        message = "nothing plays at this rate" if 0 < fps < math.inf else "the frame rate is not a positive number"
        raise FormatError(message, at=at, wanted=f"{low:g} to {high:g} frames a second", got=f"{fps:g}")


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """X (n_frames, n_columns) in radians and metres, at `fps` frames a second.

    Angles and lengths are at most `LARGEST` in size and the rate lies within `FRAME_RATES`, so that no arithmetic on
    poses leaves the range of its numbers; opaque columns may hold any finite number.

    `mask` (n_frames, n_columns), of MPEG-4 BAP motions only, is True where the file gave a value; where it is False X
    holds the last value given. The arrays become read-only. Raises `FormatError` for no frame, a wrong shape, a number
    that is not finite or too large, or a frame rate that nothing plays.
    """

    skeleton: Skeleton
    X: FloatArray
    fps: float
    name: str = ""
    mask: BoolArray | None = None

    def __post_init__(self) -> None:
        X = _read_only(np.ascontiguousarray(self.X, dtype=np.float64))
        object.__setattr__(self, "X", X)
        wanted = f"(frames, {self.skeleton.n_columns})"
        if X.ndim != 2 or X.shape[1] != self.skeleton.n_columns:
            raise FormatError("the motion does not fit the skeleton", wanted=wanted, got=str(X.shape))
        if len(X) == 0:
            raise FormatError("the motion has no frame", wanted="at least 1 frame", got="0")
        check_frame_rate(self.fps)
        if X.size and not -LARGEST <= X.min() <= X.max() <= LARGEST:  # NaN is neither
            self._check_values(X)
        if self.mask is not None:
            mask = _read_only(np.ascontiguousarray(self.mask, dtype=np.bool_))
            if mask.shape != X.shape:
                raise FormatError("the mask does not fit the motion", wanted=str(X.shape), got=str(mask.shape))
            object.__setattr__(self, "mask", mask)

    def _check_values(self, X: FloatArray) -> None:
        opaque = np.array([column.kind is ColumnKind.OPAQUE for column in self.skeleton.columns], dtype=np.bool_)
        wrong = ~np.isfinite(X) | ((np.abs(X) > LARGEST) & ~opaque)
        if not wrong.any():
            return
        frame, column = np.argwhere(wrong)[0]
        value = X[frame, column]
        raise FormatError(
            "a value is too large for a motion" if np.isfinite(value) else "a value is not a number",
            at=f"frame {frame}, column {self.skeleton.columns[column].name}",
            wanted=f"at most {LARGEST:g} in size" if np.isfinite(value) else "a finite number",
            got=f"{value:g}",
        )

    @property
    def n_frames(self) -> int:
        """The number of poses F; the paper's n, the rows of d, is one less."""
        return len(self.X)

    @property
    def duration_s(self) -> float:
        """The time from the first frame to the end of the last, in seconds."""
        return self.n_frames / self.fps

    def with_values(self, X: FloatArray) -> Motion:
        """Return this motion with other values (n_frames, n_columns); a mask is kept if it still fits."""
        mask = self.mask if self.mask is not None and self.mask.shape == X.shape else None
        return replace(self, X=X, mask=mask)

    def scaled(self, factor: float) -> Motion:
        """Return this motion with every length, of skeleton and translations alike, multiplied by `factor`."""
        X = self.X.copy()
        columns = [i for i, c in enumerate(self.skeleton.columns) if c.kind is ColumnKind.TRANSLATION]
        X[:, columns] *= factor
        return replace(self, skeleton=self.skeleton.scaled(factor), X=X)


def _read_only(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    if not array.flags.writeable:
        return array
    own = array.copy()  # a view would change with the caller's array
    own.flags.writeable = False
    return own
