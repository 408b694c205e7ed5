"""Targets: what is asked for is kept wherever it can be, and said plainly where it cannot."""

import math

import pytest

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.registry import open_file
from qmd_studio.tuning.encoders import PLAIN_CLOSED
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import wide_grid
from qmd_studio.tuning.targets import Target, TargetKind, meet
from tests.corpus import corpus_file
from tests.generated_motion import walker

TARGETS = [
    ("bytes", 12_000),
    ("kbps", 90),
    ("def", 0.1),
    ("mean-mm", 0.3),
    ("max-mm", 4),
    ("bytes", 100),
    ("max-mm", 1e-7),
]


def best_by_hand(trials, target, motion):
    """The definition, spelled out: the answer that a thorough search has to give."""
    error = {"mean-mm": lambda t: t.mean_mm, "max-mm": lambda t: t.max_mm}.get(target.kind, lambda t: t.def_)
    limit = {"bytes": target.value, "kbps": target.value * 125 * motion.duration_s}.get(target.kind)
    if limit is not None:
        within = [t for t in trials if t.bytes <= limit]
        return min(within, key=lambda t: (t.def_, t.bytes)) if within else min(trials, key=lambda t: (t.bytes, t.def_))
    within = [t for t in trials if error(t) <= target.value]
    return min(within, key=lambda t: (t.bytes, error(t))) if within else min(trials, key=lambda t: (error(t), t.bytes))


@pytest.mark.parametrize("encoder", [Encoder.PAPER, PLAIN_CLOSED])
@pytest.mark.parametrize(("kind", "value"), TARGETS)
def test_a_thorough_answer_is_the_best_there_is(encoder, kind, value):
    motion, target = walker(120), Target(TargetKind(kind), value)
    evaluator = evaluator_for(motion, QmdSettings(encoder=encoder))
    trials = exhaustive(evaluator, wide_grid(motion)).trials
    assert meet(evaluator, wide_grid(motion), target).best == best_by_hand(trials, target, motion)


@pytest.mark.parametrize("encoder", [Encoder.PAPER, PLAIN_CLOSED])
@pytest.mark.parametrize(("kind", "value"), TARGETS)
def test_a_quick_answer_is_met_where_a_thorough_one_is_and_comes_near_it(encoder, kind, value):
    motion, target = walker(120), Target(TargetKind(kind), value)
    evaluator, grid = evaluator_for(motion, QmdSettings(encoder=encoder)), wide_grid(motion)
    thorough, quick = (meet(evaluator, grid, target, thorough=how) for how in (True, False))
    assert quick.evaluations < len(thorough.trials)
    assert target.met_by(quick.best, motion) == target.met_by(thorough.best, motion)
    if target.met_by(quick.best, motion) and not target.bounds_size:
        assert quick.best.bytes <= 1.1 * thorough.best.bytes


def test_a_target_out_of_reach_gives_the_nearest():
    motion = walker(120)
    evaluator, grid = evaluator_for(motion, QmdSettings(encoder=PLAIN_CLOSED)), wide_grid(motion)
    too_small = Target(TargetKind.BYTES, 100)
    best = meet(evaluator, grid, too_small).best
    assert not too_small.met_by(best, motion)
    assert best.bytes == min(evaluator.size(c.fdf, b, c.segment) for c in grid.columns(motion) for b in c.bits)
    too_close = Target(TargetKind.MAX_MM, 1e-9)
    best = meet(evaluator, grid, too_close).best
    assert not too_close.met_by(best, motion)
    assert best.max_mm < 0.5


@pytest.mark.corpus
def test_a_worst_distance_on_real_motion_is_kept():
    motion = open_file(corpus_file("cmu_asfamc/backflip.amc")).motion
    target = Target(TargetKind.MAX_MM, 5)
    evaluator = evaluator_for(motion, QmdSettings(encoder=PLAIN_CLOSED))
    best = meet(evaluator, wide_grid(motion), target).best
    assert best.max_mm <= 5


@pytest.mark.parametrize("value", [0, -1, math.inf, math.nan])
def test_a_target_that_is_no_positive_number_is_refused(value):
    with pytest.raises(CodecError, match="out of range"):
        Target(TargetKind.DEF, value)


@pytest.mark.parametrize("encoder", [Encoder.PAPER, Encoder.CLOSED])
@pytest.mark.parametrize("thorough", [None, False])
def test_a_motion_for_which_the_grid_holds_nothing_has_no_best(encoder, thorough):
    motion = walker(1)
    evaluator = evaluator_for(motion, QmdSettings(encoder=encoder))
    assert meet(evaluator, wide_grid(motion), Target(TargetKind.BYTES, 100), thorough=thorough).best is None
