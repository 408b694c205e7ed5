"""The coarsest encoding that keeps to an error: the mean distance of all joints, or the largest in any frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray
from qmd_studio.codecs.compact.attempt import Attempt, Meter, attempt, with_block
from qmd_studio.codecs.compact.encode import CompactEncoder
from qmd_studio.codecs.compact.progress import UNWATCHED, Watch
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import ASF_UNIT_M, Motion

_MM_PER_UNIT = 1000 * ASF_UNIT_M
_ATTEMPTS = 14
_NEAR = 0.997
"""An encoding that uses up this much of the error it may make is good enough."""

_IMPATIENCE = 0.95
"""While nothing keeps to the target, each attempt goes that much further than proportion says: errors can stall."""

_FINEST = 1e-7

_COARSER = (1.15, 1.32, 1.52, 1.75)
"""How much coarser than one fineness that keeps to a bound everywhere the rest of a motion may be."""

_REPAIRS = 7
_MOST_WEIGHT = 300.0


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """An encoding that keeps to its target: the bytes of its payload, what they decode to, and its error.

    `fineness` is what `CompactEncoder.encode` takes to make it again where no frame was given a weight of its own, and
    `block` the frames from key to key.
    """

    payload: bytes
    decoded: Float32Array
    mean_mm: float
    max_mm: float
    fineness: float
    block: int


def meet_target(motion: Motion, settings: CompactSettings, watch: Watch = UNWATCHED) -> Outcome:
    """Return the smallest encoding found that keeps to the target of `settings`.

    Raises `CodecError` for a motion that cannot be encoded, for a skeleton without measured points, and where float32
    or the finest step cannot keep to the error: it says what can be reached. Raises `EncodingCancelledError` where
    `watch` says so.
    """
    if not motion.skeleton.points:
        raise CodecError("the skeleton has no points to measure at", hint="Use the profile of version 1")
    settings = settings.checked(motion.n_frames)
    CompactEncoder(motion, settings)  # refuses what cannot be encoded
    worst = settings.mean_error_mm is None
    target = settings.max_error_mm if worst else settings.mean_error_mm
    assert target is not None  # one of the two, as has been checked
    fineness = (0.4 if worst else 4.0) * target / _MM_PER_UNIT
    if settings.block is None:
        chosen, fineness = with_block(motion, settings, target, fineness, watch)
        settings = replace(settings, block=chosen.block)
    encoder, meter = CompactEncoder(motion, settings), Meter(motion)
    best = _search(encoder, meter, target, fineness, watch, worst=worst)
    if worst:
        best = _local(encoder, meter, target, best, watch)
    return Outcome(
        best.payload, best.encoded.decoded, best.mean_mm, best.max_mm, best.fineness, best.encoded.payload.block
    )


def _search(
    encoder: CompactEncoder, meter: Meter, target_mm: float, fineness: float, watch: Watch, *, worst: bool
) -> Attempt:
    """Look for the coarsest fineness that keeps to the target, by false position on logarithms."""
    good: Attempt | None = None
    bad: tuple[float, float] | None = None
    best = np.inf
    for number in range(_ATTEMPTS):
        tried = attempt(encoder, meter, fineness, watch)
        watch.tell(number + 1, _ATTEMPTS)
        error = tried.max_mm if worst else tried.mean_mm
        best = min(best, error)
        if error <= target_mm:
            if good is None or fineness > good.fineness:
                good = tried
            if error >= _NEAR * target_mm or error == 0:
                break
        elif bad is None or fineness < bad[0]:
            bad = (fineness, error)
        known = None if good is None else (good.fineness, good.max_mm if worst else good.mean_mm)
        fineness = _next(fineness, error, target_mm, known, bad)
        if good is None:
            fineness *= _IMPATIENCE**number
        if fineness < _FINEST:
            break
    if good is None:
        raise CodecError(
            "the compact profile cannot keep to this error",
            wanted=f"{target_mm:g} mm",
            got=f"{best:.3g} mm at best",
            hint="Ask for no less than that, or use the profile of version 1",
        )
    return good


def _local(encoder: CompactEncoder, meter: Meter, target_mm: float, best: Attempt, watch: Watch) -> Attempt:
    """Return the smallest of `best` and of coarser encodings that mind the frames more where the bound would break."""
    known = best
    for step, coarser in enumerate(_COARSER):
        weights = np.ones(encoder.motion.n_frames)
        for _ in range(_REPAIRS):
            tried = attempt(encoder, meter, known.fineness * coarser, watch, weights)
            if tried.max_mm <= target_mm or len(tried.payload) >= len(best.payload):
                break
            weights = _heavier(weights, tried, target_mm)
        watch.tell(step + 1, len(_COARSER))
        if tried.max_mm > target_mm or len(tried.payload) >= len(best.payload):
            break
        best = tried
    return best


def _heavier(weights: FloatArray, tried: Attempt, target_mm: float) -> FloatArray:
    """Return the weights of frames (n_frames,), more where the bound breaks and, less so, right beside it."""
    over = np.maximum(tried.frame_mm / target_mm, 1.0)
    reach = tried.encoded.payload.block // 4
    near = over.copy()
    for away in range(1, reach + 1):
        share = 1 - away / (reach + 1)
        near[away:] = np.maximum(near[away:], 1 + (over[:-away] - 1) * share)
        near[:-away] = np.maximum(near[:-away], 1 + (over[away:] - 1) * share)
    return np.minimum(weights * np.where(near > 1, 1.3 * near**3, 1.0), _MOST_WEIGHT)


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
