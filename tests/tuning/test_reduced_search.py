"""Searches that leave out frames and joints: the fast way says what the slow one says, and the best of all wins."""

import threading

import numpy as np
import pytest

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.across import across
from qmd_studio.tuning.compact_search import meet_bounded, meet_compact
from qmd_studio.tuning.encode_settings import EncodeSettings, Profile
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import Grid
from qmd_studio.tuning.lab_session import LabSession
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.reductions import combined, distinct, lab_reductions
from qmd_studio.tuning.targets import Target, TargetKind
from qmd_studio.tuning.trade_off import lab_fronts
from tests.generated_motion import walker

GRID = Grid((0, 6, 20), (8, 10), (0, 20))


@pytest.fixture(scope="module")
def motion():
    flipped = walker(100)
    X = flipped.X.copy()
    X[41:, 20] += np.pi
    return flipped.with_values(X)


@pytest.mark.parametrize("reduction", [Reduction(2), Reduction(3, 5), Reduction(1, 4), Reduction(7)])
@pytest.mark.parametrize("encoder", [Encoder.PAPER, Encoder.PLAIN, Encoder.CLOSED])
def test_a_trial_says_what_the_reduced_file_is_measured_at(motion, encoder, reduction):
    base = QmdSettings(encoder=encoder)
    session, evaluator = ReducedSession(motion, reduction), evaluator_for(motion, base, reduction)
    for fdf, segment in ((0, 0), (6, 20)):
        for trial in evaluator.try_bits(fdf, segment, (8, 10)):
            report = session.evaluate(trial.paper)
            assert trial.settings == EncodeSettings(report.settings, reduction)
            assert trial.bytes == report.size.bytes
            assert trial.def_ == pytest.approx(report.error.def_, rel=1e-3)
            assert trial.mean_mm == pytest.approx(report.error.mean_mm, rel=1e-3)
            assert trial.max_mm == pytest.approx(report.error.max_mm, rel=1e-3)


def test_the_best_of_several_reductions_is_the_best_of_all_trials(motion):
    base = QmdSettings(encoder=Encoder.PAPER)
    evaluators = [evaluator_for(motion, base, Reduction(every)) for every in (1, 2, 4)]
    told = []
    searches = [lambda tell, e=e: exhaustive(e, GRID, on_progress=tell) for e in evaluators]
    outcome = across(searches, on_progress=told.append)
    assert outcome.evaluations == len(outcome.trials) == 36
    assert outcome.complete
    assert outcome.best.merit == min(trial.merit for trial in outcome.trials)
    assert {trial.settings.reduction.fps_divisor for trial in outcome.trials} == {1, 2, 4}
    assert [p.done for p in told] == sorted(p.done for p in told)
    assert (told[-1].done, told[-1].total) == (36, 36)
    assert told[-1].best == outcome.best


def test_a_cancelled_search_begins_no_further_reduction(motion):
    stop = threading.Event()
    stop.set()
    outcome = across([lambda tell: pytest.fail("begun")], cancel=stop)
    assert not outcome.complete
    assert outcome.best is None


def test_what_was_found_of_one_reduction_is_not_taken_for_another(motion, tmp_path):
    base, path = QmdSettings(encoder=Encoder.PAPER), tmp_path / "state.json"
    half = evaluator_for(motion, base, Reduction(2))
    exhaustive(half, GRID, memory=Memory(half, path))
    again = exhaustive(half, GRID, memory=Memory(half, path))
    assert again.evaluations == 0
    assert again.best.settings.reduction == Reduction(2)
    for other in (Reduction(), Reduction(3)):
        with pytest.raises(FormatError, match="another"):
            Memory(evaluator_for(motion, base, other), path)


def test_reductions_that_come_to_the_same_are_tried_once(motion):
    assert len(combined((1, 2), (6, 5), (None, 1))) == 8
    assert distinct(combined((1, 2), (6, 5), (None, 1)), motion) == (
        Reduction(1, 6), Reduction(1, 5), Reduction(2, 6), Reduction(2, 5)
    )  # fmt: skip
    nothing = motion.skeleton.with_levels({column.name: 6 for column in motion.skeleton.columns})
    with pytest.raises(CodecError, match="no column"):
        distinct([Reduction(max_level=3)], Motion(nothing, motion.X, motion.fps))


def test_the_lab_tries_nothing_left_out_first_and_levels_that_the_skeleton_has(motion):
    skeleton = bap_skeleton()
    body = Motion(skeleton, np.zeros((30, skeleton.n_columns)), 25.0)
    for each in (motion, body):
        reductions = lab_reductions(each)
        assert reductions[0] == Reduction()
        assert len(reductions) >= 7
    assert any(reduction.max_loa == 1 for reduction in lab_reductions(body))
    assert all(reduction.max_loa is None for reduction in lab_reductions(motion))


@pytest.mark.parametrize(
    "target",
    [
        Target(TargetKind.MEAN_MM, 0.4),
        Target(TargetKind.MAX_MM, 40.0),
        Target(TargetKind.DEF, 0.05),
        Target(TargetKind.BYTES, 1500),
        Target(TargetKind.KBPS, 20),
    ],
)
@pytest.mark.parametrize("reduction", [Reduction(), Reduction(2)])
def test_the_compact_profile_meets_a_target_and_gives_away_little(target, reduction):
    motion = walker(100)
    base = EncodeSettings(CompactSettings(mean_error_mm=1.0), reduction)
    best = meet_compact(motion, base, target).best
    assert target.met_by(best, motion)
    assert best.settings.reduction == reduction
    report = LabSession(motion).evaluate(best.settings)
    assert (report.size.payload.bytes, report.error.mean_mm) == (best.bytes, best.mean_mm)
    if target.bounds_size:
        assert best.bytes > 0.9 * target.largest_bytes(motion)
    elif reduction == Reduction():
        assert target.error(best) > 0.7 * target.value


def test_a_target_beyond_the_compact_profile_is_answered_with_what_comes_nearest():
    motion = walker(60)
    base = EncodeSettings(CompactSettings(mean_error_mm=1.0))
    outcome = meet_compact(motion, base, Target(TargetKind.BYTES, 10))
    assert not Target(TargetKind.BYTES, 10).met_by(outcome.best, motion)
    assert outcome.best.bytes == min(trial.bytes for trial in outcome.trials)


def test_a_bound_is_a_target_of_the_bounded_encoder():
    motion, stop = walker(60), threading.Event()
    base, target = EncodeSettings(QmdSettings(encoder=Encoder.BOUNDED)), Target(TargetKind.MAX_MM, 4.0)
    best = meet_bounded(motion, base, target).best
    assert best.max_mm <= 4.0 == best.paper.max_error_mm
    stop.set()
    assert not meet_bounded(motion, base, target, cancel=stop).complete


def test_the_front_holds_both_profiles_and_fewer_frames():
    motion = walker(60)
    seen = list(lab_fronts(motion, QmdSettings(), (Reduction(), Reduction(2)), threading.Event()))
    points = seen[-1].points
    assert seen[-1].done == seen[-1].total
    assert {trial.settings.profile for trial in points} == set(Profile)
    assert {trial.settings.reduction.fps_divisor for trial in points} == {1, 2}
    assert all(seen[-1].points[0].bytes <= front.points[0].bytes for front in seen if front.points)


def test_a_front_that_is_stopped_ends_soon():
    stop, seen = threading.Event(), []
    for front in lab_fronts(walker(60), QmdSettings(), (Reduction(),), stop):
        seen.append(front)
        stop.set()
    assert len(seen) == 1
