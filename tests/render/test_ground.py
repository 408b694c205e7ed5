"""The ground lies where the figure stands: at zero, or where a file without a floor lets it hang."""

import numpy as np
import pytest

from qmd_studio.avatar.fit import fit_bones
from qmd_studio.motion.bap import bap_skeleton, column_of
from qmd_studio.motion.motion import Motion
from qmd_studio.render.ground import ground_height

VERTICAL, SHOULDER = 181, 33


def standing(height, n_frames=5):
    values = np.zeros((n_frames, bap_skeleton().n_columns))
    values[:, column_of(VERTICAL)] = height
    return Motion(bap_skeleton(), values, 30.0)


def ground(motion):
    return ground_height(motion, fit_bones(motion))


def test_a_figure_on_the_floor_has_the_ground_at_zero():
    assert ground(standing(0.0)) == 0.0


def test_a_jump_leaves_the_ground_where_it_is():
    motion = standing(0.0)
    values = motion.X.copy()
    values[2, column_of(VERTICAL)] = 0.6
    assert ground(motion.with_values(values)) == 0.0


@pytest.mark.parametrize("height", [-0.9, 1.4])
def test_a_figure_without_a_floor_gets_it_under_its_soles(height):
    assert ground(standing(height)) == pytest.approx(height, abs=0.05)
