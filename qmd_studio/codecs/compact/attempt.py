"""One encoding tried and measured, and how far apart its key poses had best be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.codecs.compact.encode import CompactEncoder, EncodedPayload
from qmd_studio.codecs.compact.layout import BLOCK
from qmd_studio.codecs.compact.payload import pack
from qmd_studio.codecs.compact.progress import Watch
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.motion.motion import Motion

_BLOCKS = (10, 12, 14, 16, 20, 24, 32, 40)
_SAMPLE = 4000
"""In a longer motion, blocks are tried on so many frames in its middle."""

_SLOPE = 0.6
"""About what share a relative change of the error is of one of the bytes."""


class Meter:
    """Measures decoded matrices against the motion that they were made from."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion

    def distances_mm(self, decoded: Float32Array) -> FloatArray:
        """Return (n_frames, n_points) how far the points of `decoded` are from where they should be."""
        from qmd_studio.motion.fast_kinematics import point_positions_64  # compiled code, loaded where it is needed

        skeleton, n_frames = self._motion.skeleton, self._motion.n_frames
        distances = np.empty((n_frames, len(skeleton.points)))
        for start in range(0, n_frames, _SAMPLE):  # a piece at a time, so that a million frames fit into memory
            span = slice(start, start + _SAMPLE)
            error = point_positions_64(skeleton, motion_matrix(decoded[span], skeleton))
            error -= point_positions_64(skeleton, self._motion.X[span])
            distances[span] = 1000 * np.sqrt(np.einsum("fpi,fpi->fp", error, error))
        return distances


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """An encoding, its errors in millimetres, (n_frames,) the largest of each frame, and how it was made."""

    encoded: EncodedPayload
    payload: bytes
    mean_mm: float
    frame_mm: FloatArray
    fineness: float
    weights: FloatArray | None = None

    @property
    def max_mm(self) -> float:
        """The largest error of any point in any frame."""
        return float(self.frame_mm.max())

    @property
    def worth(self) -> float:
        """What attempts of nearly one error are compared by, less being better."""
        return math.log(len(self.payload)) + _SLOPE * math.log(max(self.mean_mm, 1e-12))


def attempt(
    encoder: CompactEncoder, meter: Meter, fineness: float, watch: Watch, weights: FloatArray | None = None
) -> Attempt:
    """Return one encoding and what it comes to."""
    encoded = encoder.encode(fineness, weights, watch.cancel)
    distances = meter.distances_mm(encoded.decoded)
    return Attempt(encoded, pack(encoded.payload), float(distances.mean()), distances.max(axis=1), fineness, weights)


def with_block(
    motion: Motion, settings: CompactSettings, target_mm: float, guess: float, watch: Watch
) -> tuple[CompactSettings, float]:
    """Return `settings` with the distance of key poses that makes a motion smallest, and a better guess of fineness."""
    sample = motion
    if motion.n_frames > _SAMPLE:
        start = (motion.n_frames - _SAMPLE) // 2
        sample = motion.with_values(motion.X[start : start + _SAMPLE])
    meter = Meter(sample)
    settings = replace(settings, segment=0 if settings.segment >= sample.n_frames else settings.segment)

    def tried(block: int, fineness: float) -> Attempt:
        return attempt(CompactEncoder(sample, replace(settings, block=block)), meter, fineness, watch)

    first = tried(BLOCK, guess)
    error = first.mean_mm if settings.mean_error_mm is not None else first.max_mm
    guess *= float(np.clip(target_mm / max(error, 1e-12), 0.1, 8.0))
    at = _BLOCKS.index(BLOCK)
    worth = {at: tried(BLOCK, guess).worth}
    for way in (-1, 1):
        while 0 <= at + way < len(_BLOCKS):
            if at + way not in worth:
                worth[at + way] = tried(_BLOCKS[at + way], guess).worth
            if worth[at + way] >= worth[at]:
                break
            at += way
    return replace(settings, block=_BLOCKS[at]), guess
