"""Decoding a QMD file against a plain copy of the matrix that it holds."""

from bench_motion import alternate, bench_motion

from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.decode import decode, decode_payload
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.payload import unpack
from qmd_studio.codecs.qmd.units import motion_matrix


def main():
    motion = bench_motion()
    data = encode(motion).data

    def matrix():
        return motion_matrix(decode_payload(unpack(container.parse(data).payload)), motion.skeleton)

    row("decoding QMD, file to matrix", *alternate(matrix, motion.X.copy, 301), "at most 8")
    row("decoding QMD, file to motion with skeleton", *alternate(lambda: decode(data), motion.X.copy, 301), "")


def row(title, ours_ms, copy_ms, bar):
    print(f"{title} | {ours_ms:.3f} ms | a copy: {copy_ms:.3f} ms | {ours_ms / copy_ms:.1f} | {bar}")


if __name__ == "__main__":
    main()
