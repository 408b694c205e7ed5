"""The compact profile on real motion: how small it is, and that it keeps to its error on every kind of skeleton."""

import pytest
from corpus import corpus_file

from qmd_studio.codecs.compact.file import encode
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.container import HEADER
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.motion.metrics import measure
from qmd_studio.registry import open_file

pytestmark = pytest.mark.corpus


@pytest.mark.parametrize(
    ("clip", "segment", "mean_error_mm", "bytes_a_frame"),
    [("02_01", 120, 0.1, 24.9), ("02_01", 120, 1.0, 5.95), ("02_01", 0, 0.5, 10.35), ("05_03", 120, 0.5, 18.2),
     ("05_03", 0, 1.0, 11.4), ("09_06", 120, 1.0, 11.4)],
)  # fmt: skip
def test_encode_of_a_raw_clip_is_as_small_as_it_was_measured(clip, segment, mean_error_mm, bytes_a_frame):
    motion = open_file(corpus_file(f"cmu_asfamc/{clip}.amc")).motion
    encoded = encode(motion, CompactSettings(mean_error_mm=mean_error_mm, segment=segment))
    assert measure(motion, decode(encoded.data)).mean_mm <= mean_error_mm
    assert (HEADER.size + encoded.payload_bytes) / motion.n_frames <= bytes_a_frame


@pytest.mark.parametrize(
    "name",
    ["bvh/mass_run.bvh", "bvh/possumwood_49_06.bvh", "bvh/pybvh_rotation_first_root.bvh", "bvh/bvhio_example.bvh",
     "bvh/makehuman_walk1.bvh", "bap/vreng_bof.bap", "bap/vreng_pause.bap"],
)  # fmt: skip
def test_encode_of_any_skeleton_keeps_to_its_error(name):
    motion = open_file(corpus_file(name)).motion
    for wanted in (CompactSettings(mean_error_mm=0.5), CompactSettings(max_error_mm=3.0, segment=30)):
        error = measure(motion, decode(encode(motion, wanted).data))
        assert error.mean_mm <= (wanted.mean_error_mm or 3.0)
        assert error.max_mm <= (wanted.max_error_mm or 1e9)
