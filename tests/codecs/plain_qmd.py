"""The encoder and the decoder once more, one value after another in plain NumPy: the twin of the fast ones."""

from fractions import Fraction
from itertools import pairwise

import numpy as np

from qmd_studio.codecs.qmd.payload import Payload, Segment
from qmd_studio.codecs.qmd.settings import Buckets, Encoder
from qmd_studio.codecs.qmd.tables import companded_table


def encode_plainly(matrix, levels, settings):
    """Return the payload and the decoded rows (n_frames, m) float32."""
    n_rows = len(matrix) - 1
    step = settings.segment or max(n_rows, 1)
    decoded = [matrix[0]]
    segments = []
    for start in range(0, max(n_rows, 1), step):
        poses = matrix[start : start + step + 1]
        encode = paper_segment if settings.encoder is Encoder.PAPER else closed_segment
        segment = encode(poses, decoded[-1], levels, settings)
        segments.append(segment)
        for exact, indices in zip(segment.exact, segment.indices, strict=True):
            decoded.append(decoded[-1] + np.concatenate([exact, segment.table[indices]]))
    return Payload(matrix[0], tuple(segments)), np.array(decoded)


def paper_segment(poses, _, levels, settings):
    differences = np.array([after - before for before, after in pairwise(poses)], np.float32)
    differences = differences.reshape(-1, poses.shape[1])
    quantised = differences[:, settings.fdf :]
    n_buckets = 2**settings.bits
    integers = np.rint(quantised.astype(float) * settings.rqt)
    bucket_of = {}
    below = 0
    for integer, count in zip(*np.unique(integers, return_counts=True), strict=True):
        middle_twice = 2 * below + int(count) - 1
        bucket_of[integer] = min(middle_twice * n_buckets // (2 * integers.size), n_buckets - 1)
        below += int(count)
        if settings.buckets is Buckets.WIDTH:  # whole numbers: the fraction is exact
            place = Fraction(int(integer - integers.min()), int(integers.max() - integers.min()) + 1)
            bucket_of[integer] = int(place * n_buckets)
    buckets = np.array([bucket_of[i] for i in integers.ravel()], dtype=int).reshape(integers.shape)
    table = np.zeros(n_buckets, np.float32)
    for bucket in set(bucket_of.values()):
        _, columns = here = np.nonzero(buckets == bucket)
        level = levels[settings.fdf :][columns].astype(float)
        weights = (level.min() / level) ** settings.k  # 1/l^k but for a factor, which the mean loses again
        total = weight = 0.0
        for value, share in zip(quantised[here], weights, strict=True):
            total += share * float(value)
            weight += share
        table[bucket] = total / weight
    return Segment(settings.bits, table, differences[:, : settings.fdf], as_small(buckets, settings.bits))


def closed_segment(poses, pose, _, settings):
    fdf = settings.fdf
    table = companded_table(np.diff(poses[:, fdf:], axis=0), bits=settings.bits)
    halfway = (table[1:] + table[:-1]) * np.float32(0.5)
    exact = np.empty((len(poses) - 1, fdf), np.float32)
    indices = np.empty((len(poses) - 1, poses.shape[1] - fdf), int)
    for row, target in enumerate(poses[1:]):
        lacking = target - pose
        exact[row] = lacking[:fdf]
        indices[row] = np.searchsorted(halfway, lacking[fdf:])
        pose = pose + np.concatenate([exact[row], table[indices[row]]])
    return Segment(settings.bits, table, exact, as_small(indices, settings.bits))


def as_small(numbers, bits):
    return numbers.astype(np.uint8 if bits == 8 else np.uint16)
