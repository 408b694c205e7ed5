"""Motion to the compact profile: one encoding at a given fineness. The search for a target is `target`'s."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy.fft import dst
from scipy.linalg import cholesky

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.codecs.compact.layout import BLOCK
from qmd_studio.codecs.compact.payload import Payload
from qmd_studio.codecs.compact.prior import prior
from qmd_studio.codecs.compact.progress import stop_if
from qmd_studio.codecs.compact.sensitivity import (
    FrameMatrices,
    Sensitivity,
    relative_steps,
    sensitivities,
    step_codes,
)
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.units import codec_matrix, column_scales
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion

_RATE = 0.15
"""The price of a bit, in squared steps of a column of sensitivity one."""

_LARGEST = 1e8
"""The largest value that the coarsest step can hold with six digits."""


@dataclass(frozen=True, slots=True, eq=False)
class EncodedPayload:
    """A payload and what every decoder makes of it, (n_frames, n_columns) float32 radians and ASF units."""

    payload: Payload
    decoded: Float32Array


class CompactEncoder:
    """A motion made ready to be encoded again and again at different finenesses.

    Raises `CodecError` for a motion without columns and for values that no step can hold.
    """

    def __init__(self, motion: Motion, settings: CompactSettings) -> None:
        self.motion = motion
        checked = settings.checked(motion.n_frames)
        self.settings = checked
        self.block = BLOCK if checked.block is None else checked.block
        self._matrix = codec_matrix(motion).astype(np.float64)
        if not self._matrix.shape[1]:
            raise CodecError("the motion has no column to encode", hint="Open a motion whose joints move")
        self._largest = np.abs(self._matrix).max(axis=0)
        if self._largest.max() > _LARGEST:
            column = motion.skeleton.columns[int(self._largest.argmax())].name
            raise CodecError(
                "a value is too large for a compact file",
                at=f"column {column}",
                wanted=f"at most {_LARGEST:g} in size",
                got=f"{self._largest.max():g}",
                hint="Use the profile of version 1",
            )

    @cached_property
    def _scaled(self) -> FloatArray:
        return self.motion.X / column_scales(self.motion.skeleton)

    @cached_property
    def _parts(self) -> tuple[Sensitivity, ...]:
        return sensitivities(self.motion, segment=self.settings.segment, block=self.block)

    @cached_property
    def _relative_steps(self) -> FloatArray:
        return relative_steps(self._parts)

    def encode(
        self, fineness: float, weights: FloatArray | None = None, cancel: threading.Event | None = None
    ) -> EncodedPayload:
        """Encode with steps of `fineness` ASF units of effect on the joints.

        `weights` (n_frames,) say how much more than usual a frame's squared error counts against its bytes. Raises
        `EncodingCancelledError` soon after `cancel` is set.
        """
        from qmd_studio.codecs.compact.stream import write_prelude, write_segment
        from qmd_studio.codecs.compact.synthesis import step_sizes, synthesise

        codes = step_codes(fineness * self._relative_steps, self._largest)
        steps = step_sizes(codes)
        decoded = np.empty(self._matrix.shape, np.float32)
        streams, pose = [], np.zeros(len(codes), np.int64)
        weights = np.ones(len(decoded)) if weights is None else weights
        for number, part in enumerate(self._parts):
            span = slice(part.start, part.end)
            minds = FrameMatrices(self.motion, self._scaled[span])
            keys, rows = _integers(self._matrix[span], part, minds, steps, _RATE * fineness**2, weights[span], cancel)
            if number == 0:
                pose = keys[0]
            streams.append(bytes(write_segment(prior(), pose, part.at, keys, rows, number == 0)))
            decoded[part.start : part.end] = synthesise(part.at, keys, rows, steps)
        payload = Payload(
            n_frames=len(decoded),
            n_columns=len(codes),
            segment=self.settings.segment,
            block=self.block,
            prelude=bytes(write_prelude(prior(), codes, pose)),
            streams=tuple(streams),
        )
        return EncodedPayload(payload, decoded)


def _integers(
    matrix: FloatArray,
    part: Sensitivity,
    minds: FrameMatrices,
    steps: Float32Array,
    rate: float,
    weights: FloatArray,
    cancel: threading.Event | None,
) -> tuple[IntArray, IntArray]:
    """Return the key poses (k, m) in half steps and the coefficients (rows, m) of one segment."""
    from qmd_studio.codecs.compact.choices import choose_rows, nearest_plane
    from qmd_studio.codecs.compact.model import new_cells
    from qmd_studio.codecs.compact.refine import error_between, refine_rows
    from qmd_studio.codecs.compact.stream import new_sizes

    step = steps.astype(np.float64)
    at = part.at
    keys = np.array([nearest_plane(matrix[t], step / 2, cholesky(minds.between(t, t)[0], lower=True)) for t in at])
    cells, bits = new_cells(prior()), _bits()
    before, sizes = new_sizes(at, len(step)), new_sizes(at, len(step))
    rows = [np.zeros((0, len(step)), np.int64)]
    for i in range(1, len(at)):
        start, end = int(at[i - 1]), int(at[i])
        if end - start < 2:
            continue
        stop_if(cancel)
        coefficients = _coefficients(matrix[start : end + 1], keys[i - 1 : i + 1] * (step / 2))
        known = (before, sizes, i > 1, keys[i] - keys[i - 1])
        H, lower = part.blocks[i - 1], cholesky(part.blocks[i - 1], lower=True)
        inner = weights[start + 1 : end]
        block = choose_rows(coefficients, step, lower, H, rate / inner.mean(), cells.copy(), bits, known)
        error = error_between(block, coefficients, step)
        refine_rows(block, error, minds.between(start, end), inner, step, rate, cells, bits, known)
        rows.append(block)
        before, sizes = sizes, before
    return keys, np.concatenate(rows)


def _coefficients(poses: FloatArray, keys: FloatArray) -> FloatArray:
    """Return (frames between, m) the sines of a block that lie on the ramp between its keys."""
    along = (np.arange(1, len(poses) - 1) / (len(poses) - 1))[:, np.newaxis]
    ramp = keys[0] * (1 - along) + keys[1] * along
    return np.ascontiguousarray(dst(poses[1:-1] - ramp, type=1, axis=0, norm="ortho"))


@cache
def _bits() -> FloatArray:
    """Return (257,) the bits of a decision whose probability is that many 256ths."""
    bits: FloatArray = -np.log2(np.clip(np.arange(257) / 256, 1 / 512, 511 / 512))
    return bits
