"""The coarsest encoding that keeps to an error: the mean distance of all joints, or the largest in any frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.codecs.compact.encode import CompactEncoder, EncodedPayload
from qmd_studio.codecs.compact.payload import pack
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import ASF_UNIT_M, Motion

_MM_PER_UNIT = 1000 * ASF_UNIT_M
_ATTEMPTS = 14
_NEAR = 0.997
"""An encoding that uses up this much of the error it may make is good enough."""

_IMPATIENCE = 0.95
"""While nothing keeps to the target, each attempt goes that much further than proportion says: errors can stall."""

_FINEST = 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """An encoding that keeps to its target: the bytes of its payload, what they decode to, and its error.

    `fineness` is what `CompactEncoder.encode` takes to make it again.
    """

    payload: bytes
    decoded: Float32Array
    mean_mm: float
    max_mm: float
    fineness: float


def meet_target(motion: Motion, settings: CompactSettings) -> Outcome:
    """Return the smallest encoding found that keeps to the target of `settings`.

    Raises `CodecError` for a motion that cannot be encoded, for a skeleton without measured points, and where float32
    or the finest step cannot keep to the error: it says what can be reached.
    """
    if not motion.skeleton.points:
        raise CodecError("the skeleton has no points to measure at", hint="Use the profile of version 1")
    encoder = CompactEncoder(motion, settings)
    meter = Meter(motion)
    if settings.mean_error_mm is not None:
        return _search(encoder, meter, settings.mean_error_mm, worst=False)
    assert settings.max_error_mm is not None  # checked by the encoder
    return _search(encoder, meter, settings.max_error_mm, worst=True)


class Meter:
    """Measures decoded matrices against the motion that they were made from."""

    def __init__(self, motion: Motion) -> None:
        from qmd_studio.motion.fast_kinematics import point_positions_64  # compiled code, loaded where it is needed

        self._motion = motion
        self._positions = point_positions_64
        self._original = point_positions_64(motion.skeleton, motion.X)

    def distances_mm(self, decoded: Float32Array) -> FloatArray:
        """Return (n_frames, n_points) how far the points of `decoded` are from where they should be."""
        X = motion_matrix(decoded, self._motion.skeleton)
        error = self._positions(self._motion.skeleton, X) - self._original
        distances: FloatArray = 1000 * np.sqrt(np.einsum("fpi,fpi->fp", error, error))
        return distances


def _search(encoder: CompactEncoder, meter: Meter, target_mm: float, *, worst: bool) -> Outcome:
    """Look for the coarsest fineness that keeps to the target, by false position on logarithms."""
    fineness = (0.4 if worst else 4.0) * target_mm / _MM_PER_UNIT
    good: tuple[float, float, EncodedPayload, FloatArray] | None = None
    bad: tuple[float, float] | None = None
    best = np.inf
    for attempt in range(_ATTEMPTS):
        encoded = encoder.encode(fineness)
        distances = meter.distances_mm(encoded.decoded)
        error = float(distances.max() if worst else distances.mean())
        best = min(best, error)
        if error <= target_mm:
            if good is None or fineness > good[0]:
                good = (fineness, error, encoded, distances)
            if error >= _NEAR * target_mm or error == 0:
                break
        elif bad is None or fineness < bad[0]:
            bad = (fineness, error)
        fineness = _next(fineness, error, target_mm, good and good[:2], bad)
        if good is None:
            fineness *= _IMPATIENCE**attempt
        if fineness < _FINEST:
            break
    if good is None:
        raise CodecError(
            "the compact profile cannot keep to this error",
            wanted=f"{target_mm:g} mm",
            got=f"{best:.3g} mm at best",
            hint="Ask for no less than that, or use the profile of version 1",
        )
    fineness, _, encoded, distances = good
    return Outcome(pack(encoded.payload), encoded.decoded, float(distances.mean()), float(distances.max()), fineness)


def _next(
    fineness: float, error: float, target: float, good: tuple[float, float] | None, bad: tuple[float, float] | None
) -> float:
    """Return the fineness to try next: between the best known on either side, or in proportion."""
    aim = target * (1 + _NEAR) / 2
    if good and bad and good[0] < bad[0]:
        (low, less), (high, more) = good, bad
        share = np.log(aim / less) / np.log(more / less) if less > 0 else 0.5
        return float(low * (high / low) ** np.clip(share, 0.1, 0.9))
    ratio = aim / error if error > 0 else 4.0
    return fineness * float(np.clip(ratio, 0.1, 8.0))
