"""Makes compact_prior.txt: how often each integer is larger than its bucket, over motions that no benchmark uses.

Run from the root of the checkout: `python tests/benchmarks/make_compact_prior.py MOTION… [--skeleton ASF]`. It starts
from the table that stands and gives a better one; twice is enough.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from numba import njit

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from qmd_studio.codecs.compact import PRIOR_SHAPE  # noqa: E402
from qmd_studio.codecs.compact.decode import decode_integers  # noqa: E402
from qmd_studio.codecs.compact.encode import CompactEncoder  # noqa: E402
from qmd_studio.codecs.compact.model import (  # noqa: E402
    FIRST_KEY,
    LATER_KEY,
    ROW_0,
    ROWS,
    SECOND_KEY,
    STEP,
    bucket_of,
    context_of,
    expected_coefficient,
    expected_key,
)
from qmd_studio.codecs.compact.prior import prior  # noqa: E402
from qmd_studio.codecs.compact.settings import CompactSettings  # noqa: E402
from qmd_studio.codecs.compact.stream import START, new_sizes  # noqa: E402
from qmd_studio.formats.loaded import ReadOptions  # noqa: E402
from qmd_studio.registry import open_file  # noqa: E402

TARGET = ROOT / "resources" / "tables" / "compact_prior.txt"
FINENESSES = (0.006, 0.012, 0.035, 0.08, 0.16)
SEGMENTS = (0, 120)
DOUBT = 4
"""Decisions that a geometric guess counts as, where few were seen."""

HEADING = """# The prior of the compact profile: 8 classes of integers x 24 contexts, one line each of 16 half octaves.
# The chance, in 256ths, that an integer is larger than its half octave. Made by make_compact_prior.py.
"""


@njit(cache=True)
def count(counts, kind, context, value):
    bucket = bucket_of(abs(value))
    for b in range(min(bucket + 1, counts.shape[2])):
        counts[kind, context, b, 1 if b < bucket else 0] += 1


@njit(cache=True)
def count_key(counts, kind, key, last, step_before, sizes):
    left = left2 = START
    for j in range(len(key)):
        low, next_low = (sizes[2, j + 2], sizes[3, j + 2]) if kind == LATER_KEY else (0, 0)
        step = key[j] - last[j]
        count(counts, kind, context_of(expected_key(kind, left, left2, abs(step_before[j]), low, next_low)), step)
        left, left2 = abs(step), left


@njit(cache=True)
def count_segment(counts, pose, at, keys, rows, first):
    """Count every decision of a segment, in the order of `write_segment`."""
    m = keys.shape[1]
    sizes, before = new_sizes(at, m), new_sizes(at, m)
    step, nothing = np.zeros(m, np.int64), np.zeros(m, np.int64)
    count_key(counts, FIRST_KEY, keys[0], nothing if first else pose, nothing, before)
    used_before = 0
    for i in range(1, len(at)):
        count_key(counts, LATER_KEY if i > 1 else SECOND_KEY, keys[i], keys[i - 1], step, before)
        step = keys[i] - keys[i - 1]
        block = rows[at[i - 1] - i + 1 : at[i] - i]
        if not len(block):
            continue
        used = len(block)
        while used > 0 and not block[used - 1].any():
            used -= 1
        count(counts, ROWS, 0, used - used_before)
        used_before = used
        sizes[:] = 0
        for f in range(used):
            for j in range(m):
                context = context_of(expected_coefficient(sizes, before, i > 1, abs(step[j]), f, j))
                count(counts, ROW_0 + min(f, 2), context, block[f, j])
                sizes[f + 2, j + 2] = abs(block[f, j])
        sizes, before = before, sizes


def guess():
    """Return geometric chances for every context, in counts of `DOUBT` decisions."""
    counts = np.zeros((*PRIOR_SHAPE, 2))
    for context in range(PRIOR_SHAPE[1]):
        quarters = context if context < 2 else (2 + (context & 1)) << (context // 2 - 1)
        mean = (quarters + 0.5) / 4 + 0.02
        for bucket in range(PRIOR_SHAPE[2]):
            low, high = (b if b < 4 else (2 + (b & 1)) << (b // 2 - 1) for b in (bucket, bucket + 1))
            larger = min(0.99, max(0.004, (mean / (1 + mean)) ** (high - low)))
            counts[:, context, bucket] = DOUBT * (1 - larger), DOUBT * larger
    return counts


def counted(paths, skeleton):
    """Return how often each decision fell either way, over all motions, finenesses and segments."""
    counts = np.zeros((*PRIOR_SHAPE, 2), np.int64)
    for path in paths:
        motion = open_file(path, ReadOptions(skeleton=skeleton)).motion
        for segment in SEGMENTS:
            encoder = CompactEncoder(motion, CompactSettings(mean_error_mm=1.0, segment=segment))
            for fineness in FINENESSES:
                payload = encoder.encode(fineness).payload
                codes, pose, segments = decode_integers(payload)
                for last, code in zip((128, *codes[:-1]), codes, strict=True):
                    count(counts, STEP, 0, code - last)
                for number, (at, keys, rows) in enumerate(segments):
                    count_segment(counts, pose, at, keys, rows, number == 0)
    return counts


def write(counts):
    chances = np.clip(np.rint(256 * counts[..., 1] / counts.sum(axis=-1)), 1, 255).astype(np.uint8)
    lines = [row.tobytes().hex() for row in chances.reshape(-1, PRIOR_SHAPE[2])]
    TARGET.write_text(HEADING + "\n".join(lines) + "\n", encoding="ascii")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("motions", nargs="*", type=Path)
    parser.add_argument("--skeleton", action="append", default=[], metavar="FOLDER=ASF", help="for AMCs in a folder")
    arguments = parser.parse_args()
    skeletons = {folder: Path(asf) for folder, asf in (entry.split("=") for entry in arguments.skeleton)}
    write(guess())
    for _ in range(2 if arguments.motions else 0):
        prior.cache_clear()
        total = guess()
        for path in arguments.motions:
            total = total + counted([path], skeletons.get(path.parent.name))
        write(total)


if __name__ == "__main__":
    main()
