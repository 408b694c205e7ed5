"""Trying thousands of settings on one motion: what they share is made once.

The values that are quantised are sorted once for the whole motion, their order within segments once for each
segmentation, and only the joints that a setting can move are computed.
"""

from __future__ import annotations

import threading
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import Float32Array, IntArray
from qmd_studio.codecs.qmd import tables
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.codecs.qmd.units import codec_matrix, column_scales
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.encoders import FAST_ENCODERS
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.restorer import Restorer
from qmd_studio.tuning.session import moves_all
from qmd_studio.tuning.trial import Evaluator, Trial

_MOST_VALUES_AT_ONCE = 1 << 22
"""Decoded values that are held while one FDF and segmentation are tried: 16 MB, or one index width's worth."""

_SEGMENTATIONS_KEPT = 4

_BYTES_A_VALUE = 75
"""Memory that a search takes for each value of the motion, at its peak (measured)."""

_ALWAYS_FITS = 1 << 20
"""Motions of fewer values are not worth asking for."""


def evaluator_for(motion: Motion, base: QmdSettings, reduction: Reduction | None = None) -> Evaluator:
    """Return the fastest way to try settings of `base`'s encoder on what `reduction` leaves of `motion`.

    Errors are against all of it. Raises `CodecError` where the motion cannot be encoded, or has nothing to measure at.
    """
    if not motion.skeleton.points or not motion.skeleton.n_columns:
        raise CodecError("there is nothing to tune", wanted="a motion with columns and joints to measure at")
    _check_memory(motion)
    kind = FastEvaluator if base.encoder in FAST_ENCODERS else SessionEvaluator
    return kind(motion, base, reduction)


def _check_memory(motion: Motion) -> None:
    """Raise `CodecError` where what a search keeps of the motion would not fit: a machine that swaps answers nobody."""
    if motion.X.size < _ALWAYS_FITS:
        return
    import psutil

    wanted, free = _BYTES_A_VALUE * motion.X.size, psutil.virtual_memory().available
    if wanted > free:
        raise CodecError(
            "there is not enough memory to search on this motion",
            wanted=f"about {wanted / 1e9:.1f} GB",
            got=f"{free / 1e9:.1f} GB free",
            hint="Take a part of the motion, or close other programs",
        )


class SessionEvaluator:
    """An `Evaluator` for any encoder: each setting is encoded whole, one at a time."""

    is_fast = False

    def __init__(self, motion: Motion, base: QmdSettings, reduction: Reduction | None = None) -> None:
        reduction = reduction or Reduction()
        self._session = ReducedSession(motion, reduction)
        self.original, self.motion = motion, self._session.reduced
        self.base, self.reduction = base, reduction
        self._turn = threading.Lock()

    def size(self, fdf: int, bits: int, segment: int) -> int:
        """Return the payload's bytes, by formula."""
        return self._session.size(replace(self.base, fdf=fdf, bits=bits, segment=segment)).bytes

    def try_bits(self, fdf: int, segment: int, bits: tuple[int, ...]) -> list[Trial]:
        """Try one FDF and one segment length at several index widths."""
        trials = []
        for width in bits:
            with self._turn:
                report = self._session.evaluate(replace(self.base, fdf=fdf, segment=segment, bits=width))
            error = report.error
            settings = EncodeSettings(report.settings, self.reduction)
            trials.append(Trial(settings, report.size.bytes, error.def_, error.mean_mm, error.max_mm))
        return trials


class FastEvaluator:
    """An `Evaluator` for the encoders of `FAST_ENCODERS`. Its first trial compiles; it may be used by many threads."""

    is_fast = True

    def __init__(self, motion: Motion, base: QmdSettings, reduction: Reduction | None = None) -> None:
        from qmd_studio.tuning import encode_kernels  # compiled code, loaded where it is first needed

        self.original, self.base, self.reduction = motion, base, reduction or Reduction()
        motion = self.reduction.reduce(motion)
        self.motion = motion
        self._kernels = encode_kernels
        self._is_paper = base.encoder is Encoder.PAPER
        self._matrix = codec_matrix(motion)
        self._differences = np.diff(self._matrix, axis=0)
        scales = column_scales(motion.skeleton)
        origin = np.where(moves_all(motion.skeleton), self._matrix[0], np.float32(0))
        self._units = (origin, scales.astype(np.float32))
        exact = np.empty(self._matrix.T.shape, np.float32)
        encode_kernels.exact_columns(np.ascontiguousarray(self._matrix.T), not self._is_paper, exact)
        self._exact = (exact - origin[:, np.newaxis]) * self._units[1][:, np.newaxis]
        self._measure_by(origin)
        self._prepare()
        self._ordered = lru_cache(maxsize=_SEGMENTATIONS_KEPT)(self._make_ordered)

    def size(self, fdf: int, bits: int, segment: int) -> int:
        """Return the payload's bytes, by formula."""
        n_frames, n_columns = self._matrix.shape
        return payload_size(n_frames - 1, n_columns, fdf, bits, segment).bytes

    def try_bits(self, fdf: int, segment: int, bits: tuple[int, ...]) -> list[Trial]:
        """Try one FDF and one segment length at several index widths."""
        n_frames, n_columns = self._matrix.shape
        settings = [
            replace(self.base, fdf=fdf, segment=segment, bits=width).checked(n_columns, n_frames - 1) for width in bits
        ]
        rows_each = settings[0].segment or max(n_frames - 1, 1)
        at_once = max(1, _MOST_VALUES_AT_ONCE // self._matrix.size)
        trials = []
        for start in range(0, len(settings), at_once):
            some = settings[start : start + at_once]
            decoded = self._paths(fdf, rows_each, np.array([s.bits for s in some], dtype=np.int64))
            for one, matrix in zip(some, decoded, strict=True):
                if self._restorer is None:
                    away = self._departure.measured(matrix, fdf)
                else:
                    away = self._departure.measured(self._restorer.restored(matrix), 0)
                size = self.size(one.fdf, one.bits, one.segment)
                trials.append(Trial(EncodeSettings(one, self.reduction), size, away.def_, away.mean_mm, away.max_mm))
        return trials

    def _measure_by(self, origin: Float32Array) -> None:
        """Make ready what measures decodings, which start from `origin` (n_columns,) in ASF units."""
        from qmd_studio.motion.departure import Departure  # compiled code
        from qmd_studio.motion.fast_kinematics import columns_first

        original, skeleton = self.original, self.original.skeleton
        moved = np.zeros(skeleton.n_columns)
        moved[self.reduction.kept_columns(skeleton)] = origin.astype(np.float64) * column_scales(self.motion.skeleton)
        values = columns_first(original.X - moved)
        self._restorer: Restorer | None = None
        if self.reduction == Reduction():
            self._departure = Departure(skeleton, values, self._exact)
        else:
            self._departure = Departure(skeleton, values, values)
            self._restorer = Restorer(original, self.reduction, values[:, 0].copy())

    def _prepare(self) -> None:
        """Sort what the encoder's tables are made from, once for all settings."""
        if self._is_paper:
            integers = np.rint(self._differences.astype(np.float64) * self.base.rqt)
            ranks = np.unique(integers, return_inverse=True)[1].reshape(integers.shape)
            self._ranks = np.ascontiguousarray(ranks.T, dtype=np.int32)
            self._values = np.ascontiguousarray(self._differences.T)
            levels = np.array(self.motion.skeleton.levels, dtype=np.int64)
            self._levels: IntArray = np.clip(levels, 1, MAX_LEVEL)
            self._weights = tables.relative_weights(self.base.k)
        else:
            self._order = np.argsort(self._differences, axis=None, kind="stable")

    def _make_ordered(self, rows_each: int) -> tuple[Float32Array, NDArray[np.int32]]:
        """Return all differences, ascending within each segment, and their columns."""
        ordered: Float32Array = np.empty(self._differences.size, np.float32)
        column: NDArray[np.int32] = np.empty(len(ordered), np.int32)
        self._kernels.by_segment(self._order, self._differences, rows_each, ordered, column)
        return ordered, column

    def _paths(self, fdf: int, rows_each: int, bits: IntArray) -> Float32Array:
        """Return what the decoder has, (len(bits), n_columns, n_frames) radians and metres from the first pose on."""
        n_frames, n_columns = self._matrix.shape
        decoded = np.empty((len(bits), n_columns, n_frames), np.float32)
        decoded[:, :fdf] = self._exact[:fdf]
        units = (self._units[0][fdf:], self._units[1][fdf:])
        there = decoded[:, fdf:]
        if self._is_paper:
            differences = (self._values[fdf:], self._ranks[fdf:])
            self._kernels.paper_paths(
                differences, self._levels[fdf:], self._matrix[0, fdf:], rows_each, bits, self._weights, units, there
            )
            return decoded
        ordered, column = self._ordered(rows_each)
        kept = np.empty((n_frames - 1) * (n_columns - fdf), np.float32)
        self._kernels.without_leading(ordered, column, fdf, kept)
        matrix = np.ascontiguousarray(self._matrix[:, fdf:])
        rules = (tables.MOST_INTERVALS, tables.UNIFORM_SHARE)
        self._kernels.closed_paths(matrix, kept, rows_each, bits, rules, units, there)
        return decoded
