"""QMD beside other codecs on three clips, at equal error and at equal size: what `qmd compare` prints, kept short.

    python tests/benchmarks/contenders.py [clip…]

Bytes are those of payloads. Times, which wander with the machine, and the C decoder's instructions are those at equal
error.
"""

import sys

from bench_motion import CORPUS

from qmd_studio.registry import open_file
from qmd_studio.tuning.comparison import compare
from qmd_studio.tuning.verdict import verdict

CLIPS = ("02_01", "05_03", "60_01")
HEADING = f"{'':26} B/frame  mean mm  max mm  enc µs  dec µs  instr. | mean mm  max mm"


def main():
    for name in sys.argv[1:] or CLIPS:
        path = CORPUS / "cmu_asfamc" / f"{name}.amc"
        if not path.exists():
            print(f"no {path}; set QMD_CORPUS to the corpus of real motions")
            continue
        motion = open_file(path).motion
        comparison = compare(motion)
        print(f"{name}, {motion.n_frames} frames: mean {comparison.mean_error_mm} mm | {comparison.n_bytes:,} bytes")
        print(HEADING)
        at_size = {row.name: row for row in comparison.at_size}
        for row in comparison.at_error:
            print(f"{row.name:26} {at_error(row)} | {in_size(at_size[row.name])}")
        print(*verdict(comparison), "", sep="\n", flush=True)


def at_error(row):
    work = f"{row.instructions:,.0f}" if row.instructions else ""
    return (
        f"{row.bytes_per_frame:7.1f} {figure(row.error.mean_mm):>8} {figure(row.error.max_mm):>7}"
        f" {row.encode_us:7.1f} {row.decode_us:7.2f} {work:>7}{'' if row.met else ' (not met)'}"
    )


def in_size(row):
    return f"{figure(row.error.mean_mm):>7} {figure(row.error.max_mm):>7}" if row.met else "too large"


def figure(value):
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


if __name__ == "__main__":
    main()
