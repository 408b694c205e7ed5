"""The measures say what their definitions say, and refuse motions that cannot be compared."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.errors import FormatError
from qmd_studio.motion.as_euler import as_euler
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from tests.generated_motion import walker

UNIT = 0.0254 / 0.45
STICK = Skeleton(
    name="stick",
    kind=SkeletonKind.BVH,
    joints=(Joint("hip", -1, (0.0, 0.0, 0.0), product=(3,)), Joint("knee", 0, (0.0, -0.5, 0.0), product=(4,))),
    end_sites=(EndSite("sole", 1, (0.0, -0.4, 0.0)),),
    columns=(
        *(Column(f"hip t{a}", 0, ColumnKind.TRANSLATION, i) for i, a in enumerate("xyz")),
        Column("hip rz", 0, ColumnKind.ROTATION, 2),
        Column("knee rz", 1, ColumnKind.ROTATION, 2),
    ),
    points=(0, 1, 2),
)


def stick(X, fps=100.0) -> Motion:
    return Motion(STICK, np.asarray(X, dtype=float), fps)


def test_a_motion_is_at_no_distance_from_itself():
    error = measure(stick(np.ones((4, 5))), stick(np.ones((4, 5))))
    assert error.as_json() == {
        "def": 0, "mean_mm": 0, "p99_mm": 0, "max_mm": 0, "worst_joint": "hip", "worst_frame": 0,
        "velocity_mm_s": 0, "acceleration_mm_s2": 0,
    }  # fmt: skip


def test_steady_shift_shows_in_def_and_distance_but_not_in_speed():
    moved = np.zeros((5, 5))
    moved[:, 0] = 0.01
    error = measure(stick(np.zeros((5, 5))), stick(moved))
    assert error.def_ == pytest.approx(np.sqrt(3) * 0.01 / UNIT)  # three points, stacked
    assert error.mean_mm == pytest.approx(10)
    assert error.velocity_mm_s == pytest.approx(0, abs=1e-9)
    aligned = measure(stick(np.zeros((5, 5))), stick(moved), align="first")
    assert aligned.max_mm == pytest.approx(0, abs=1e-9)


def test_jitter_shows_in_speed_and_its_change():
    shaken = np.zeros((4, 5))
    shaken[1::2, 0] = 0.001  # one millimetre there and back at 100 frames a second
    error = measure(stick(np.zeros((4, 5))), stick(shaken))
    assert error.velocity_mm_s == pytest.approx(100)
    assert error.acceleration_mm_s2 == pytest.approx(20_000)


def test_worst_place_is_named():
    bent = np.zeros((6, 5))
    bent[4, 4] = np.pi
    error = measure(stick(np.zeros((6, 5))), stick(bent))
    assert (error.worst_joint, error.worst_frame) == ("sole", 4)
    assert error.max_mm == pytest.approx(800)
    assert error.distance_mm.shape == (6, 3)
    assert error.distance_mm[4, 2] == error.max_mm


def test_p99_is_reached_by_one_distance_in_a_hundred():
    moved = np.zeros((100, 5))
    moved[:, 0] = np.arange(100) / 1000
    error = measure(stick(np.zeros((100, 5))), stick(moved))
    assert error.p99_mm == pytest.approx(98)


def test_single_frame_has_no_speed():
    error = measure(stick(np.zeros((1, 5))), stick(np.ones((1, 5))))
    assert error.velocity_mm_s == error.acceleration_mm_s2 == 0
    json.dumps(error.as_json())


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), n_frames=st.integers(1, 12))
def test_measures_agree_with_their_definitions_spelt_out(seed, n_frames):
    random = np.random.default_rng(seed)
    first, second = (stick(random.normal(size=(n_frames, 5)), fps=30.0) for _ in range(2))
    ours, theirs = (point_positions(STICK, motion.X) for motion in (first, second))
    error = measure(first, second)
    norms = [
        sum(float(x - y) ** 2 for x, y in zip(a.ravel(), b.ravel(), strict=True)) ** 0.5
        for a, b in zip(ours, theirs, strict=True)
    ]
    assert error.def_ == pytest.approx(sum(norms) / n_frames / UNIT)
    speeds = [
        np.linalg.norm((theirs[t + 1, p] - theirs[t, p]) - (ours[t + 1, p] - ours[t, p])) * 30.0 * 1000
        for t in range(n_frames - 1)
        for p in range(3)
    ]
    assert error.velocity_mm_s == pytest.approx(np.mean(speeds) if speeds else 0)


def test_motions_of_other_length_or_skeleton_are_refused():
    motion = stick(np.zeros((3, 5)))
    with pytest.raises(FormatError, match="length"):
        measure(motion, stick(np.zeros((4, 5))))
    renamed = replace(STICK, joints=(STICK.joints[0], replace(STICK.joints[1], name="elbow")))
    with pytest.raises(FormatError, match=r"different skeletons.*knee"):
        measure(motion, replace(motion, skeleton=renamed))
    longer = replace(STICK, end_sites=(EndSite("sole", 1, (0.0, -0.5, 0.0)),))
    with pytest.raises(FormatError, match=r"sole.*100 mm"):
        measure(motion, replace(motion, skeleton=longer))


def test_a_copy_with_other_points_is_measured_at_those_of_the_original():
    motion = stick(np.zeros((3, 5)))
    fewer = replace(motion, skeleton=replace(STICK, points=(0, 2)))
    assert measure(motion, fewer).distance_mm.shape == (3, 3)
    assert measure(fewer, motion).distance_mm.shape == (3, 2)


def test_a_motion_and_its_copy_in_channels_of_another_order_are_in_the_same_places():
    original = walker(40)
    copy = as_euler(original)
    assert copy.skeleton.node_names != original.skeleton.node_names or copy.skeleton.kind != original.skeleton.kind
    error = measure(original, copy)
    assert error.distance_mm.shape == (40, len(original.skeleton.points))
    assert error.max_mm < 1e-6
