"""BVH opens in every dialect, and what it cannot mean is refused with its line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from qmd_studio.errors import FormatError
from qmd_studio.formats import bvh
from qmd_studio.formats.loaded import ReadOptions
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged

PLAIN = """HIERARCHY
ROOT Hips
{
\tOFFSET 0 90 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Chest
\t{
\t\tOFFSET 0 50 0
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 35 0
\t\t}
\t}
\tJOINT Leg
\t{
\t\tOFFSET 10 -90 0
\t\tCHANNELS 1 Xrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 0 10
\t\t}
\t}
}
MOTION
Frames: 3
Frame Time: 0.0333333
1 92 3 10 20 30 1 2 3 45
2 93 4 11 21 31 2 3 4 46
3 94 5 12 22 32 3 4 5 47
"""
ROWS = [[1, 92, 3, 10, 20, 30, 1, 2, 3, 45], [2, 93, 4, 11, 21, 31, 2, 3, 4, 46], [3, 94, 5, 12, 22, 32, 3, 4, 5, 47]]
FACTORS = [0.01] * 3 + [np.pi / 180] * 7


def read(data, **options):
    return bvh.read(data if isinstance(data, bytes) else data.encode(), ReadOptions(**options))


def test_a_plain_file_has_its_joints_values_and_rate():
    loaded = read(PLAIN, path=Path("walk.bvh"))
    assert [joint.name for joint in loaded.skeleton.joints] == ["Hips", "Chest", "Leg"]
    assert loaded.skeleton.levels == (1, 1, 1, 1, 1, 1, 2, 2, 2, 2)
    assert loaded.motion.fps == 30.0
    assert loaded.motion.name == "walk"
    assert "centimetre" in loaded.notes[0]
    np.testing.assert_allclose(loaded.motion.X, np.array(ROWS) * FACTORS, rtol=1e-15)
    assert not loaded.warnings


@pytest.mark.parametrize(("chest", "said"), [("0 0.02 0", True), ("0 51 0", False)], ids=["added", "replacing"])
def test_positions_below_the_root_are_added_or_replace_as_they_must_mean(chest, said):
    text = PLAIN.replace("CHANNELS 3 Zrotation", "CHANNELS 6 Xposition Yposition Zposition Zrotation").replace(
        " 1 2 3 45", f" {chest} 1 2 3 45"
    )
    text = text.replace(" 2 3 4 46", f" {chest} 2 3 4 46").replace(" 3 4 5 47", f" {chest} 3 4 5 47")
    loaded = read(text)
    height = 0.01 * (50.02 if said else 51)
    np.testing.assert_allclose(loaded.motion.X[:, 6:9], [[0, height, 0]] * 3, atol=1e-12)
    assert any("added" in note for note in loaded.notes) is said
    again = read(bvh.write(loaded.motion))
    np.testing.assert_allclose(again.motion.X, loaded.motion.X, atol=1e-12)


def test_every_prefix_ends_well():
    assert_every_prefix_ends_well(read, PLAIN.encode())


@settings(max_examples=300, deadline=None)
@given(damaged(PLAIN.encode()))
def test_damage_ends_well(data):
    assert_ends_well(read, data)


def test_absurd_counts_cost_nothing():
    data = b"HIERARCHY ROOT a {OFFSET 0 0 0 CHANNELS 1 Xrotation}\nMOTION\nFrames: 2147483648\nFrame Time: 0.1\n"
    problem = assert_ends_well(read, data)
    assert isinstance(problem, FormatError)
    assert problem.at == "line 3"


def test_nan_is_refused_with_its_line():
    with pytest.raises(FormatError) as caught:
        read(PLAIN.replace("11 21", "nan 21"))
    assert caught.value.at == "line 29"
    assert caught.value.got == "nan"


@pytest.mark.filterwarnings("error")
def test_numbers_whose_sum_overflows_are_refused_without_a_warning_of_numpy():
    with pytest.raises(FormatError, match="too large"):
        read(PLAIN.replace("11 21", "1e308 1e308"))
