"""The sample motions walk and wave as people do, loop, and are what their program makes."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from qmd_studio.assets import resource
from qmd_studio.motion.bap import column_of
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.skeleton import ColumnKind
from qmd_studio.registry import open_file

SAMPLES = ("walk", "wave")


@pytest.fixture(scope="module", params=SAMPLES)
def sample(request):
    return open_file(resource("motions", f"{request.param}.bap")).motion


@pytest.fixture(scope="module")
def walk():
    return open_file(resource("motions", "walk.bap")).motion


@pytest.fixture(scope="module")
def wave():
    return open_file(resource("motions", "wave.bap")).motion


def nodes(motion):
    """Return the path of each node (n_frames, 3) by name."""
    places = node_positions(motion.skeleton, motion.X)
    return {name: places[:, index] for index, name in enumerate(motion.skeleton.node_names)}


def test_samples_are_small_and_long_enough(sample):
    path = resource("motions", f"{sample.name}.bap")
    assert path.stat().st_size < 150_000
    assert sample.fps >= 30
    assert sample.duration_s >= 4


def test_samples_keep_the_anatomical_limits(sample):
    for index, column in enumerate(sample.skeleton.columns):
        if column.limits:
            values = sample.X[:, index]
            assert values.min() >= column.limits[0] - 1e-4, column.name
            assert values.max() <= column.limits[1] + 1e-4, column.name


def test_samples_loop_without_a_jump(sample):
    X = np.vstack([sample.X, sample.X[:1]])
    X[-1, column_of(184)] += 2 * np.pi * np.round((X[-2, column_of(184)] - X[-1, column_of(184)]) / (2 * np.pi))
    steps = np.abs(np.diff(X, axis=0))
    usual = steps[:-1].max(axis=0)
    assert (steps[-1] <= usual * 1.05 + 2e-5).all()


def test_samples_move_smoothly(sample):
    angles = [i for i, c in enumerate(sample.skeleton.columns) if c.kind is ColumnKind.ROTATION]
    assert np.degrees(np.abs(np.diff(sample.X[:, angles], axis=0))).max() < 18  # degrees from one frame to the next


def test_nothing_passes_through_the_ground(sample):
    lowest = min(path[:, 1].min() for path in nodes(sample).values())
    assert lowest > -0.003


def test_a_foot_on_the_ground_does_not_slide(walk):
    paths = nodes(walk)
    for side in "lr":
        planted = 0
        for name in (f"{side}_subtalar", f"{side}_metatarsal"):
            speed = np.linalg.norm(np.diff(paths[name][:, [0, 2]], axis=0), axis=1) * walk.fps
            down = (paths[name][:-1, 1] < 0.001) & (paths[name][1:, 1] < 0.001)
            assert speed[down].max() < 0.02, name
            planted += down.sum()
        assert planted > walk.n_frames * 0.6


def test_one_foot_at_least_is_always_on_the_ground(walk):
    paths = nodes(walk)
    lowest = np.min(
        [paths[f"{s}_{n}"][:, 1] for s in "lr" for n in ("subtalar", "metatarsal", "calcaneous_post")], axis=0
    )
    assert lowest.max() < 0.03


def test_knees_bend_in_the_swing_and_never_the_other_way(walk):
    paths = nodes(walk)
    for side in "lr":
        thigh = paths[f"{side}_knee"] - paths[f"{side}_hip"]
        shin = paths[f"{side}_ankle"] - paths[f"{side}_knee"]
        bend = np.degrees(
            np.arccos((thigh * shin).sum(1) / np.linalg.norm(thigh, axis=1) / np.linalg.norm(shin, axis=1))
        )
        heading = walk.X[:, column_of(184)]
        forward = np.stack([np.sin(heading), np.zeros_like(heading), np.cos(heading)], axis=1)
        assert (((thigh / 2 - shin / 2) * forward).sum(1) > 0).all()
        assert 50 < bend.max() < 70
        assert bend.min() < 15


def test_the_pelvis_rises_and_falls_twice_a_stride_by_a_few_centimetres(walk):
    height = nodes(walk)["sacroiliac"][:, 1]
    assert 0.02 < np.ptp(height) < 0.06
    spectrum = np.abs(np.fft.rfft(height - height.mean()))
    assert np.argmax(spectrum) == 14  # seven strides


def test_arms_swing_against_the_legs(walk):
    for arm, leg in ((32, 4), (33, 5)):
        swing, step = walk.X[:, column_of(arm)], walk.X[:, column_of(leg)]
        assert np.corrcoef(swing, step)[0, 1] < -0.6
        assert 25 < np.degrees(np.ptp(swing)) < 60


def test_the_walk_goes_forward_at_a_walking_pace(walk):
    root = nodes(walk)["HumanoidRoot"][:, [0, 2]]
    heading = walk.X[:-1, column_of(184)]
    velocity = np.diff(root, axis=0) * walk.fps
    forward = velocity[:, 0] * np.sin(heading) + velocity[:, 1] * np.cos(heading)
    assert 0.9 < forward.min() < forward.max() < 1.6


def test_the_wave_raises_the_right_hand_only_and_opens_it(wave):
    paths = nodes(wave)
    high = paths["r_middle_distal_tip"][:, 1] > 1.7
    assert 1.5 < high.sum() / wave.fps < 3.5
    assert not high[0]
    assert not high[-1]
    assert paths["l_middle_distal_tip"][:, 1].max() < 0.8
    greets = paths["r_middle_distal_tip"][high, 0]
    assert np.sum(np.diff(np.sign(greets - greets.mean())) != 0) >= 6
    width = np.linalg.norm(paths["r_index_distal_tip"] - paths["r_pinky_distal_tip"], axis=1)
    assert width[high].max() > width[0] + 0.02


def test_the_open_palm_looks_forward(wave):
    paths = nodes(wave)
    frame = int(np.argmax(paths["r_middle_distal_tip"][:, 1]))
    along = paths["r_middle1"][frame] - paths["r_wrist"][frame]
    across = paths["r_index1"][frame] - paths["r_pinky1"][frame]
    palm = np.cross(across, along)  # of a right hand
    assert palm[2] / np.linalg.norm(palm) > 0.8


def test_feet_stand_still_through_the_wave(wave):
    paths = nodes(wave)
    for side in "lr":
        for name in ("subtalar", "metatarsal"):
            assert np.ptp(paths[f"{side}_{name}"], axis=0).max() < 0.0005


def test_samples_are_what_their_program_makes(tmp_path):
    root = Path(__file__).parents[2]
    program = root / "resources" / "motions" / "make_samples.py"
    if not program.is_file():
        pytest.skip("the program that makes the samples is in the source tree only")
    subprocess.run(
        [sys.executable, "-B", str(program), str(tmp_path)], check=True, env={"PYTHONPATH": str(root)}, timeout=120
    )
    for name in SAMPLES:
        made, shipped = open_file(tmp_path / f"{name}.bap").motion, open_file(resource("motions", f"{name}.bap")).motion
        np.testing.assert_allclose(made.X, shipped.X, atol=2.1e-5)  # a unit or two of the file's rounding
