"""Every real motion goes through a QMD file and comes back."""

import numpy as np
import pytest

from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.motion.metrics import measure
from qmd_studio.registry import open_file
from qmd_studio.tuning.session import TuningSession
from tests.corpus import corpus_files


@pytest.mark.parametrize("path", corpus_files("cmu_asfamc/*.amc"))
def test_closed_loop_of_every_captured_motion_is_a_hundred_times_closer_at_equal_bytes(path):
    session = TuningSession(open_file(path).motion)
    paper = session.evaluate(QmdSettings(encoder=Encoder.PAPER))
    plain = session.evaluate(QmdSettings(encoder=Encoder.PLAIN))
    closed = session.evaluate(QmdSettings(encoder=Encoder.CLOSED))
    assert paper.file_bytes == plain.file_bytes == closed.file_bytes
    assert plain.error.def_ < paper.error.def_ / 30
    assert closed.error.def_ < paper.error.def_ / 120
    assert plain.error.mean_mm < 0.5
    assert closed.error.max_mm <= 8.0


@pytest.mark.parametrize("path", [*corpus_files("bvh/*.bvh"), *corpus_files("bap/*.bap")])
def test_encode_of_every_other_motion_comes_back_close_on_its_own_skeleton(path):
    motion = open_file(path).motion
    plain = encode(motion, QmdSettings(encoder=Encoder.PLAIN).fitted(motion.skeleton.n_columns)).decoded
    encoded = encode(motion)
    decoded = decode(encoded.data)
    assert decoded.skeleton == motion.skeleton
    assert decoded.name == motion.name
    assert np.array_equal(decoded.X, encoded.decoded.X)
    assert (decoded.mask is None) == (motion.mask is None)
    assert motion.mask is None or np.array_equal(decoded.mask, motion.mask)
    steps = np.abs(np.diff(motion.X, axis=0)).max(initial=0.0)
    assert np.abs(plain.X - motion.X).max() <= max(0.05 * steps, 1e-5)
    assert measure(motion, decoded).def_ <= max(measure(motion, plain).def_ / 2, 1e-4)
