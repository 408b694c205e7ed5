"""The comparison of codecs: its figures are those of the very bytes, and its verdict goes against QMD where it must."""

from dataclasses import replace

import numpy as np
import pytest
from corpus import corpus_file
from generated_motion import walker

from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.units import codec_matrix, motion_matrix
from qmd_studio.codecs.rivals import lossless, range_delta
from qmd_studio.errors import CodecError
from qmd_studio.motion.metrics import measure
from qmd_studio.registry import open_file
from qmd_studio.tuning.budget import budget_of_file
from qmd_studio.tuning.coding import Coding, last_that_holds
from qmd_studio.tuning.comparison import compare, usual_bytes
from qmd_studio.tuning.contenders import CONTENDERS, Contender
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import wide_grid
from qmd_studio.tuning.verdict import verdict

MEAN_MM = 0.5
BY_NAME = {contender.name: contender for contender in CONTENDERS}
FOREIGN = {
    "range + delta + pcodec": range_delta.decode,
    "pcodec lossless": lossless.pcodec_matrix,
    "zip of float32": lossless.zip_matrix,
    "zstd of float32": lossless.zstd_matrix,
    "float32 raw": lossless.raw_matrix,
}


@pytest.fixture(scope="module")
def walk():
    return walker(150)


@pytest.fixture(scope="module")
def compared(walk):
    return compare(walk, mean_error_mm=MEAN_MM)


def decoded(row, motion):
    """Decode a row's bytes: QMD's as the studio opens a file, others from the payload."""
    if row.is_qmd:
        return decode(row.file)
    matrix = FOREIGN[row.name](row.data, motion.skeleton.n_columns)
    return motion.with_values(motion_matrix(matrix, motion.skeleton))


def check_rows(comparison, motion):
    rows = comparison.at_error + comparison.at_size
    assert len(rows) + 2 * len(comparison.absent) == 2 * len(CONTENDERS)
    for row in rows:
        error = measure(motion, decoded(row, motion))
        for name in ("def_", "mean_mm", "p99_mm", "max_mm", "velocity_mm_s"):
            assert getattr(row.error, name) == pytest.approx(getattr(error, name), rel=1e-6), (row.name, name)
        if row.is_qmd:
            assert row.file_bytes == len(row.file)
            assert row.data in row.file
            assert row.instructions == budget_of_file(row.file).instructions_per_frame > 0
        assert row.bytes_per_frame == len(row.data) / motion.n_frames
        assert row.kbps == pytest.approx(len(row.data) * 8 / 1000 * motion.fps / motion.n_frames)
        assert row.encode_us > 0
        assert row.decode_us > 0
    assert all(row.error.mean_mm <= 1.001 * comparison.mean_error_mm for row in comparison.at_error if row.met)
    assert all((len(row.data) <= comparison.n_bytes) == row.met for row in comparison.at_size)


def test_figures_are_those_of_decoding_the_very_bytes(compared, walk):
    check_rows(compared, walk)


def test_paper_row_is_the_least_of_all_settings(compared, walk):
    grid = wide_grid(walk)
    trials = exhaustive(evaluator_for(walk, QmdSettings(encoder=Encoder.PAPER)), grid).trials
    (row,) = (row for row in compared.at_error if row.name == "QMD paper")
    assert len(row.data) == min(trial.bytes for trial in trials if trial.mean_mm <= MEAN_MM)
    (row,) = (row for row in compared.at_size if row.name == "QMD paper")
    assert row.error.def_ == pytest.approx(min(t.def_ for t in trials if t.bytes <= usual_bytes(walk)), rel=1e-3)


def test_every_knob_is_turned_as_far_as_it_goes(compared):
    for row in compared.at_error:
        if row.name.startswith(("QMD compact", "range")):
            assert row.error.mean_mm > 0.95 * MEAN_MM, row.name
    for row in compared.at_size:
        if row.name.startswith(("QMD compact", "range")):
            assert len(row.data) > 0.98 * compared.n_bytes, row.name


def test_verdict_is_that_of_the_rows(compared):
    best = min((row for row in compared.at_error if row.met), key=lambda row: len(row.data))
    paper = compared.at_error[0]
    first = verdict(compared)[0]
    assert first.startswith(f"Smallest at 0.5 mm: {best.name}, {best.bytes_per_frame:.1f} bytes a frame")
    assert f"{len(paper.data) / len(best.data):,.1f} times as much" in first


def test_verdict_says_what_the_smallest_pays(compared):
    best = min((row for row in compared.at_error if row.met), key=lambda row: len(row.data))
    least = min(row.instructions for row in compared.at_error if row.met and row.instructions)
    assert best.name.startswith("QMD compact")
    assert f"{best.instructions / least:,.1f} times the instructions of QMD" in verdict(compared)[1]


def test_verdict_names_what_beats_qmd(compared):
    rival = replace(compared.at_error[-1], name="a better one", data=b"12", met=True)
    sentences = verdict(replace(compared, at_error=(*compared.at_error, rival)))
    assert sentences[0].startswith("Smallest at 0.5 mm: a better one")
    (loss,) = (sentence for sentence in sentences if "a better one is smaller" in sentence)
    assert all(row.name in loss for row in compared.at_error if row.is_qmd and row.met)


def test_verdict_says_that_the_paper_does_not_get_there(walk):
    comparison = compare(walk, mean_error_mm=1e-3, contenders=[BY_NAME["QMD paper"], BY_NAME["pcodec lossless"]])
    assert not comparison.at_error[0].met
    assert comparison.at_error[1].met
    assert "does not get there" in verdict(comparison)[0]


class _Remembered:
    """A contender that sends nothing: it has the motion already."""

    def __init__(self, motion):
        self._matrix = codec_matrix(motion)

    def for_error(self, mean_mm):
        return Coding("by heart", lambda: b"!", lambda data: self._matrix)

    def for_size(self, n_bytes):
        raise CodecError("is never large")


def test_another_codec_is_another_row(walk):
    comparison = compare(walk, contenders=[BY_NAME["float32 raw"], Contender("memory", _Remembered)])
    assert [row.name for row in comparison.at_error] == ["float32 raw", "memory"]
    assert comparison.at_error[1].bytes_per_frame == 1 / walk.n_frames
    assert comparison.absent == ("memory, at equal size: is never large",)


def test_what_is_missing_here_is_named(walk):
    lacking = Contender("zstd of float32", _Remembered, lacks=lambda: "zstd: not in this Python")
    comparison = compare(walk, contenders=[BY_NAME["float32 raw"], lacking])
    assert comparison.absent == ("zstd: not in this Python",)


def test_size_that_nothing_fits_is_said_to_be_missed(walk):
    contenders = [contender for name, contender in BY_NAME.items() if name != "QMD closed"]
    comparison = compare(walk, n_bytes=10, contenders=contenders)
    assert not any(row.met for row in comparison.at_size)
    assert not any(sentence.startswith("Closest") for sentence in verdict(comparison))


def test_motion_of_one_frame_is_compared():
    check_rows(compare(walker(1)), walker(1))


def test_motion_without_points_is_refused(walk):
    with pytest.raises(CodecError, match="nothing to compare"):
        compare(replace(walk, skeleton=replace(walk.skeleton, points=())))


def test_bisection_stops_at_the_last_that_holds():
    assert last_that_holds(lambda x: x < 0.7, 0.0, 1.0) == pytest.approx(0.7, abs=1e-3)
    assert last_that_holds(lambda x: x > 0.7, 1.0, 0.0) == pytest.approx(0.7, abs=1e-3)
    assert last_that_holds(lambda x: False, 0.0, 1.0) == 0.0


@pytest.mark.corpus
def test_walk_of_the_paper_keeps_the_known_order():
    motion = open_file(corpus_file("cmu_asfamc/02_01.amc")).motion
    comparison = compare(motion)
    check_rows(comparison, motion)
    at_error = {row.name: row.bytes_per_frame for row in comparison.at_error}
    assert at_error["QMD compact, whole clip"] < 12
    assert at_error["QMD compact, 120 frames"] < 12
    assert 55 < at_error["range + delta + pcodec"] < 66
    assert at_error["QMD paper"] > 2 * at_error["range + delta + pcodec"]
    at_size = {row.name: row.error for row in comparison.at_size}
    assert at_size["QMD closed"].def_ < 0.0025 < 0.1 < at_size["QMD paper"].def_
    rounded = range_delta.encode(codec_matrix(motion), 12)
    assert len(rounded) / motion.n_frames == pytest.approx(68 + 8 * 62 / 343, abs=0.7)
    assert np.isfinite([row.error.mean_mm for row in comparison.at_error]).all()
