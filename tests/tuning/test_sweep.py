"""Figures 5 and 6 for one motion, and the grid that the lab looks through."""

import threading
from dataclasses import replace

import pytest

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.session import TuningSession
from qmd_studio.tuning.sweep import FIGURE_BITS, coarse_first, def_lines, drawn_def, size_lines, sweep
from qmd_studio.tuning.trade_off import lab_fronts, lab_grid
from tests.generated_motion import walker


@pytest.fixture(scope="module")
def motion():
    return walker(80)


@pytest.mark.parametrize("n_columns", [1, 2, 6, 62, 186])
def test_the_coarse_shape_comes_first_and_every_fdf_once(n_columns):
    order = coarse_first(n_columns)
    assert sorted(order) == list(range(n_columns))
    head = sorted(order[: n_columns // 16 + 2])
    assert (head[0], head[-1]) == (0, n_columns - 1)


def test_a_motion_without_columns_has_no_order_to_fail_on():
    assert coarse_first(0) == [0]


def test_sizes_are_those_of_the_session(motion):
    session = TuningSession(motion)
    lines = size_lines(motion, 30)
    for fdf in (0, 6, 62):
        for bits in FIGURE_BITS:
            assert lines[bits][fdf] * 1024 == session.size(QmdSettings(fdf, bits, 30)).bytes


def test_the_lines_are_what_an_encoding_measures(motion):
    base = QmdSettings(encoder=Encoder.PAPER)
    trials = [trial for latest in sweep(evaluator_for(motion, base), 0) for trial in latest]
    lines = def_lines(trials)
    assert all([x for x, _ in line] == list(range(62)) for line in lines.values())
    error = TuningSession(motion).evaluate(replace(base, fdf=12, bits=9)).error
    assert lines[9][12][1] == pytest.approx(drawn_def(error.def_), rel=1e-3)


def test_a_sweep_that_is_stopped_leaves_no_thread(motion):
    stop = threading.Event()
    seen = []
    for latest in sweep(evaluator_for(motion, QmdSettings(encoder=Encoder.PAPER)), 0, cancel=stop):
        seen.append(latest)
        stop.set()
    assert len(seen) <= 2
    assert not any(thread.name.startswith("qmd-tuning") for thread in threading.enumerate())


def test_the_front_takes_the_best_of_all_encoders_within_the_raw_size(motion):
    *_, front = lab_fronts(motion, QmdSettings(), (Reduction(),), threading.Event())
    assert front.done == front.total
    sizes = [trial.bytes for trial in front.points]
    errors = [trial.def_ for trial in front.points]
    assert sizes == sorted(sizes)
    assert errors == sorted(errors, reverse=True)
    assert sizes[-1] <= 4 * motion.X.size
    assert front.knee in front.points


def test_a_slow_encoder_is_tried_less(motion):
    grids = [lab_grid(evaluator_for(motion, QmdSettings(encoder=e))) for e in (Encoder.PAPER, Encoder.CLOSED)]
    n_settings = [sum(len(column.bits) for column in grid.columns(motion)) for grid in grids]
    assert n_settings[1] < n_settings[0] / 4
