"""A motion of a million frames through both versions of the format: an explicit long run.

    python tests/benchmarks/long_motion.py [frames…]     100000 and 1000000 unless told otherwise

Prints seconds and the most memory used for each length, so that both can be seen to grow no faster than the motion.
Version 2 is encoded at one fineness, as each attempt at a target is; a target takes 5 to 15 of them.
"""

import resource
import subprocess
import sys
import time

import numpy as np
from bench_motion import bench_motion

from qmd_studio.codecs.compact.decode import decode_payload as decode_compact
from qmd_studio.codecs.compact.encode import CompactEncoder
from qmd_studio.codecs.compact.payload import pack, unpack
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import QmdSettings

LENGTHS = (100_000, 1_000_000)
FINENESS = 0.035


def long_motion(n_frames):
    """Return a real motion played forward and backward until it is that long."""
    motion = bench_motion()
    period = np.concatenate([np.arange(motion.n_frames), np.arange(motion.n_frames - 2, 0, -1)])
    return motion.with_values(motion.X[np.resize(period, n_frames)])


def run(what, n_frames):
    motion = long_motion(n_frames)
    before, started = _memory_gb(), time.perf_counter()
    if what == "closed":
        data = encode(motion, QmdSettings(fdf=6, segment=0)).data
        encoded = time.perf_counter()
        decoded = decode(data).n_frames
    else:
        payload = CompactEncoder(motion, CompactSettings(mean_error_mm=0.5, segment=120, block=20)).encode(FINENESS)
        data = pack(payload.payload)
        encoded = time.perf_counter()
        decoded = len(decode_compact(unpack(memoryview(data))))
    done = time.perf_counter()
    assert decoded == n_frames
    print(
        f"{what}, {n_frames:,} frames: encoding {encoded - started:.1f} s, decoding {done - encoded:.1f} s, "
        f"{len(data) / n_frames:.1f} bytes a frame, {_memory_gb():.2f} GB, {before:.2f} of it the motion",
        flush=True,
    )


def _memory_gb():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def main():
    if len(sys.argv) == 3 and sys.argv[1] in ("closed", "compact"):
        return run(sys.argv[1], int(sys.argv[2]))
    for n_frames in map(int, sys.argv[1:] or LENGTHS):
        for what in ("closed", "compact"):  # each in a process of its own, for its memory
            subprocess.run([sys.executable, __file__, what, str(n_frames)], check=True)
    return None


if __name__ == "__main__":
    main()
