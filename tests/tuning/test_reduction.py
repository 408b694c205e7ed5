"""Fewer frames and fewer columns: what is left, how it plays, and that the error is told of the whole original."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.errors import CodecError
from qmd_studio.motion.bap import bap, bap_skeleton
from qmd_studio.motion.in_between import in_between
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.session import TuningSession
from tests.corpus import corpus_file
from tests.generated_motion import walker


def test_reduction_by_default_changes_nothing():
    motion = walker(50)
    reduced = Reduction().reduce(motion)
    assert reduced.skeleton == motion.skeleton
    assert np.array_equal(reduced.X, motion.X)
    assert np.array_equal(Reduction().restore(reduced, motion).X, motion.X)
    session, plain = ReducedSession(motion, Reduction()), TuningSession(motion)
    assert session.evaluate(QmdSettings()).data == plain.evaluate(QmdSettings()).data


@settings(max_examples=60, deadline=None)
@given(every=st.integers(1, 12), n_frames=st.integers(1, 40), max_level=st.integers(1, 6), seed=st.integers(0, 99))
def test_restored_motion_is_the_original_where_it_was_kept_and_in_between_elsewhere(every, n_frames, max_level, seed):
    motion = walker(n_frames, seed=seed)
    flipped = motion.X.copy()
    flipped[n_frames // 2 :, 20] += np.pi
    motion = motion.with_values(flipped)
    reduction = Reduction(every, max_level)
    reduced = reduction.reduce(motion)
    restored = reduction.restore(reduced, motion)
    kept = reduction.kept_columns(motion.skeleton)
    assert reduced.X.shape == (reduction.n_rows(n_frames) + 1, kept.sum())
    assert reduced.fps == 120.0 / every
    assert np.array_equal(restored.X[::every][:, kept], motion.X[::every][:, kept])
    assert np.array_equal(restored.X[:, ~kept], np.tile(motion.X[0, ~kept], (n_frames, 1)))
    for frame in range(n_frames):
        low = frame // every
        row = in_between(
            reduced.skeleton, reduced.X[low], reduced.X[min(low + 1, len(reduced.X) - 1)], frame % every / every
        )
        np.testing.assert_allclose(restored.X[frame, kept], row, rtol=0, atol=1e-12)


@pytest.mark.parametrize("max_level", [1, 2, 3, 4, 5])
def test_reduced_skeleton_puts_every_joint_where_the_held_columns_would(max_level):
    motion = walker(30)
    reduction = Reduction(max_level=max_level)
    reduced = reduction.reduce(motion)
    restored = reduction.restore(reduced, motion)
    assert reduced.skeleton.n_columns < motion.skeleton.n_columns
    assert reduced.skeleton.node_names == motion.skeleton.node_names
    here, there = node_positions(reduced.skeleton, reduced.X), node_positions(motion.skeleton, restored.X)
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-12)


def test_held_translations_stay_in_the_rest_of_the_joint():
    motion = walker(30)
    names = {column.name: 6 for column in motion.skeleton.columns[:3]}
    motion = Motion(motion.skeleton.with_levels(names), motion.X + 0.25, motion.fps)
    reduction = Reduction(max_level=5)
    reduced = reduction.reduce(motion)
    assert "root.tx" not in [column.name for column in reduced.skeleton.columns]
    here = node_positions(reduced.skeleton, reduced.X)
    there = node_positions(motion.skeleton, reduction.restore(reduced, motion).X)
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-12)


def test_joint_keeps_its_rotations_together():
    motion = walker(5)
    skeleton = motion.skeleton.with_levels({"lfemur.rx": 2, "lfemur.ry": 6, "lfemur.rz": 6})
    kept = Reduction(max_level=3).kept_columns(skeleton)
    names = [column.name for column, stays in zip(skeleton.columns, kept, strict=True) if stays]
    assert {"lfemur.rx", "lfemur.ry", "lfemur.rz"} <= set(names)


def test_level_of_articulation_holds_the_joints_that_a_simpler_body_lacks():
    skeleton = bap_skeleton()
    random = np.random.default_rng(1)
    motion = Motion(skeleton, random.normal(0, 0.2, (4, skeleton.n_columns)), 30.0)
    counts = [Reduction(max_loa=loa).reduce(motion).skeleton.n_columns for loa in (1, 2, 3)]
    assert counts[0] < counts[1] < counts[2] == skeleton.n_columns
    reduced = Reduction(max_loa=1).reduce(motion)
    assert {bap(column.bap_id).loa for column in reduced.skeleton.columns} <= {0, 1, None}
    restored = Reduction(max_loa=1).restore(reduced, motion)
    here, there = node_positions(reduced.skeleton, reduced.X), node_positions(skeleton, restored.X)
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-12)


def test_mask_is_reduced_with_the_motion():
    skeleton = bap_skeleton()
    mask = np.zeros((7, skeleton.n_columns), dtype=np.bool_)
    mask[3, 0] = mask[6, -1] = True
    motion = Motion(skeleton, np.zeros(mask.shape), 30.0, mask=mask)
    assert Reduction(3).reduce(motion).mask.sum() == 2
    assert Reduction(3, max_loa=0).reduce(motion).mask.shape == (
        3,
        Reduction(3, max_loa=0).kept_columns(skeleton).sum(),
    )


@pytest.mark.parametrize("chosen", [QmdSettings(), QmdSettings(fdf=2, bits=9, segment=20)])
def test_report_of_a_reduced_motion_has_the_file_s_size_and_the_original_s_error(chosen):
    motion, reduction = walker(200), Reduction(4, 4)
    session = ReducedSession(motion, reduction)
    report = session.evaluate(chosen)
    n_columns = int(reduction.kept_columns(motion.skeleton).sum())
    assert report.size == payload_size(49, n_columns, chosen.fdf, chosen.bits, chosen.segment) == session.size(chosen)
    assert len(report.data) == report.file_bytes == session.file_bytes(chosen)
    stranger = decode(report.data)
    assert stranger.fps == 30.0
    assert report.error.distance_mm.shape[0] == 200
    alone = measure(motion, reduction.restore(stranger, motion))
    assert report.error.mean_mm == pytest.approx(alone.mean_mm)
    assert report.error.mean_mm > TuningSession(motion).evaluate(chosen).error.mean_mm


@pytest.mark.corpus
def test_half_the_frames_of_a_walk_are_half_the_bytes_and_hardly_seen():
    motion = open_file(corpus_file("cmu_asfamc/02_01.amc")).motion
    whole, half = (ReducedSession(motion, Reduction(k)).evaluate(QmdSettings()) for k in (1, 2))
    assert (
        0.49
        < (half.size.index_bytes + half.size.exact_bytes) / (whole.size.index_bytes + whole.size.exact_bytes)
        < 0.51
    )
    assert half.error.mean_mm < 2.0


@pytest.mark.parametrize("wrong", [{"fps_divisor": 0}, {"max_level": 0}, {"max_level": 7}, {"max_loa": 4}])
def test_reduction_out_of_range_is_refused(wrong):
    with pytest.raises(CodecError):
        Reduction(**wrong)


def test_reduction_that_leaves_nothing_or_cannot_be_told_is_refused():
    motion = walker(3)
    everything = motion.skeleton.with_levels({column.name: 6 for column in motion.skeleton.columns})
    with pytest.raises(CodecError, match="no column"):
        Reduction(max_level=5).kept_columns(everything)
    with pytest.raises(CodecError, match="articulation"):
        Reduction(max_loa=1).reduce(motion)
    with pytest.raises(CodecError, match="not a reduction"):
        Reduction(2).restore(motion, motion)
