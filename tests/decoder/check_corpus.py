"""Decodes every clip of the corpus, whole, in C and in Python: `make check-decoder`. The suite takes 400 frames.

Both versions of the format, each bit compared; the C decoder runs under the sanitisers. Needs a C compiler.
"""

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from qmd_studio.codecs.compact.encode import CompactEncoder  # noqa: E402
from qmd_studio.codecs.compact.payload import pack  # noqa: E402
from qmd_studio.codecs.compact.settings import CompactSettings  # noqa: E402
from qmd_studio.codecs.qmd.container import build_compact  # noqa: E402
from qmd_studio.codecs.qmd.encode import encode  # noqa: E402
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings  # noqa: E402
from qmd_studio.errors import FormatError  # noqa: E402
from qmd_studio.registry import open_file  # noqa: E402
from tests.corpus import CORPUS  # noqa: E402
from tests.decoder.c_decoder import SANITISED, SOURCES, CDecoder, compile_c  # noqa: E402
from tests.decoder.python_decoder import assert_same  # noqa: E402


def files_of(motion):
    """Yield files of a whole motion, of both versions."""
    for fdf, bits, segment in ((6, 8, 0), (1, 9, 150)):
        chosen = QmdSettings(fdf, bits, segment, Encoder.CLOSED).fitted(motion.skeleton.n_columns)
        yield encode(motion, chosen).data
    for fineness, segment in ((0.012, 120), (0.08, 0)):  # about 0.2 and 1 mm
        encoder = CompactEncoder(motion, CompactSettings(mean_error_mm=1.0, segment=segment))
        yield build_compact(pack(encoder.encode(fineness).payload), b"block", motion.fps, segment)


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "driver"
        complaint = compile_c(program, Path(__file__).parent / "driver.c", SOURCES / "qmd_decoder.c", flags=SANITISED)
        if complaint:
            raise SystemExit(complaint)
        decoder = CDecoder(program)
        clips = frames = files = 0
        for path in sorted(p for kind in ("cmu_*/*.amc", "bap/*.bap", "bvh/*.bvh") for p in CORPUS.glob(kind)):
            try:
                motion = open_file(path).motion
            except FormatError:
                continue
            if not motion.skeleton.n_columns:
                continue
            clips, frames = clips + 1, frames + motion.n_frames
            for data in files_of(motion):
                outcome = assert_same(decoder, data)
                assert (outcome.status, outcome.frames) == ("END", motion.n_frames)
                files += 1
            print(f"{path.name}: {motion.n_frames} frames, the same", flush=True)
        decoder.close()
    print(f"{clips} clips, {frames:,} frames, {files} files: C and Python agree to the last bit")
    return int(not clips)


if __name__ == "__main__":
    raise SystemExit(main())
