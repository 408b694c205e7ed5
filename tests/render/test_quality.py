"""The quality controller, told the time by the test."""

from __future__ import annotations

from itertools import pairwise

from qmd_studio.render.quality import LADDER, QualityController


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def run(controller, clock, seconds, n_frames):
    for _ in range(n_frames):
        controller.begin()
        clock.now += seconds(controller.quality) if callable(seconds) else seconds
        controller.end()


def test_quick_hardware_rises_to_the_best_picture():
    clock = Clock()
    controller = QualityController(clock, software=False)
    run(controller, clock, 0.004, 400)
    assert controller.quality == LADDER[0]


def test_software_starts_without_multisampling_and_never_takes_it():
    clock = Clock()
    controller = QualityController(clock, software=True)
    assert controller.quality.samples == 0
    run(controller, clock, 0.001, 5_000)
    assert controller.quality.samples == 0


def test_slow_renderer_ends_on_the_quickest_rung():
    clock = Clock()
    controller = QualityController(clock, software=True)
    run(controller, clock, 0.2, 60)
    assert controller.quality == LADDER[-1]


def test_quality_settles_where_the_frame_rate_holds():
    clock = Clock()
    controller = QualityController(clock, software=True)
    run(controller, clock, lambda quality: 0.09 * quality.scale**2, 300)
    rungs = set()
    for _ in range(300):
        run(controller, clock, lambda quality: 0.09 * quality.scale**2, 1)
        rungs.add(controller.quality.scale)
    assert max(0.09 * scale**2 for scale in rungs) < 1 / 15
    assert len(rungs) <= 2


def test_one_slow_frame_costs_nothing():
    clock = Clock()
    controller = QualityController(clock, software=True)
    before = controller.quality
    for _ in range(20):
        run(controller, clock, 0.3, 1)
        run(controller, clock, 0.030, 3)
    assert controller.quality == before


def test_rung_that_failed_is_tried_again_ever_later():
    clock = Clock()
    controller = QualityController(clock, software=True)

    def seconds(quality):
        return 0.060 if quality.scale == 1.0 else 0.015

    changes = []
    for frame in range(4_000):
        before = controller.quality
        run(controller, clock, seconds, 1)
        if controller.quality.scale == 1.0 != before.scale:
            changes.append(frame)
    waits = [b - a for a, b in pairwise(changes)]
    assert all(later > earlier for earlier, later in pairwise(waits))
    assert len(changes) < 6
