"""A trial of the search says what the tuning session says, whatever the motion and whoever asks at the same time."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind
from qmd_studio.registry import open_file
from qmd_studio.tuning.encoders import FAST_ENCODERS, PLAIN_CLOSED
from qmd_studio.tuning.evaluator import FastEvaluator, SessionEvaluator, evaluator_for
from qmd_studio.tuning.session import TuningSession
from tests.corpus import corpus_files
from tests.generated_motion import walker

POINTS = [(0, 0), (3, 30), (6, 150), (17, 40), (61, 0), (62, 30)]
BITS = (8, 10, 16)


def assert_says_what_the_session_says(motion, base, points=POINTS):
    session, evaluator = TuningSession(motion), FastEvaluator(motion, base)
    for fdf, segment in points:
        for trial in evaluator.try_bits(fdf, segment, BITS):
            report = session.evaluate(trial.paper)
            assert trial.paper == report.settings
            assert trial.bytes == report.size.bytes == evaluator.size(fdf, trial.paper.bits, segment)
            for name in ("def_", "mean_mm", "max_mm"):
                assert getattr(trial, name) == pytest.approx(getattr(report.error, name), rel=1e-4, abs=1e-7), name


@pytest.mark.parametrize("base", [QmdSettings(encoder=e) for e in FAST_ENCODERS], ids=str)
def test_a_trial_is_what_the_session_measures(base):
    assert_says_what_the_session_says(walker(200), base)


@pytest.mark.parametrize(("k", "rqt"), [(0.0, 10_000), (1.5, 300), (float("inf"), 7)])
def test_the_papers_constants_count(k, rqt):
    assert_says_what_the_session_says(walker(120), QmdSettings(encoder=Encoder.PAPER, k=k, rqt=rqt), POINTS[:4])


@pytest.mark.parametrize("path", corpus_files("cmu_asfamc/backflip.amc") + corpus_files("bvh/accad_Male1_B3_Walk.bvh"))
@pytest.mark.parametrize("encoder", FAST_ENCODERS)
def test_a_trial_of_real_motion_is_what_the_session_measures(path, encoder):
    assert_says_what_the_session_says(open_file(path).motion, QmdSettings(encoder=encoder))


@pytest.mark.parametrize("encoder", FAST_ENCODERS)
@pytest.mark.parametrize("n_frames", [1, 2, 129])
def test_short_motions_and_constant_columns_can_be_tried(encoder, n_frames):
    motion = walker(n_frames)
    X = motion.X.copy()
    X[:, 10:40] = X[0, 10:40]
    assert_says_what_the_session_says(motion.with_values(X), QmdSettings(encoder=encoder), [(0, 0), (40, 0)])
    still = motion.with_values(np.repeat(X[:1], n_frames, axis=0))
    trial = FastEvaluator(still, QmdSettings(encoder=encoder)).try_bits(0, 0, (8,))[0]
    assert trial.def_ == pytest.approx(0, abs=1e-5)  # metres that float32 rounds in the file's unit


@pytest.mark.parametrize("encoder", FAST_ENCODERS)
def test_bodies_of_body_animation_parameters_and_huge_values_can_be_tried(encoder):
    skeleton = bap_skeleton()
    random = np.random.default_rng(3)
    X = 0.02 * np.cumsum(random.normal(size=(90, skeleton.n_columns)), axis=0)
    assert_says_what_the_session_says(
        Motion(skeleton, X, 25.0, "noise"), QmdSettings(encoder=encoder), [(0, 0), (9, 30)]
    )
    opaque = [i for i, c in enumerate(skeleton.columns) if c.kind not in (ColumnKind.ROTATION, ColumnKind.TRANSLATION)]
    if opaque:
        X[:, opaque[0]] = random.normal(size=90) * 1e29
        assert_says_what_the_session_says(Motion(skeleton, X, 25.0, "huge"), QmdSettings(encoder=encoder), [(0, 0)])


def test_threads_do_not_disturb_each_other():
    evaluator = evaluator_for(walker(150), QmdSettings(encoder=PLAIN_CLOSED))
    points = [(fdf, segment) for segment in (0, 30, 40, 50, 60, 90) for fdf in range(0, 62, 7)]
    alone = [evaluator.try_bits(*point, (8, 9)) for point in points]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda point: evaluator.try_bits(*point, (8, 9)), points)) == alone


def test_an_encoder_without_kernels_is_tried_whole():
    motion, base = walker(100), QmdSettings()
    (whole,) = SessionEvaluator(motion, base).try_bits(6, 30, (9,))
    report = TuningSession(motion).evaluate(QmdSettings(6, 9, 30))
    assert (whole.paper, whole.bytes, whole.def_) == (report.settings, report.size.bytes, report.error.def_)
    assert not SessionEvaluator(motion, base).is_fast


def test_settings_out_of_range_are_refused():
    evaluator = evaluator_for(walker(50), QmdSettings(encoder=PLAIN_CLOSED))
    with pytest.raises(CodecError):
        evaluator.try_bits(63, 0, (8,))
    with pytest.raises(CodecError):
        evaluator.try_bits(6, 0, (17,))


def test_a_motion_without_points_is_refused():
    motion = walker(20)
    bare = Motion(replace(motion.skeleton, points=()), motion.X, 120.0, "bare")
    with pytest.raises(CodecError, match="nothing to tune"):
        evaluator_for(bare, QmdSettings())
