"""What is read from BVH and written again is equal, and the second writing is the same bytes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from qmd_studio.errors import FormatError
from qmd_studio.formats import bvh
from qmd_studio.formats.frame_rate import frame_time_text, rate_from_frame_time
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.channels import channel_skeleton
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import EndSite
from qmd_studio.registry import open_file
from tests.corpus import corpus_files


def reread(motion):
    return bvh.read(bvh.FORMAT.write(motion), ReadOptions())


def assert_same_again(motion):
    """Write and read twice: equal values, equal skeleton to rounding, equal bytes."""
    first = bvh.FORMAT.write(motion)
    loaded = bvh.read(first, ReadOptions(metres_per_unit=motion.skeleton.metres_per_unit))
    assert not loaded.warnings
    again = loaded.motion
    np.testing.assert_allclose(again.X, motion.X, rtol=1e-11, atol=1e-9)
    assert again.skeleton.columns == motion.skeleton.columns
    assert again.skeleton.node_names == motion.skeleton.node_names
    rest, was = (node_positions(m.skeleton, m.X[:1]) for m in (again, motion))
    np.testing.assert_allclose(rest, was, atol=1e-9 + 1e-11 * np.abs(was).max())  # what cancels has that rounding
    assert again.fps == pytest.approx(motion.fps, rel=1e-15)
    assert bvh.FORMAT.write(again) == first


@pytest.mark.parametrize("path", corpus_files("bvh/*.bvh"))
def test_real_files_are_the_same_again(path):
    loaded = open_file(path)
    assert not loaded.warnings
    assert_same_again(loaded.motion)
    assert bvh.read(bvh.FORMAT.write(loaded.motion), ReadOptions()).skeleton.metres_per_unit == pytest.approx(
        loaded.skeleton.metres_per_unit
    )


name = st.text(st.characters(codec="utf-8", categories=("L", "N", "P")), min_size=1, max_size=8).filter(
    lambda text: not set(text) & set("{}")
)
length = st.integers(-(10**8), 10**8).map(lambda n: n / 1e4)
rotations = st.lists(st.sampled_from(["Xrotation", "Yrotation", "Zrotation"]), max_size=3)
positions = st.sampled_from([(), ("Xposition",), ("Zposition", "Xposition", "Yposition")])


@st.composite
def motions(draw):
    """Any motion that BVH holds: several roots, names twice, joints with and without channels, values of all sizes."""
    joints = []
    for index in range(draw(st.integers(1, 5))):
        parent = draw(st.sampled_from([-1, index - 1])) if index else -1
        offset = draw(st.tuples(length, length, length))
        channels = draw(st.permutations([*draw(positions), *draw(rotations)])) if index else ["Yposition", "Zrotation"]
        joints.append((draw(name), parent, offset, channels))
    site_joints = draw(st.lists(st.integers(0, len(joints) - 1), max_size=3))
    sites = [EndSite(draw(name), joint, draw(st.tuples(length, length, length))) for joint in site_joints]
    skeleton = channel_skeleton(joints, sites).scaled(draw(st.sampled_from([1.0, 0.01, 0.0254])))
    seed, scale = draw(st.integers(0, 99)), draw(st.sampled_from([1e-6, 1.0, 300.0]))
    X = np.random.default_rng(seed).normal(size=(draw(st.integers(1, 4)), skeleton.n_columns)) * scale
    return Motion(skeleton, X, draw(st.floats(0.01, 5000)))


@settings(max_examples=150, deadline=None)
@given(motions())
def test_any_motion_in_channels_is_the_same_again(motion):
    assert_same_again(reread_in_own_unit(motion))


def reread_in_own_unit(motion):
    """Values as text can hold them: the first reading is where rounding to the written digits happens."""
    data = bvh.FORMAT.write(motion)
    return bvh.read(data, ReadOptions(metres_per_unit=motion.skeleton.metres_per_unit)).motion


def test_a_bap_motion_is_written_with_every_node_in_its_place():
    skeleton = bap_skeleton()
    X = np.random.default_rng(3).uniform(-0.5, 0.5, (5, skeleton.n_columns))
    written = reread(Motion(skeleton, X, 25.0)).motion
    order = [written.skeleton.node_names.index(node) for node in skeleton.node_names]
    moved = node_positions(written.skeleton, written.X)[:, order]
    np.testing.assert_allclose(moved, node_positions(skeleton, X), atol=1e-6)
    assert written.fps == 25.0


@pytest.mark.parametrize("bad", ["", " a", "a{", "a\nb"])
def test_a_name_that_bvh_cannot_hold_is_refused(bad):
    skeleton = channel_skeleton([(bad, -1, (0.0, 1.0, 0.0), ["Xrotation"])], [])
    with pytest.raises(FormatError, match="cannot hold this name"):
        bvh.FORMAT.write(Motion(skeleton, np.zeros((1, 1)), 30.0))


vast = st.sampled_from([0.0, 1e-9, 0.3, 1.7, 100.0, 1e6, 1e11, 9.99e11, 1e12, -1e12])


@st.composite
def vast_motions(draw):
    """Motions up to the bound of what a motion may hold, in any unit that a file may have."""
    joints = []
    for index in range(draw(st.integers(1, 3))):
        offset = draw(st.tuples(vast, vast, vast) | st.just((0.0, 0.1, 0.0)))
        joints.append((f"j{index}", index - 1, offset, ["Yposition", *draw(rotations)]))
    skeleton = replace(channel_skeleton(joints, []), metres_per_unit=draw(st.sampled_from([1e-6, 0.01, 0.3, 1.0, 1e6])))
    X = draw(arrays(np.float64, (2, skeleton.n_columns), elements=vast | st.floats(-3, 3)))
    return Motion(skeleton, X, 30.0)


@settings(max_examples=300, deadline=None)
@given(vast_motions())
def test_what_is_written_near_the_bound_opens_again_or_is_refused_at_once(motion):
    largest = max(np.abs(motion.X).max(), *(abs(v) for joint in motion.skeleton.joints for v in joint.offset))
    refusal = ""
    try:
        data = bvh.FORMAT.write(motion)
    except FormatError as problem:
        refusal = problem.message
    if refusal:
        assert largest > 1e5
        assert "would not open again" in refusal
    else:
        assert bvh.read(data, ReadOptions()).motion.n_frames == 2


def test_a_small_figure_that_strays_far_is_refused_with_the_unit_as_the_reason():
    joints = [("hips", -1, (0.0, 0.1, 0.0), ["Xposition"]), ("head", 0, (0.0, 0.1, 0.0), [])]
    skeleton = replace(channel_skeleton(joints, []), metres_per_unit=0.01)  # 20 units tall: decimetres, says the reader
    bvh.FORMAT.write(Motion(skeleton, np.array([[1e10]]), 30.0))
    with pytest.raises(FormatError, match="would not open again") as caught:
        bvh.FORMAT.write(Motion(skeleton, np.array([[5e11]]), 30.0))
    assert "length unit" in caught.value.hint
    assert "hips" in caught.value.at


def test_a_chain_of_ten_thousand_joints_is_written_and_read():
    joints = [(f"j{i}", i - 1, (0.0, 0.001, 0.0), ["Zrotation"]) for i in range(10_000)]
    motion = Motion(channel_skeleton(joints, []), np.zeros((1, 10_000)), 30.0)
    assert reread(motion).skeleton.joints[-1].parent == 9998


@pytest.mark.parametrize(
    ("text", "fps"),
    [
        ("0.0083333", 120),
        ("0.008333", 120),
        ("0.0333333", 30),
        ("0.04", 25),
        ("0.03", 1 / 0.03),
        ("1e-2", 100),
        ("2", 0.5),
    ],
)
def test_a_rounded_frame_time_means_the_whole_rate(text, fps):
    assert rate_from_frame_time(text) == fps


@given(st.floats(1e-3, 1e5))
def test_frame_times_give_the_rate_back(fps):
    text = frame_time_text(fps)
    assert rate_from_frame_time(text) == pytest.approx(fps, rel=1e-15)
    assert frame_time_text(rate_from_frame_time(text)) == text
