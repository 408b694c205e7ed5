"""The searches: the paper's own optimum, the same with a twentieth of the work, stopped, and gone on with."""

import threading
from pathlib import Path

import numpy as np
import psutil
import pytest

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.motion.channels import channel_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from qmd_studio.tuning.encoders import FAST_ENCODERS, PLAIN_CLOSED
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import Grid, paper_grid, raw_bytes, wide_grid
from qmd_studio.tuning.lattice import Lattice
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.search import AT_LEAST, SHARE, budget_for, search
from tests.corpus import corpus_file, corpus_files
from tests.generated_motion import walker

SMALL = Grid((0, 6, 12), (8, 9), (30, 60, 0))
SHORT_CLIPS = ("02_01", "02_02", "35_01")


def evaluator_of(motion, encoder=PLAIN_CLOSED):
    return evaluator_for(motion, QmdSettings(encoder=encoder))


def tuning_threads():
    return [thread for thread in threading.enumerate() if thread.name.startswith("qmd-tuning")]


class StopAfter:
    """Is set once it has been asked so many times."""

    def __init__(self, times):
        self.left = times

    def is_set(self):
        self.left -= 1
        return self.left < 0


@pytest.mark.corpus
def test_dance_on_the_papers_grid_gives_its_row_of_table_2():
    motion = open_file(corpus_file("cmu_asfamc/05_03.amc")).motion
    best = exhaustive(evaluator_of(motion, Encoder.PAPER), paper_grid(motion)).best
    assert (best.paper.fdf, best.paper.bits, best.paper.segment) == (1, 8, 150)
    assert best.bytes / 1024 == pytest.approx(30.8, abs=0.1)
    assert best.def_ == pytest.approx(21.2, rel=0.03)


@pytest.mark.corpus
@pytest.mark.parametrize("encoder", FAST_ENCODERS)
@pytest.mark.parametrize("take", SHORT_CLIPS)
def test_the_search_comes_within_a_per_cent_at_a_twentieth_of_the_work(take, encoder):
    motion = open_file(corpus_file(f"cmu_asfamc/{take}.amc")).motion
    evaluator, grid = evaluator_of(motion, encoder), wide_grid(motion)
    everything = exhaustive(evaluator, grid)
    found = search(evaluator, grid)
    assert found.evaluations <= max(AT_LEAST, SHARE * len(everything.trials))
    assert found.best.merit <= 1.01 * everything.best.merit


def test_the_search_finds_the_best_of_a_generated_walk():
    motion = walker(200)
    for encoder in FAST_ENCODERS:
        evaluator, grid = evaluator_of(motion, encoder), wide_grid(motion)
        assert search(evaluator, grid).best.merit <= 1.01 * exhaustive(evaluator, grid).best.merit


def test_the_exhaustive_search_tries_every_setting_once_and_tells_how_far_it_is():
    motion, told = walker(100), []
    outcome = exhaustive(evaluator_of(motion), SMALL, on_progress=told.append)
    settings = [(t.paper.fdf, t.paper.bits, t.paper.segment) for t in outcome.trials]
    assert sorted(settings) == sorted((f, b, s) for f in SMALL.fdf for b in SMALL.bits for s in SMALL.segments)
    assert outcome.best.merit == min(trial.merit for trial in outcome.trials)
    assert [p.done for p in told] == sorted(p.done for p in told)
    assert (told[0].done, told[-1].done, told[-1].total) == (0, 18, 18)
    assert told[-1].best == outcome.best
    assert outcome.complete


def test_no_file_of_a_bounded_grid_is_larger_than_the_raw_motion():
    motion = walker(100)
    for grid in (paper_grid(motion), wide_grid(motion)):
        trials = exhaustive(evaluator_of(motion), grid).trials
        assert trials
        assert max(trial.bytes for trial in trials) <= raw_bytes(motion)
        assert max(t.bytes for t in exhaustive(evaluator_of(motion), grid.unbounded()).trials) > raw_bytes(motion)


def test_the_wide_grid_of_the_papers_walk_has_6696_settings():
    motion = walker(343)
    assert sum(len(column.bits) for column in wide_grid(motion).unbounded().columns(motion)) == 6696
    assert sum(len(column.bits) for column in wide_grid(motion).columns(motion)) == 2330
    assert sum(len(column.bits) for column in paper_grid(motion).unbounded().columns(motion)) == 198


@pytest.mark.parametrize("find", [exhaustive, search])
@pytest.mark.parametrize("times", [0, 3, 20])
def test_a_search_that_is_stopped_leaves_nothing_running_and_keeps_what_it_has(find, times):
    motion = walker(200)
    outcome = find(evaluator_of(motion), wide_grid(motion), cancel=StopAfter(times))
    assert not tuning_threads()
    assert not outcome.complete
    assert outcome.evaluations == len(outcome.trials) < 1000
    assert (outcome.best is None) == (not outcome.trials)


def test_a_search_that_fails_leaves_nothing_running():
    def stumble(progress):
        raise RuntimeError("the window is gone")

    with pytest.raises(RuntimeError):
        exhaustive(evaluator_of(walker(100)), SMALL, on_progress=stumble)
    assert not tuning_threads()


@pytest.mark.parametrize("find", [exhaustive, search])
def test_a_stopped_search_goes_on_where_it_was(tmp_path, find):
    motion, state = walker(200), tmp_path / "walk.json"
    evaluator, grid = evaluator_of(motion), wide_grid(motion)
    first = find(evaluator, grid, memory=Memory(evaluator, state), cancel=StopAfter(12))
    second = find(evaluator, grid, memory=Memory(evaluator, state))
    whole = find(evaluator, grid)
    assert 0 < first.evaluations < whole.evaluations
    assert first.evaluations + second.evaluations == whole.evaluations
    assert second.best == whole.best
    third = find(evaluator, grid, memory=Memory(evaluator, state))
    assert (third.evaluations, third.best, third.complete) == (0, whole.best, True)


def test_a_saved_search_of_something_else_is_refused(tmp_path):
    state = tmp_path / "walk.json"
    one, other = evaluator_of(walker(60)), evaluator_of(walker(60, seed=2))
    exhaustive(one, SMALL, memory=Memory(one, state))
    with pytest.raises(FormatError, match="another motion"):
        Memory(other, state)
    with pytest.raises(FormatError, match="another encoder"):
        Memory(evaluator_of(walker(60), Encoder.PAPER), state)


@pytest.mark.parametrize("text", ["", "{", "[]", '{"version": 1}', "null"])
def test_a_damaged_saved_search_is_refused(tmp_path, text):
    state = tmp_path / "walk.json"
    state.write_text(text)
    with pytest.raises(FormatError, match="cannot be read"):
        Memory(evaluator_of(walker(60)), state)


def test_a_row_that_no_search_writes_is_refused(tmp_path):
    evaluator, state = evaluator_of(walker(60)), tmp_path / "walk.json"
    exhaustive(evaluator, SMALL, memory=Memory(evaluator, state))
    good = state.read_text()
    for bad in (good.replace("[[", '[["a", ', 1), good.replace("[[0", "[[-1", 1), good[:-2]):
        state.write_text(bad)
        with pytest.raises(FormatError):
            Memory(evaluator, state)


@pytest.mark.parametrize(
    "grid", [Grid((0,), (7,), (0,)), Grid((-1,), (8,), (0,)), Grid((0,), (8,), (-30,)), Grid((), (8,), (0,))]
)
def test_bounds_that_no_file_can_have_are_refused(grid):
    with pytest.raises(CodecError, match="out of range"):
        exhaustive(evaluator_of(walker(40)), grid)


@pytest.mark.parametrize("n_frames", [1, 2, 29, 31])
def test_motions_shorter_than_a_segment_can_be_searched(n_frames):
    motion = walker(n_frames)
    for find in (exhaustive, search):
        for grid in (paper_grid(motion).unbounded(), wide_grid(motion).unbounded()):
            assert find(evaluator_of(motion), grid).best is not None


@pytest.mark.parametrize("path", corpus_files("bvh/bvhtoolbox_walk01.bvh"))
def test_other_skeletons_are_searched_the_same_way(path: Path):
    motion = open_file(path).motion
    evaluator, grid = evaluator_of(motion), wide_grid(motion)
    assert search(evaluator, grid).best.merit <= 1.01 * exhaustive(evaluator, grid).best.merit


def long_motion(n_frames):
    """A motion of one column that hardly moves: what is asked is how many settings are looked at, not how they fare."""
    skeleton = channel_skeleton([("hips", -1, (0.0, 1.0, 0.0), ["Xrotation"])], [])
    return Motion(skeleton, np.linspace(0.0, 1.0, n_frames)[:, np.newaxis], 120.0)


def test_the_wide_grid_of_a_million_frames_has_fewer_segments_and_all_its_fdf_and_b():
    motion = long_motion(1_000_000)
    grid = wide_grid(motion)
    assert len(grid.segments) <= 1001
    assert (grid.segments[-1], set(np.diff(grid.segments[:-1]))) == (0, {1020})
    assert wide_grid(long_motion(30_000)).segments == (*range(30, 29_999, 30), 0)
    assert sum(len(column.bits) for column in grid.columns(motion)) > 1000


def test_a_grid_that_would_fill_the_memory_is_refused():
    grid = Grid(tuple(range(62)), tuple(range(8, 17)), tuple(range(1, 10_001)))
    with pytest.raises(CodecError, match="too many settings") as caught:
        search(evaluator_of(walker(100)), grid)
    assert caught.value.got == "5,580,000"


def test_a_search_spends_less_where_a_setting_takes_long(monkeypatch):
    motion = walker(3000)
    grid = wide_grid(motion).unbounded()
    monkeypatch.setattr("qmd_studio.tuning.search.MOST_VALUES", 200 * motion.X.size)
    lattice, evaluator = Lattice(grid, evaluator_of(motion)), evaluator_of(motion)
    assert budget_for(lattice, evaluator) == 200 < SHARE * len(lattice.points)
    assert budget_for(lattice, evaluator_for(motion, QmdSettings(encoder=Encoder.CLOSED))) == AT_LEAST


def test_a_motion_beyond_the_memory_is_refused_with_both_sizes(monkeypatch):
    few = psutil.virtual_memory()._replace(available=1 << 20)
    monkeypatch.setattr(psutil, "virtual_memory", lambda: few)
    assert evaluator_of(walker(100)).is_fast
    with pytest.raises(CodecError, match="not enough memory") as caught:
        evaluator_of(walker(20_000))
    assert ("GB" in caught.value.wanted, caught.value.got) == (True, "0.0 GB free")


def test_progress_is_told_after_every_trial():
    motion, told = walker(100), []
    found = search(evaluator_of(motion), SMALL, on_progress=told.append)
    assert [progress.done for progress in told] == list(range(1, found.evaluations + 1))
