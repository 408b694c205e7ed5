"""What the sliders are told is true of the bytes that Export writes."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from qmd_studio.tuning.session import TuningSession
from tests.corpus import corpus_file
from tests.generated_motion import walker

FIGURES = {
    "def_": 1e-5,
    "mean_mm": 1e-4,
    "p99_mm": 1e-3,
    "max_mm": 1e-3,
    "velocity_mm_s": 0.05,
    "acceleration_mm_s2": 10.0,
}
"""What is reported, and how much of it single precision may invent."""
SETTINGS = [
    QmdSettings(),
    QmdSettings(encoder=Encoder.PAPER),
    QmdSettings(fdf=0, bits=9, segment=40),
    QmdSettings(encoder=Encoder.PLAIN),
    QmdSettings(fdf=26, bits=10, segment=30, encoder=Encoder.PAPER, k=1.0),
]


def assert_true_of_its_bytes(motion, report):
    decoded = decode(report.data)
    assert np.array_equal(decoded.X, report.decoded.X)
    assert len(report.data) == report.file_bytes
    truth = measure(motion, decoded)
    for name, noise in FIGURES.items():
        assert getattr(report.error, name) == pytest.approx(getattr(truth, name), rel=0.003, abs=noise), name
    assert report.error.distance_mm.shape == (motion.n_frames, len(motion.skeleton.points))
    np.testing.assert_allclose(report.error.distance_mm, truth.distance_mm, atol=0.005)
    worst = truth.distance_mm[report.error.worst_frame, motion.skeleton.point_names.index(report.error.worst_joint)]
    assert worst == pytest.approx(truth.max_mm, abs=0.005)


@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_evaluate_reports_the_error_of_decoding_its_own_bytes(settings):
    motion = walker(150)
    assert_true_of_its_bytes(motion, TuningSession(motion).evaluate(settings))


@pytest.mark.corpus
@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_evaluate_of_a_real_motion_reports_the_error_of_its_bytes(settings):
    motion = open_file(corpus_file("cmu_asfamc/49_08.amc")).motion
    assert_true_of_its_bytes(motion, TuningSession(motion).evaluate(settings))


def test_evaluate_of_body_animation_parameters_keeps_their_mask():
    skeleton = bap_skeleton()
    X = np.cumsum(np.random.default_rng(3).normal(0, 0.01, (40, skeleton.n_columns)), axis=0)
    motion = Motion(skeleton, X, 25.0, "wave", np.ones(X.shape, dtype=bool))
    report = TuningSession(motion).evaluate(QmdSettings())
    assert_true_of_its_bytes(motion, report)
    assert decode(report.data).mask.all()


def test_evaluate_far_from_the_origin_is_as_exact_as_near_it():
    near = walker(100)
    X = near.X.copy()
    X[:, 0] += 2000.0
    motion = near.with_values(X)
    assert_true_of_its_bytes(motion, TuningSession(motion).evaluate(QmdSettings()))


def test_evaluate_of_a_draft_is_true_of_its_own_bytes_and_of_the_same_size():
    motion = walker(200)
    session = TuningSession(motion)
    draft, exact = session.evaluate(QmdSettings(), draft=True), session.evaluate(QmdSettings())
    assert (draft.draft, exact.draft) == (True, False)
    assert draft.size == exact.size
    assert_true_of_its_bytes(motion, draft)
    assert exact.error.def_ < draft.error.def_ < 4 * exact.error.def_
    assert exact.data == encode(motion).data


@pytest.mark.parametrize("encoder", [Encoder.PAPER, Encoder.PLAIN])
def test_evaluate_by_an_encoder_that_is_quick_anyway_makes_no_drafts(encoder):
    session, settings = TuningSession(walker(60)), QmdSettings(encoder=encoder)
    draft = session.evaluate(settings, draft=True)
    assert not draft.draft
    assert draft.data == session.evaluate(settings).data


def test_evaluate_within_a_bound_reports_its_bytes_and_has_no_size_before():
    motion = walker(80)
    session, settings = TuningSession(motion), QmdSettings(encoder=Encoder.BOUNDED, max_error_mm=0.4)
    with pytest.raises(CodecError, match="known only once"):
        session.size(settings)
    report = session.evaluate(settings)
    assert_true_of_its_bytes(motion, report)
    assert measure(motion, report.decoded).max_mm <= 0.4


def test_evaluate_of_one_frame_has_no_velocity():
    motion = walker(1)
    report = TuningSession(motion).evaluate(QmdSettings())
    assert_true_of_its_bytes(motion, report)
    assert report.error.velocity_mm_s == 0.0


def test_evaluate_leaves_earlier_reports_as_they_were():
    session = TuningSession(walker(80))
    first = session.evaluate(QmdSettings())
    mean, distance = first.error.mean_mm, first.error.distance_mm.copy()
    session.evaluate(QmdSettings(fdf=0, encoder=Encoder.PAPER))
    assert first.error.mean_mm == mean
    assert np.array_equal(first.error.distance_mm, distance)
    assert describe(first.data)["fdf"] == 6
    assert np.array_equal(decode(first.data).X, first.decoded.X)


def test_evaluate_on_a_worker_thread_can_be_exported_on_another():
    motion = walker(80)
    session = TuningSession(motion)
    with ThreadPoolExecutor(1) as worker:
        report = worker.submit(session.evaluate, QmdSettings(bits=9)).result()
    assert_true_of_its_bytes(motion, report)


@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_size_is_known_before_anything_is_encoded(settings):
    session = TuningSession(walker(150))
    told, told_whole = session.size(settings), session.file_bytes(settings)
    data = session.evaluate(settings).data
    assert told.bytes == describe(data)["payload_bytes"]
    assert told_whole == len(data) == told.bytes + 64 + session.skeleton_bytes


def test_size_of_a_segment_longer_than_the_motion_is_that_of_one_segment():
    session = TuningSession(walker(50))
    assert session.size(QmdSettings(segment=5000)) == session.size(QmdSettings(segment=0))


def test_size_with_settings_out_of_range_is_refused():
    with pytest.raises(CodecError, match="FDF"):
        TuningSession(walker(50)).size(QmdSettings(fdf=63))
