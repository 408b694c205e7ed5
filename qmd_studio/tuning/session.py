"""One motion under the sliders: what does not change from tick to tick is kept."""

from __future__ import annotations

import time
from functools import cached_property
from threading import Event

import numpy as np

from qmd_studio.arrays import BoolArray, Float32Array, FloatArray
from qmd_studio.codecs.qmd import container, payload
from qmd_studio.codecs.qmd.decode import decode_payload
from qmd_studio.codecs.qmd.encode import encode_matrix, size_of
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import codec_matrix, column_scales, motion_matrix
from qmd_studio.motion.metrics import MotionError
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import ColumnKind, Skeleton
from qmd_studio.tuning.report import EncodeReport


class TuningSession:
    """The motion `motion`, ready to be encoded again and again.

    `size` answers at once on any thread; `evaluate` may be called from one thread at a time.
    Raises `CodecError` where the motion cannot be encoded at all.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self._matrix = codec_matrix(motion)
        self._block = pack_skeleton_block(motion)
        self._lengths = np.flatnonzero(column_scales(motion.skeleton) != 1.0)
        self._origin = np.where(moves_all(motion.skeleton), self._matrix[0], np.float32(0))

    @property
    def skeleton_bytes(self) -> int:
        """The bytes of the block that carries skeleton and names, the same for all settings."""
        return len(self._block)

    def size(self, settings: QmdSettings) -> SizeBreakdown:
        """Return the size of the payload that `settings` give, by formula.

        Raises `CodecError` for bad settings, and for the bounded encoder: its size is not known before it has run.
        """
        return size_of(self.motion, self._checked(settings))

    def file_bytes(self, settings: QmdSettings) -> int:
        """Return the size of the whole file that `settings` give, by formula."""
        return container.HEADER.size + self.size(settings).bytes + len(self._block)

    def evaluate(self, settings: QmdSettings, *, draft: bool = False, cancel: Event | None = None) -> EncodeReport:
        """Encode, decode and measure; raises `CodecError` for bad settings and for a bound that cannot be met.

        The bounded encoder raises `Cancelled` soon after `cancel` is set; the others are done before anyone would.

        A `draft` takes less time, for a slider that is being dragged: same size, a little more error. It is as true of
        its own bytes as any report; but what is exported is not to be a draft.
        """
        started = time.perf_counter()
        settings = self._checked(settings)
        encoded = encode_matrix(self._matrix, self.motion.skeleton, settings, draft=draft, cancel=cancel)
        error = self.measured(encoded.decoded)
        contents = encoded.payload
        return EncodeReport(
            settings=settings,
            size=contents.size,
            file_bytes=container.HEADER.size + contents.size.bytes + len(self._block),
            error=error,
            seconds=time.perf_counter() - started,
            draft=draft and settings.encoder is Encoder.CLOSED,
            _assemble=lambda: container.build(payload.pack(contents), self._block, self.motion.fps, settings),
            _decode=lambda: self.motion.with_values(motion_matrix(decode_payload(contents), self.motion.skeleton)),
        )

    def _checked(self, settings: QmdSettings) -> QmdSettings:
        return settings.checked(self.motion.skeleton.n_columns, self.motion.n_frames - 1)

    @cached_property
    def _positions(self) -> Float32Array:
        """Where the measured points of the original are, (3 * n_points, n_frames) metres."""
        from qmd_studio.motion.fast_kinematics import columns_first, point_positions_32

        origin = self._origin.astype(np.float64) * column_scales(self.motion.skeleton)
        return point_positions_32(self.motion.skeleton, columns_first(self.motion.X - origin))

    def measured(self, decoded: Float32Array) -> MotionError:
        """Measure `decoded` (n_columns, n_frames), radians and ASF units, against the original."""
        metres = decoded.copy()
        metres[self._lengths] -= self._origin[self._lengths, np.newaxis]
        metres[self._lengths] *= np.float32(ASF_UNIT_M)
        return self._against_original(metres)

    def measured_poses(self, X: FloatArray) -> MotionError:
        """Measure `X` (n_frames, n_columns), radians and metres, against the original."""
        from qmd_studio.motion.fast_kinematics import columns_first  # compiled code, loaded where it is needed

        return self._against_original(columns_first(X - self._origin * column_scales(self.motion.skeleton)))

    def _against_original(self, metres: Float32Array) -> MotionError:
        """Measure (n_columns, n_frames) radians and metres from the first pose's place on."""
        from qmd_studio.motion.fast_kinematics import point_positions_32
        from qmd_studio.motion.fast_metrics import measure_positions

        positions = point_positions_32(self.motion.skeleton, metres)
        return measure_positions(self.motion.skeleton, self._positions, positions, fps=self.motion.fps)


def moves_all(skeleton: Skeleton) -> BoolArray:
    """Return which columns (n_columns,) only move everything along: positions are measured from their first values.

    Single precision is then as good far from the world's origin as near it.
    """
    roots = {index for index, joint in enumerate(skeleton.joints) if joint.parent < 0}
    return np.array([c.kind is ColumnKind.TRANSLATION and c.joint in roots for c in skeleton.columns], dtype=np.bool_)
