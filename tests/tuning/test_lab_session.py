"""A side of the lab: its size, its bytes and its error are those of the very file, whatever profile and reduction."""

import threading

import numpy as np
import pytest

from qmd_studio.codecs.compact import file as compact_file
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import Cancelled, CodecError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from qmd_studio.tuning.budget import budget_of_file
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings
from qmd_studio.tuning.lab_session import LabSession
from qmd_studio.tuning.reachable import allowance_mm, reachable_mm
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.size_figures import known_figures
from tests.generated_motion import walker
from tests.paper_settings import paper

BOUNDED = paper(encoder=Encoder.BOUNDED, max_error_mm=3.0)
SETTINGS = [
    paper(),
    paper(fdf=3, bits=9, segment=30, encoder=Encoder.PAPER),
    BOUNDED,
    EncodeSettings(COMPACT_DEFAULT),
    EncodeSettings(CompactSettings(max_error_mm=2.0)),
]
REDUCTIONS = [Reduction(), Reduction(3), Reduction(2, 5)]


@pytest.fixture(scope="module")
def motion():
    return walker(150)


@pytest.fixture(scope="module")
def session(motion):
    return LabSession(motion)


@pytest.mark.parametrize("reduction", REDUCTIONS)
@pytest.mark.parametrize("settings", SETTINGS)
def test_a_report_says_what_a_stranger_finds_in_the_file(session, motion, tmp_path, settings, reduction):
    settings = EncodeSettings(settings.coding, reduction)
    report = session.evaluate(settings)
    path = tmp_path / "file.qmd"
    path.write_bytes(report.data)
    stranger = open_file(path).motion
    played = motion.with_values(reduction.restore(stranger, motion).X)
    error = measure(motion, played)
    assert report.size.file_bytes == len(report.data)
    assert report.error.distance_mm.shape[0] == motion.n_frames
    assert report.error.mean_mm == pytest.approx(error.mean_mm, rel=2e-3, abs=1e-4)
    assert report.error.max_mm == pytest.approx(error.max_mm, rel=2e-3, abs=1e-3)
    np.testing.assert_allclose(report.played.X, played.X, rtol=0, atol=1e-12)
    assert report.budget == budget_of_file(report.data)
    assert report.fps == stranger.fps == motion.fps / reduction.fps_divisor
    known = known_figures(motion, settings.fitted(motion))
    assert known is None or known == report.size
    assert (known is not None) == settings.size_is_known


def test_the_parts_of_a_compact_payload_add_up(session):
    size = session.evaluate(EncodeSettings(COMPACT_DEFAULT)).size
    parts = size.payload
    assert parts.bytes == parts.count_bytes + parts.prelude_bytes + parts.stream_bytes
    assert parts.n_segments == size.n_segments == 2
    assert min(parts.count_bytes, parts.prelude_bytes, parts.stream_bytes) > 0


def test_a_compact_side_is_what_the_command_line_writes(session, motion):
    settings = CompactSettings(mean_error_mm=0.3)
    assert session.evaluate(EncodeSettings(settings)).data == compact_file.encode(motion, settings).data


def test_what_the_bounded_encoder_found_is_told(session):
    report = session.evaluate(BOUNDED)
    assert report.found.n_segments == report.size.n_segments
    assert report.error.max_mm <= 3.0
    assert session.evaluate(paper()).found is None


@pytest.mark.parametrize(
    "settings",
    [paper(encoder=Encoder.BOUNDED, max_error_mm=1e-6), EncodeSettings(CompactSettings(max_error_mm=1e-6))],
)
def test_an_error_that_cannot_be_kept_to_names_the_best_and_that_can_be_asked_for(session, settings):
    with pytest.raises(CodecError) as caught:
        session.evaluate(settings)
    best = reachable_mm(caught.value)
    assert 1e-6 < best < 1.0
    allowed = allowance_mm(best)
    assert best < allowed < 1.2 * best
    assert session.evaluate(settings.allowing(allowed)).error.max_mm <= 1.3 * best  # measured in single precision


def test_other_problems_name_no_error(session):
    with pytest.raises(CodecError) as caught:
        session.evaluate(paper(bits=99))
    assert reachable_mm(caught.value) is None


def test_a_search_for_a_bound_is_stopped(session):
    stop = threading.Event()
    stop.set()
    with pytest.raises(Cancelled):
        session.evaluate(paper(encoder=Encoder.BOUNDED, max_error_mm=0.5), cancel=stop)


def test_settings_are_fitted_to_what_is_left_of_the_motion():
    motion = walker(40)
    fitted = EncodeSettings(QmdSettings(fdf=60, segment=30), Reduction(2, 5, 1)).fitted(motion)
    left = fitted.reduction.n_columns(motion.skeleton)
    assert left < 60 == EncodeSettings(QmdSettings(fdf=60)).fitted(motion).coding.fdf
    assert fitted == EncodeSettings(QmdSettings(fdf=left), Reduction(2, 5))
    assert EncodeSettings(COMPACT_DEFAULT).fitted(motion).coding.segment == 0
    assert EncodeSettings(reduction=Reduction(1000)).fitted(motion).reduction.fps_divisor == 40


def test_a_bap_body_is_reduced_by_level_of_articulation():
    skeleton = bap_skeleton()
    steps = np.random.default_rng(2).normal(0, 0.01, (60, skeleton.n_columns))
    motion = Motion(skeleton, np.cumsum(steps, axis=0), 25.0)
    session = LabSession(motion)
    whole, fewer = (session.evaluate(EncodeSettings(reduction=Reduction(max_loa=loa))) for loa in (None, 1))
    assert fewer.size.payload.bytes < 0.7 * whole.size.payload.bytes
    assert fewer.error.mean_mm > whole.error.mean_mm
    assert fewer.played.X.shape == motion.X.shape
