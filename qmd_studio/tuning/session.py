"""One motion under the sliders: what does not change from tick to tick is kept."""

from __future__ import annotations

import time

import numpy as np

from qmd_studio.codecs.qmd import container, payload
from qmd_studio.codecs.qmd.encode import EncodedMatrix, encode_matrix
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown, payload_size
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import codec_matrix, motion_matrix
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.report import EncodeReport


class TuningSession:
    """The motion `motion`, ready to be encoded again and again.

    `size` answers at once on any thread; `evaluate` may be called from one thread at a time.
    Raises `CodecError` where the motion cannot be encoded at all.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self._matrix = codec_matrix(motion)
        self._levels = np.array(motion.skeleton.levels, dtype=np.int64)
        self._block = pack_skeleton_block(motion)

    @property
    def skeleton_bytes(self) -> int:
        """The bytes of the block that carries skeleton and names, the same for all settings."""
        return len(self._block)

    def size(self, settings: QmdSettings) -> SizeBreakdown:
        """Return the size of the payload that `settings` give, by formula; raises `CodecError` for bad settings."""
        settings = self._checked(settings)
        n_frames, n_columns = self._matrix.shape
        return payload_size(n_frames - 1, n_columns, settings.fdf, settings.bits, settings.segment)

    def file_bytes(self, settings: QmdSettings) -> int:
        """Return the size of the whole file that `settings` give, by formula."""
        return container.HEADER.size + self.size(settings).bytes + len(self._block)

    def evaluate(self, settings: QmdSettings) -> EncodeReport:
        """Encode, decode and measure; raises `CodecError` for bad settings."""
        started = time.perf_counter()
        settings = self._checked(settings)
        encoded = encode_matrix(self._matrix, self._levels, settings)
        decoded = self._decoded(encoded)
        error = measure(self.motion, decoded)
        return EncodeReport(
            settings=settings,
            size=self.size(settings),
            file_bytes=self.file_bytes(settings),
            error=error,
            seconds=time.perf_counter() - started,
            _assemble=lambda: self._file(encoded, settings),
            _decode=lambda: decoded,
        )

    def _checked(self, settings: QmdSettings) -> QmdSettings:
        return settings.checked(self.motion.skeleton.n_columns, self.motion.n_frames - 1)

    def _file(self, encoded: EncodedMatrix, settings: QmdSettings) -> bytes:
        return container.build(payload.pack(encoded.payload), self._block, self.motion.fps, settings)

    def _decoded(self, encoded: EncodedMatrix) -> Motion:
        return self.motion.with_values(motion_matrix(encoded.decoded.T, self.motion.skeleton))
