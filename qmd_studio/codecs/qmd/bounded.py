"""The bounded encoder: the fewest bytes found that keep every measured point within a distance of where it was.

Any file of the format will do, so there is room: columns kept as numbers, finer tables, further segments. Rungs of a
ladder are climbed from the fewest bytes upward, each refining its table where the error is too large, then splitting
the motion where one table does not do; whatever a plain grid offers for fewer bytes than what was found is tried last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from heapq import merge
from threading import Event

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd.bounded_fit import Fit, Fitter, Recipe
from qmd_studio.codecs.qmd.payload import Payload, Segment
from qmd_studio.codecs.qmd.settings import MAX_BITS, MIN_BITS
from qmd_studio.errors import CodecError
from qmd_studio.motion.skeleton import Skeleton

_RUNGS = (0, 3, 6, 9, 12, 16, 20, 26, 34, 46)
_REFITS = 4
_REFITS_OF_A_PART = 2
_FINER_BITS = (9, 10, 11, 12)
_SHRINK = 0.6
_SHORTEST = 20
"""Rows: splitting further costs more in tables than it saves."""

_GRID_STEP = 30
"""The grid's segments take multiples of so many rows."""


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    n_bytes: int
    segments: tuple[Segment, ...]


def encode_bounded(
    matrix: Float32Array, skeleton: Skeleton, max_error_mm: float, cancel: Event | None = None
) -> Payload:
    """Encode (n_frames, n_columns) float32 radians and ASF units; every point stays within `max_error_mm`.

    The payload takes no more bytes than the best of a grid that meets the bound too: every FDF, every b, segments of
    any multiple of 30 rows and a single one, by either closed loop. Raises `CodecError` with the best bound that can
    be met where this one cannot, and where there is nothing to measure at; `Cancelled` soon after `cancel` is set.
    """
    if not skeleton.points:
        raise CodecError("the skeleton has no points to hold to a bound", hint="Choose another encoder")
    fitter = Fitter(matrix, skeleton, max_error_mm, cancel)
    best = _climbed(fitter)
    return Payload(matrix[0], _below(fitter, best).segments)


def _climbed(fitter: Fitter) -> _Found:
    """Climb the ladder; at its top all columns are kept as numbers, which meets any bound that float32 can."""
    n_columns = fitter.n_columns
    best = _whole(fitter, Recipe(n_columns), 1)
    if best is None:
        reachable = f"{1.01 * fitter.best_reachable_mm():.2g} mm"
        raise CodecError(
            "no QMD file of this motion keeps that bound",
            wanted=f"every joint within {fitter.max_error_mm:g} mm",
            got=f"{reachable} as the best that can be reached",
            hint="Allow that much",
        )
    for fdf in (rung for rung in _RUNGS if rung < n_columns):
        if fitter.size(fdf, MIN_BITS, 1) >= best.n_bytes:
            break
        found = _whole(fitter, Recipe(fdf), _REFITS)
        if found is not None:
            best = found
            break  # the next rung takes more bytes than this one with a single table
        best = _split(fitter, Recipe(fdf), best) or best
    for bits in _FINER_BITS:
        if fitter.size(0, bits, 1) >= best.n_bytes:
            break
        found = _whole(fitter, Recipe(0, bits), _REFITS_OF_A_PART)
        if found is not None:
            return found
    return best


def _whole(fitter: Fitter, recipe: Recipe, attempts: int) -> _Found | None:
    """Return the motion as one segment where that meets the bound."""
    fit = fitter.fit(recipe, 0, fitter.n_rows, fitter.first_pose, attempts)
    return None if fit is None else _Found(fitter.size(recipe.fdf, recipe.bits, 1), (fit.segment,))


def _split(fitter: Fitter, recipe: Recipe, best: _Found) -> _Found | None:
    """Return the motion in segments, each as long as the bound lets it be, where that takes less than `best`."""
    segments: list[Segment] = []
    start, pose, length = 0, fitter.first_pose, fitter.n_rows
    while start < fitter.n_rows:
        if fitter.size(recipe.fdf, recipe.bits, len(segments) + 1) >= best.n_bytes:
            return None
        fit, length = _longest(fitter, recipe, start, pose, length)
        if fit is None:
            return None
        segments.append(fit.segment)
        start, pose = start + length, fit.pose
        length = int(length / _SHRINK**2)
    return _Found(fitter.size(recipe.fdf, recipe.bits, len(segments)), tuple(segments))


def _longest(fitter: Fitter, recipe: Recipe, start: int, pose: Float32Array, length: int) -> tuple[Fit | None, int]:
    """Return the fit of as many rows from `start` on, `length` at most, as meet the bound, and how many these are."""
    length = min(length, fitter.n_rows - start)
    while True:
        fit = fitter.fit(recipe, start, start + length, pose, _REFITS_OF_A_PART)
        if fit is not None or length <= _SHORTEST:
            return fit, length
        length = max(int(length * _SHRINK), _SHORTEST)


def _below(fitter: Fitter, best: _Found) -> _Found:
    """Return the smallest setting of the plain grid that meets the bound with fewer bytes than `best`, or `best`."""
    for n_bytes, recipe, step in _grid(fitter, best.n_bytes):
        for by_joints in (True, False):
            segments = _evenly(fitter, recipe, step, by_joints=by_joints)
            if segments is not None:
                return _Found(n_bytes, segments)
    return best


def _grid(fitter: Fitter, limit: int) -> Iterator[tuple[int, Recipe, int]]:
    """Yield what the grid offers below `limit` bytes, the smallest first: bytes, recipe, rows of a segment."""
    lanes = (
        _lane(fitter, limit, Recipe(fdf, bits))
        for fdf in range(fitter.n_columns + 1)
        for bits in range(MIN_BITS, MAX_BITS + 1)
    )
    for n_bytes, fdf, bits, minus_step in merge(*lanes):
        yield n_bytes, Recipe(fdf, bits), -minus_step


def _lane(fitter: Fitter, limit: int, recipe: Recipe) -> Iterator[tuple[int, int, int, int]]:
    """Yield bytes, FDF, b and the rows of a segment (less than 0, to be in order) of one recipe, ascending."""
    n_rows = max(fitter.n_rows, 1)
    for step in (n_rows, *range((n_rows - 1) // _GRID_STEP * _GRID_STEP, 0, -_GRID_STEP)):
        n_bytes = fitter.size(recipe.fdf, recipe.bits, -(-n_rows // step))
        if n_bytes >= limit:
            return
        yield n_bytes, recipe.fdf, recipe.bits, -step


def _evenly(fitter: Fitter, recipe: Recipe, step: int, *, by_joints: bool) -> tuple[Segment, ...] | None:
    """Return the motion in segments of `step` rows, with the tables of the other encoders, if it meets the bound."""
    segments: list[Segment] = []
    pose = fitter.first_pose
    for start in range(0, max(fitter.n_rows, 1), step):
        fit = fitter.plain_fit(recipe, start, min(start + step, fitter.n_rows), pose, by_joints=by_joints)
        if fit is None:
            return None
        segments.append(fit.segment)
        pose = fit.pose
    return tuple(segments)
