"""The two ways to make a segment's table: the paper's buckets, and levels spaced for the closed loop."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import Float32Array, FloatArray, IntArray
from qmd_studio.motion.skeleton import MAX_LEVEL

UNIFORM_SHARE = 0.02
"""The share of levels spread evenly over the whole range, so that rare large steps are not starved of them."""

_WIDEST_HISTOGRAM = 1 << 20

_LARGEST_SHARE = 4
"""The density is estimated over intervals that hold about 1 / (4 * 2^b) of the values each."""

MOST_INTERVALS = 1 << 14
"""More intervals than this buy a large table a tenth less error at twice the time."""


def equal_frequency_buckets(differences: Float32Array, *, bits: int, rqt: int) -> IntArray:
    """Return the bucket 0 to 2^bits - 1 of each difference, in the shape given (the paper, section 3.1).

    Buckets take equal shares of the values in the order of round(difference * rqt); equal integers share a bucket.
    """
    if not differences.size:
        return np.zeros(differences.shape, dtype=np.int64)
    integers = np.rint(differences.astype(np.float64) * rqt)
    lowest = integers.min()
    if integers.max() - lowest < _WIDEST_HISTOGRAM:
        number = (integers - lowest).astype(np.int64)
        counts = np.bincount(number.ravel())
    else:  # a wild column: count only the integers that occur
        _, number, counts = np.unique(integers, return_inverse=True, return_counts=True)
    middle_rank_twice = 2 * np.cumsum(counts) - counts - 1
    buckets = np.minimum((middle_rank_twice << bits) // (2 * differences.size), 2**bits - 1)
    found: IntArray = buckets[number].reshape(differences.shape)
    return found


def equal_width_buckets(differences: Float32Array, *, bits: int, rqt: int) -> IntArray:
    """Return the bucket 0 to 2^bits - 1 of each difference, in the shape given: equal shares of the range.

    As in `equal_frequency_buckets` the values count as round(difference * rqt).
    """
    if not differences.size:
        return np.zeros(differences.shape, dtype=np.int64)
    integers = np.rint(differences.astype(np.float64) * rqt)
    lowest = integers.min()
    width = integers.max() - lowest + 1.0  # the highest value lies inside the last bucket
    found: IntArray = np.minimum((integers - lowest) * 2.0**bits // width, 2**bits - 1).astype(np.int64)
    return found


def averaged_table(
    differences: Float32Array, buckets: IntArray, *, levels: IntArray, bits: int, k: float
) -> Float32Array:
    """Return the table (2^bits,) of weighted bucket means (the paper, equation 1).

    `levels` (columns,) are the paper's l of each column, 1 to 6; weights are 1/l^k. With k infinite only the lowest
    level in a bucket counts (selective averaging). A bucket that holds no value reads 0; no index points to it.
    """
    values = differences.astype(np.float64).ravel()
    bucket = buckets.ravel()
    level = np.broadcast_to(np.clip(levels, 1, MAX_LEVEL), differences.shape).ravel()
    lowest = np.full(2**bits, np.iinfo(np.int64).max)
    np.minimum.at(lowest, bucket, level)
    weights = relative_weights(k)[lowest[bucket], level]
    total = np.bincount(bucket, weights * values, 2**bits)
    weight = np.bincount(bucket, weights, 2**bits)
    means: FloatArray = np.divide(total, weight, out=np.zeros(2**bits), where=weight > 0)
    return means.astype(np.float32)


def relative_weights(k: float) -> FloatArray:
    """Return (lowest, l) the weight 1/l^k over that of the bucket's lowest level: 1 or 0 where k is infinite."""
    level = np.arange(MAX_LEVEL + 1, dtype=np.float64)
    ratio = np.minimum(level[:, np.newaxis] / np.maximum(level, 1.0), 1.0)
    return ratio**k  # as a ratio it cannot vanish for all of a bucket, however large k is


def companded_table(
    differences: Float32Array, *, bits: int, power: float = 0.5, uniform_share: float = UNIFORM_SHARE
) -> Float32Array:
    """Return 2^bits ascending levels, dense where differences are common: density as a power of their own.

    The root keeps the closed loop's error lowest in the mean; lower powers, down to a third, serve the largest error.
    The first and last level reach to the ends of the range. Equal differences give equal levels.
    """
    n_levels = 2**bits
    ordered = np.sort(differences, axis=None)
    if not ordered.size or ordered[0] == ordered[-1]:
        return np.full(n_levels, ordered[0] if ordered.size else 0.0, dtype=np.float32)
    edges, shares = _intervals(ordered, n_levels)
    widths = np.diff(edges)
    roots = np.sqrt(shares * widths) if power == 0.5 else shares**power * widths ** (1.0 - power)
    rises = (1.0 - uniform_share) * roots / np.add.accumulate(roots)[-1]
    rises += uniform_share * widths / (edges[-1] - edges[0])
    heights = np.concatenate([[0.0], np.add.accumulate(rises)])
    at = np.arange(n_levels) * (heights[-1] / (n_levels - 1))
    levels: FloatArray = np.interp(at, heights, edges)
    return levels.astype(np.float32)


def refined_table(table: Float32Array, values: Float32Array, weights: FloatArray) -> Float32Array:
    """Return ascending levels at the weighted means of the values nearest to each of `table`'s (Lloyd's method, twice).

    `values` and `weights` have one shape. A level that no weight falls to stays where it is.
    """
    order = np.argsort(values, axis=None)
    ordered = values.ravel()[order].astype(np.float64)
    weight = weights.ravel()[order]
    total = np.concatenate([[0.0], np.cumsum(weight)])
    moment = np.concatenate([[0.0], np.cumsum(weight * ordered)])
    levels = table.astype(np.float64)
    for _ in range(2):
        inner = np.searchsorted(ordered, (levels[1:] + levels[:-1]) / 2)
        ends = np.concatenate([[0], inner, [len(ordered)]])
        share = np.diff(total[ends])
        levels = np.sort(np.divide(np.diff(moment[ends]), share, out=levels.copy(), where=share > 0))
    return levels.astype(np.float32)


def middles(table: Float32Array) -> Float32Array:
    """Return (2^bits,) the values halfway between an ascending table's neighbours, and infinity after the last.

    The level nearest to a value is the one whose number is the count of middles below it.
    """
    halfway = np.full(len(table), np.inf, dtype=np.float32)
    halfway[:-1] = (table[1:] + table[:-1]) * np.float32(0.5)
    return halfway


def _intervals(ordered: Float32Array, n_levels: int) -> tuple[FloatArray, FloatArray]:
    """Return the edges (k + 1,) of intervals that each hold about as many of the values, and how many each holds."""
    n_intervals = min(len(ordered), _LARGEST_SHARE * n_levels, MOST_INTERVALS)
    ranks = np.arange(n_intervals + 1) * (len(ordered) - 1) // n_intervals
    edges = ordered[ranks].astype(np.float64)
    new = np.concatenate([[True], edges[1:] != edges[:-1]])  # what np.unique does, had it known that they are in order
    counts = np.diff(ranks[new]).astype(np.float64)
    return edges[new], np.maximum(counts, 1.0)
