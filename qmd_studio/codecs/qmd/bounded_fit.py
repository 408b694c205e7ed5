"""A stretch of a motion under a bound: encoded, measured as it goes, its table refined where it is too far off."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from threading import Event

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.codecs.qmd import payload, tables
from qmd_studio.codecs.qmd.choice import Choose, chooser
from qmd_studio.codecs.qmd.payload import Segment
from qmd_studio.codecs.qmd.settings import MIN_BITS
from qmd_studio.codecs.qmd.size import SEGMENT_HEADER_BYTES, payload_size
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.errors import Cancelled
from qmd_studio.motion.fast_kinematics import point_positions_64
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.sensitivity import column_sensitivities
from qmd_studio.motion.skeleton import Skeleton

_POWER, _UNIFORM_SHARE = 0.4, 0.05
"""Of the table's density: nearer to what the largest error wants than the default encoder's."""

_HOPELESS = 8.0
"""An error so many times the bound will not be refined away."""

_ROWS_AT_ONCE = 128
"""Measured after so many rows: a stretch that breaks the bound early costs little."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """How many leading columns are kept as numbers, and the bits of an index."""

    fdf: int
    bits: int = MIN_BITS


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A segment within the bound, and the `pose` (n_columns,) float32 at which its decoder ends."""

    segment: Segment
    pose: Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """What one choice of indices came to: `errors_mm` (rows,) is each frame's largest, `decoded` (m, 1 + rows)."""

    segment: Segment
    decoded: Float32Array
    errors_mm: FloatArray


class Fitter:
    """The motion `matrix` (n_frames, n_columns), float32 radians and ASF units, held to `max_error_mm`.

    `first_pose` (n_columns,) is where every decoder starts. Once `cancel` is set every fit raises `Cancelled`.
    """

    def __init__(
        self, matrix: Float32Array, skeleton: Skeleton, max_error_mm: float, cancel: Event | None = None
    ) -> None:
        self.max_error_mm = max_error_mm
        self.n_rows: int = len(matrix) - 1
        self.n_columns = skeleton.n_columns
        self.first_pose: Float32Array = matrix[0]
        self._matrix, self._skeleton, self._cancel = matrix, skeleton, cancel
        self._places = point_positions_64(skeleton, motion_matrix(matrix, skeleton))
        self._limit_mm = max_error_mm - self._rounding_mm
        self._chooser = lru_cache(maxsize=None)(self._make_chooser)

    def size(self, fdf: int, bits: int, n_segments: int) -> int:
        """Return the bytes of a payload of `n_segments` segments."""
        single = payload_size(self.n_rows, self.n_columns, fdf, bits).bytes
        return single + (n_segments - 1) * (SEGMENT_HEADER_BYTES + 4 * (1 << bits))

    def best_reachable_mm(self) -> float:
        """Return the largest error that is left where all columns are kept as numbers."""
        run = self._run(Recipe(self.n_columns), slice(0, self.n_rows), self.first_pose, np.zeros(256, np.float32))
        return float(run.errors_mm.max(initial=0.0)) + self._rounding_mm

    def fit(self, recipe: Recipe, start: int, stop: int, pose: Float32Array, attempts: int) -> Fit | None:
        """Return rows `start` to `stop` - 1 within the bound, from where the decoder stands, or None.

        After an attempt that fails the table is refined, with more weight to the frames that are too far off.
        """
        rows = slice(start, stop)
        values = np.diff(self._matrix[start : stop + 1, recipe.fdf :], axis=0)
        table = tables.companded_table(values, bits=recipe.bits, power=_POWER, uniform_share=_UNIFORM_SHARE)
        frame_weight = np.ones(stop - start)
        for attempt in range(attempts):
            last = attempt == attempts - 1
            run = self._run(recipe, rows, pose, table, give_up_mm=(1.0 if last else _HOPELESS) * self._limit_mm)
            if self._holds(run):
                return Fit(run.segment, run.decoded[:, -1].copy())
            if last or len(run.errors_mm) < stop - start or recipe.fdf == self.n_columns:
                break
            frame_weight *= np.clip(run.errors_mm / (0.5 * self._limit_mm), 0.3, 3.0)
            lacking = self._matrix[start + 1 : stop + 1, recipe.fdf :] - run.decoded[recipe.fdf :, :-1].T
            weights = self._sensitivities[start + 1 : stop + 1, recipe.fdf :] * frame_weight[:, np.newaxis]
            table = tables.refined_table(table, lacking, weights)
        return None

    def plain_fit(self, recipe: Recipe, start: int, stop: int, pose: Float32Array, *, by_joints: bool) -> Fit | None:
        """Return these rows as the other encoders would have them, where that is within the bound."""
        values = np.diff(self._matrix[start : stop + 1, recipe.fdf :], axis=0)
        table = tables.companded_table(values, bits=recipe.bits)
        rows = slice(start, stop)
        run = self._run(recipe, rows, pose, table, give_up_mm=self._limit_mm, by_joints=by_joints)
        return Fit(run.segment, run.decoded[:, -1].copy()) if self._holds(run) else None

    def _holds(self, run: _Run) -> bool:
        return len(run.errors_mm) == run.segment.n_rows and bool((run.errors_mm <= self._limit_mm).all())

    def _run(
        self,
        recipe: Recipe,
        rows: slice,
        pose: Float32Array,
        table: Float32Array,
        *,
        give_up_mm: float = np.inf,
        by_joints: bool = True,
    ) -> _Run:
        """Choose the indices of `rows`, and stop after the first rows that are further off than `give_up_mm`."""
        n_rows = rows.stop - rows.start
        exact = np.empty((n_rows, recipe.fdf), np.float32)
        indices = np.empty((n_rows, self.n_columns - recipe.fdf), payload.index_type(recipe.bits))
        decoded = np.empty((self.n_columns, n_rows + 1), np.float32)
        decoded[:, 0] = pose
        middles, state, choose = tables.middles(table), pose.copy(), self._chooser(recipe.fdf, by_joints)
        errors: list[FloatArray] = []
        for at in range(0, n_rows, _ROWS_AT_ONCE):
            if self._cancel is not None and self._cancel.is_set():
                raise Cancelled("the search for a bounded file was stopped")
            end = min(at + _ROWS_AT_ONCE, n_rows)
            part = self._matrix[rows.start + at : rows.start + end + 1]
            there = decoded[:, at + 1 : end + 1]
            choose(part, table, middles, state, exact[at:end], indices[at:end], there)
            errors.append(self._errors_mm(there, rows.start + at + 1))
            if not errors[-1].max() <= give_up_mm:
                break
        segment = Segment(recipe.bits, table, exact, indices)
        return _Run(segment, decoded, np.concatenate([np.zeros(0), *errors]))

    def _errors_mm(self, decoded: Float32Array, first_frame: int) -> FloatArray:
        """Return the largest error of each frame of `decoded` (n_columns, frames), in millimetres."""
        places = point_positions_64(self._skeleton, motion_matrix(decoded.T, self._skeleton))
        away = places - self._places[first_frame : first_frame + decoded.shape[1]]
        errors: FloatArray = 1000.0 * np.sqrt(np.einsum("fpa,fpa->fp", away, away).max(axis=1))
        return errors

    def _make_chooser(self, fdf: int, by_joints: bool) -> Choose:
        return chooser(self._skeleton, fdf, 1 if by_joints else None)

    @cached_property
    def _sensitivities(self) -> FloatArray:
        return column_sensitivities(self._skeleton, self._matrix.astype(np.float64))

    @cached_property
    def _rounding_mm(self) -> float:
        """What float32 may have moved a point by in the matrix itself: no less than it did, in all columns together."""
        half_steps = np.spacing(np.abs(self._matrix)).astype(np.float64) / 2
        moved = (np.sqrt(self._sensitivities) * half_steps).sum(axis=1)
        return float(moved.max()) * ASF_UNIT_M * 1000.0
