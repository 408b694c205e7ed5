"""The Pareto front: nothing beats a point of it, everything else is beaten, and it fills in while it runs."""

import itertools
import threading

from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.encoders import FAST_ENCODERS
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import wide_grid
from qmd_studio.tuning.pareto import Front, fronts
from qmd_studio.tuning.trial import Trial
from tests.generated_motion import walker

TRIALS = st.lists(st.builds(Trial, st.just(EncodeSettings()), st.integers(1, 40), *[st.integers(0, 30).map(float)] * 3))


@given(TRIALS, TRIALS)
def test_every_trial_is_on_the_front_or_beaten_by_it(some, more):
    front = Front().with_trials(some).with_trials(more)
    assert all(a.bytes < b.bytes and a.def_ > b.def_ for a, b in itertools.pairwise(front.points))
    for trial in some + more:
        assert any(p.bytes <= trial.bytes and p.def_ <= trial.def_ for p in front.points)
    assert set(front.points) <= set(some + more)
    assert front.done == len(some) + len(more)
    assert (front.knee in front.points) if front.points else front.knee is None


def test_the_knee_is_where_the_front_bends():
    points = [(100, 1000.0), (110, 10.0), (200, 8.0), (1000, 6.0), (10_000, 5.0)]
    front = Front().with_trials([Trial(EncodeSettings(), size, def_, 0, 0) for size, def_ in points])
    assert (front.knee.bytes, front.knee.def_) == (110, 10.0)


def test_the_knee_is_not_where_the_body_falls_apart():
    points = [(10, 30.0, 90.0), (20, 2.0, 20.0), (1000, 0.5, 4.0), (2000, 0.01, 0.1), (9000, 0.005, 0.05)]
    front = Front().with_trials([Trial(EncodeSettings(), size, def_, mean, 0) for size, def_, mean in points])
    assert front.knee.bytes == 2000
    hopeless = Front().with_trials([Trial(EncodeSettings(), 10, 30.0, 90.0, 0)])
    assert hopeless.knee.bytes == 10


def test_it_fills_in_while_it_runs_and_ends_whole():
    motion = walker(100)
    runs = [(evaluator_for(motion, QmdSettings(encoder=e)), wide_grid(motion)) for e in FAST_ENCODERS]
    seen = list(fronts(runs))
    assert [front.done for front in seen] == sorted(front.done for front in seen)
    assert seen[0].done < seen[-1].done == seen[-1].total
    trials = [trial for run in runs for trial in exhaustive(*run).trials]
    assert seen[-1].points == Front().with_trials(trials).points


def test_one_that_is_stopped_or_dropped_leaves_nothing_running():
    motion, stop = walker(100), threading.Event()
    runs = [(evaluator_for(motion, QmdSettings(encoder=e)), wide_grid(motion)) for e in FAST_ENCODERS]
    seen = []
    for front in fronts(runs, cancel=stop):
        seen.append(front)
        stop.set()
    assert 0 < seen[-1].done < seen[-1].total
    running = fronts(runs)
    next(running)
    running.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("qmd-tuning")]
