"""Decoding the compact profile against the plain decoder that it grew from, in one run.

The plain decoder gets the numbers of a file with keys 30 frames apart; ours gets its own best file of the same mean
error.
"""

import numpy as np
import plain_compact_decoder as plain
from bench_motion import alternate, bench_motion

from qmd_studio.codecs.compact.decode import decode_integers, decode_payload
from qmd_studio.codecs.compact.payload import unpack
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.synthesis import step_sizes
from qmd_studio.codecs.compact.target import meet_target

SEGMENT, BLOCK = 120, 30


def main():
    motion = bench_motion()
    us = 1e3 / motion.n_frames
    for target_mm in (0.5, 1.0):
        best, given = (
            unpack(memoryview(meet_target(motion, CompactSettings(target_mm, segment=SEGMENT, block=block)).payload))
            for block in (None, BLOCK)
        )
        codes, _, segments = decode_integers(given)
        step, ats = step_sizes(codes).astype(np.float64), [at for at, _, _ in segments]
        streams = plain.encode(segments)
        assert np.allclose(plain.decode(streams, ats, step, step / 2), decode_payload(given), atol=1e-4)
        ours, theirs = alternate(
            lambda best=best: decode_payload(best),
            lambda streams=streams, ats=ats, step=step: plain.decode(streams, ats, step, step / 2),
            21,
        )
        print(
            f"decoding the compact profile, {target_mm} mm, segments of {SEGMENT} | {ours * us:.2f} µs a frame | "
            f"the plain design: {theirs * us:.2f} µs | {ours / theirs:.2f} | at most 1.2"
        )


if __name__ == "__main__":
    main()
