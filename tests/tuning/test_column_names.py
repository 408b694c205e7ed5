from dataclasses import replace

import pytest

from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.tuning.column_names import exact_columns, short_name
from qmd_studio.tuning.levels import default_levels
from tests.generated_motion import walker_skeleton


@pytest.mark.parametrize(
    ("fdf", "text"),
    [
        (0, ""),
        (2, "root tx ty"),
        (6, "root"),
        (8, "root, lowerback rx ry"),
        (9, "root, lowerback"),
    ],
)
def test_whole_joints_go_by_their_name_and_parts_by_their_axes(fdf, text):
    assert exact_columns(walker_skeleton(), fdf) == text


def test_names_of_body_animation_parameters_are_read_too():
    assert exact_columns(bap_skeleton(), 7) == "HumanoidRoot, sacroiliac tilt"


def test_a_column_that_does_not_bear_its_joints_name_goes_by_its_own():
    skeleton = walker_skeleton()
    columns = (replace(skeleton.columns[0], name="sway"), *skeleton.columns[1:])
    skeleton = replace(skeleton, columns=columns)
    assert short_name(skeleton, 0) == "sway"
    assert exact_columns(skeleton, 2) == "root sway ty"


def test_default_levels_are_those_that_readers_give():
    for skeleton in (walker_skeleton(), bap_skeleton()):
        assert default_levels(skeleton) == skeleton.levels
        edited = skeleton.with_levels({skeleton.columns[0].name: 6})
        assert default_levels(edited) == skeleton.levels
