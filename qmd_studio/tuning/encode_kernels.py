"""Encoding without files: what the decoder will have, for many settings at once, from differences sorted beforehand.

These kernels do what `codecs/qmd/tables.py` and `codecs/qmd/kernels.py` do, in the same arithmetic, and are held to
them by tests. What one FDF and one segmentation share among all index widths is done once. Importing this module
imports numba.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qmd_studio.compiled import compiled

_Rows: TypeAlias = NDArray[Any]

_BLOCK = 64
_LEVELS = 7
"""One more than the paper's largest level: levels count from 1."""


@compiled()
def exact_columns(matrix: _Rows, chases: bool, decoded: _Rows) -> None:
    """Fill `decoded` (m, n_frames) with what exact columns decode to, from `matrix` (m, n_frames) float32.

    `chases` says whether the encoder takes each difference from where the decoder stands, as the closed loop does, or
    from the original.
    """
    for j in range(len(matrix)):
        source, target = matrix[j], decoded[j]
        target[0] = source[0]
        for t in range(1, len(source)):
            target[t] = target[t - 1] + (source[t] - (target[t - 1] if chases else source[t - 1]))


@compiled()
def by_segment(order: _Rows, values: _Rows, rows_each: int, ordered: _Rows, column: _Rows) -> None:
    """Fill `ordered` and `column` (n_rows * m,) with all values and their columns, ascending in each segment.

    `order` (n_rows * m,) sorts `values` (n_rows, m); segments have `rows_each` rows.
    """
    n_rows, m = values.shape
    place = np.arange(0, n_rows * m, rows_each * m)
    for flat in order:
        row, j = flat // m, flat % m
        segment = row // rows_each
        at = place[segment]
        place[segment] += 1
        ordered[at] = values[row, j]
        column[at] = j


@compiled()
def without_leading(ordered: _Rows, column: _Rows, fdf: int, kept: _Rows) -> None:
    """Fill `kept` with those of `ordered` whose column is `fdf` or later, their order unchanged."""
    at = 0
    for i in range(len(ordered)):
        if column[i] >= fdf:
            kept[at] = ordered[i]
            at += 1


@compiled()
def companded(ordered: _Rows, table: _Rows, most: int, uniform: float) -> None:
    """Fill `table` (2^b,) as `tables.companded_table` does; `ordered` (count,) ascends.

    At most `most` intervals bear the density, `uniform` is the share of levels spread evenly.
    """
    n_levels, count = len(table), len(ordered)
    if count == 0 or ordered[0] == ordered[-1]:
        table[:] = ordered[0] if count else np.float32(0)
        return
    n_intervals = min(count, 4 * n_levels, most)
    edges, ranks = np.empty(n_intervals + 1), np.empty(n_intervals + 1, np.int64)
    last = -1
    for i in range(n_intervals + 1):
        rank = i * (count - 1) // n_intervals
        value = np.float64(ordered[rank])
        if last < 0 or value != edges[last]:
            last += 1
            edges[last], ranks[last] = value, rank
    heights = np.empty(last + 1)
    total = 0.0
    for i in range(last):
        heights[i + 1] = np.sqrt(max(np.float64(ranks[i + 1] - ranks[i]), 1.0) * (edges[i + 1] - edges[i]))
        total += heights[i + 1]
    heights[0] = 0.0
    span = edges[last] - edges[0]
    for i in range(last):
        rise = (1.0 - uniform) * heights[i + 1] / total
        heights[i + 1] = heights[i] + (rise + uniform * (edges[i + 1] - edges[i]) / span)
    step = heights[last] / (n_levels - 1)
    i = 0
    slope = (edges[1] - edges[0]) / (heights[1] - heights[0])
    for level in range(n_levels):
        at = level * step
        if at >= heights[last]:
            table[level] = edges[last]
            continue
        if heights[i + 1] <= at:
            while heights[i + 1] <= at:
                i += 1
            slope = (edges[i + 1] - edges[i]) / (heights[i + 1] - heights[i])
        table[level] = slope * (at - heights[i]) + edges[i]


@compiled()
def closed_paths(
    matrix: _Rows,
    kept: _Rows,
    rows_each: int,
    bits: _Rows,
    table_rules: tuple[int, float],
    units: tuple[_Rows, _Rows],
    decoded: _Rows,
) -> None:
    """Fill `decoded` (B, q, n_frames) with the last q columns as the plain closed loop at `bits` (B,) encodes them.

    `matrix` (n_frames, q) are those columns, `kept` their differences, ascending in each segment of `rows_each` rows.
    `table_rules` are the last arguments of `companded`; what leaves is (value - units[0]) * units[1], column by column.
    """
    n_frames, q = matrix.shape
    for b in range(len(bits)):
        table = np.empty(1 << bits[b], np.float32)
        middles = np.empty(len(table), np.float32)
        middles[-1] = np.inf
        pose = matrix[0].copy()
        for j in range(q):
            decoded[b, j, 0] = (pose[j] - units[0][j]) * units[1][j]
        for start in range(0, n_frames - 1, rows_each):
            stop = min(start + rows_each, n_frames - 1)
            companded(kept[start * q : stop * q], table, table_rules[0], table_rules[1])
            for k in range(len(table) - 1):
                middles[k] = (table[k + 1] + table[k]) * np.float32(0.5)
            _follow(matrix[start : stop + 1], table, middles, pose, units, decoded[b, :, start + 1 : stop + 1])


@compiled()
def _follow(
    matrix: _Rows, table: _Rows, middles: _Rows, pose: _Rows, units: tuple[_Rows, _Rows], decoded: _Rows
) -> None:
    """Run the closed loop over one segment: `matrix` (rows + 1, q), `decoded` (q, rows); `pose` (q,) moves on."""
    n_rows, q = len(matrix) - 1, len(pose)
    wanted, position = np.empty(q, np.float32), np.empty(q, np.uint32)
    block = np.empty((_BLOCK, q), np.float32)
    for row in range(n_rows):
        for j in range(q):
            wanted[j] = matrix[row + 1, j] - pose[j]
            position[j] = 0
        # as in `codecs.qmd.kernels.closed_loop`: one step of all columns' binary searches at a time
        half = np.uint32(len(table) // 2)
        while half > 0:
            for j in range(q):
                low = position[j]
                high = np.uint32(low + half)
                position[j] = high if middles[np.uint64(high) - np.uint64(1)] < wanted[j] else low
            half = np.uint32(half >> np.uint32(1))
        for j in range(q):
            pose[j] += table[np.uint64(position[j])]
        at = row % _BLOCK
        for j in range(q):
            block[at, j] = (pose[j] - units[0][j]) * units[1][j]
        if at == _BLOCK - 1 or row == n_rows - 1:
            for j in range(q):
                for back in range(at + 1):
                    decoded[j, row - at + back] = block[back, j]


@compiled()
def paper_paths(
    differences: tuple[_Rows, _Rows],
    levels: _Rows,
    first: _Rows,
    rows_each: int,
    bits: _Rows,
    weights: _Rows,
    units: tuple[_Rows, _Rows],
    decoded: _Rows,
) -> None:
    """Fill `decoded` (B, q, n_frames) with the last q columns as the paper's encoder at `bits` (B,) encodes them.

    `differences` (q, n_rows) are values and the ranks of their integers among all of the motion's; `levels` (q,) the
    columns' levels 1 to 6; `first` (q,) the first pose; `weights` (lowest, level) as `tables.averaged_table` has them.
    What leaves is (value - units[0]) * units[1], column by column.
    """
    values, ranks = differences
    q, n_rows = values.shape
    pose = np.empty((len(bits), q), np.float32)
    for b in range(len(bits)):
        for j in range(q):
            pose[b, j] = first[j]
            decoded[b, j, 0] = (first[j] - units[0][j]) * units[1][j]
    if q == 0:
        return
    n_ranks = 1 + (ranks.max() if ranks.size else 0)
    counts, sums = np.zeros((n_ranks, _LEVELS), np.int32), np.zeros((n_ranks, _LEVELS), np.float64)
    found = np.empty(n_ranks, np.int32), np.empty(n_ranks, np.int64), np.empty(n_ranks, np.int64)
    most = min(n_ranks * _LEVELS, q * min(rows_each, n_rows))
    cells = np.empty(most, np.int32), np.empty(most, np.float64), np.empty(most, np.float64)
    entries = np.zeros(n_ranks, np.float32)
    for start in range(0, n_rows, rows_each):
        stop = min(start + rows_each, n_rows)
        low, high = n_ranks, -1
        for j in range(q):
            level = levels[j]
            for t in range(start, stop):
                rank = ranks[j, t]
                low, high = min(low, rank), max(high, rank)
                counts[rank, level] += 1
                sums[rank, level] += values[j, t]
        n_found = _gather(counts, sums, (low, high), found, cells)
        for b in range(len(bits)):
            _fill_entries(n_found, found, cells, bits[b], weights, entries)
            _add_up(ranks[:, start:stop], entries, pose[b], units, decoded[b, :, start + 1 : stop + 1])


@compiled()
def _add_up(ranks: _Rows, entries: _Rows, pose: _Rows, units: tuple[_Rows, _Rows], decoded: _Rows) -> None:
    """Decode one segment: `ranks` and `decoded` (q, rows); `pose` (q,) moves on. Four columns at a time hide waits."""
    q, n_rows = ranks.shape
    offset, scale = units
    whole = q - q % 4
    for j in range(0, whole, 4):
        h0, h1, h2, h3 = pose[j], pose[j + 1], pose[j + 2], pose[j + 3]
        for t in range(n_rows):
            h0 += entries[ranks[j, t]]
            h1 += entries[ranks[j + 1, t]]
            h2 += entries[ranks[j + 2, t]]
            h3 += entries[ranks[j + 3, t]]
            decoded[j, t] = (h0 - offset[j]) * scale[j]
            decoded[j + 1, t] = (h1 - offset[j + 1]) * scale[j + 1]
            decoded[j + 2, t] = (h2 - offset[j + 2]) * scale[j + 2]
            decoded[j + 3, t] = (h3 - offset[j + 3]) * scale[j + 3]
        pose[j], pose[j + 1], pose[j + 2], pose[j + 3] = h0, h1, h2, h3
    for j in range(whole, q):
        for t in range(n_rows):
            pose[j] += entries[ranks[j, t]]
            decoded[j, t] = (pose[j] - offset[j]) * scale[j]


@compiled()
def _gather(
    counts: _Rows, sums: _Rows, ends: tuple[int, int], found: tuple[_Rows, ...], cells: tuple[_Rows, ...]
) -> int:
    """Move what `counts` and `sums` (n_ranks, 7) hold between `ends`, both included, to `found` and `cells`.

    Return how many ranks occur. `found` are those ranks, how many values each has, and where its cells end; `cells`
    are levels, counts and sums.
    """
    rank, total, end = found
    level, count, value = cells
    n_found, n_cells = 0, 0
    for r in range(ends[0], ends[1] + 1):
        before, here = n_cells, 0
        for at in range(1, _LEVELS):
            if counts[r, at]:
                level[n_cells], count[n_cells], value[n_cells] = at, counts[r, at], sums[r, at]
                here += counts[r, at]
                counts[r, at], sums[r, at] = 0, 0.0
                n_cells += 1
        if n_cells > before:
            rank[n_found], total[n_found], end[n_found] = r, here, n_cells
            n_found += 1
    return n_found


@compiled()
def _fill_entries(
    n_found: int, found: tuple[_Rows, ...], cells: tuple[_Rows, ...], bits: int, weights: _Rows, entries: _Rows
) -> None:
    """Fill `entries` at the ranks that occur with their table entries; a bucket is a run of neighbouring ranks.

    An entry is the mean of the bucket's values by the weights that go with its lowest level. It stands in this loop,
    not in one of its own, because a call for every bucket would cost more than the bucket.
    """
    rank, total, end = found
    level, count, value = cells
    size = 0
    for i in range(n_found):
        size += int(total[i])
    before: int = 0
    bound: int = -1
    start, first_cell = 0, 0
    for i in range(n_found + 1):
        middle: int = 0
        if i < n_found:
            middle = (2 * before + int(total[i]) - 1) << bits
            before += int(total[i])
            if middle < bound:
                continue  # still in the bucket of the one before
        if i:
            stop = end[i - 1]
            lowest = level[first_cell]
            for c in range(first_cell + 1, stop):
                lowest = min(lowest, level[c])
            summed, weight = 0.0, 0.0
            for c in range(first_cell, stop):
                share = weights[lowest, level[c]]
                summed += share * value[c]
                weight += share * count[c]
            mean = np.float32(summed / weight)
            for k in range(start, i):
                entries[rank[k]] = mean
            start, first_cell = i, stop
        bound = (middle // (2 * size) + 1) * (2 * size)
