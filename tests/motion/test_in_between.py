"""Poses between frames: straight where a body moves, still where its angles only change their name."""

import numpy as np
import pytest

from qmd_studio.motion.bap import bap_skeleton, column_of
from qmd_studio.motion.in_between import in_between

ELBOW, ABDUCT, TWIST = column_of(38), column_of(34), column_of(36)


def rows(**changes):
    before = np.zeros(bap_skeleton().n_columns)
    after = before.copy()
    for column, value in changes.items():
        after[globals()[column]] = value
    return before, after


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_a_bend_goes_straight(share):
    before, after = rows(ELBOW=0.4)
    np.testing.assert_allclose(in_between(bap_skeleton(), before, after, share), share * after)


def test_a_joint_whose_angle_flips_waits_and_the_others_go_on():
    before, after = rows(ABDUCT=2 * np.pi, TWIST=0.2, ELBOW=0.4)
    shown = in_between(bap_skeleton(), before, after, 0.5)
    assert (shown[ABDUCT], shown[TWIST], shown[ELBOW]) == (0.0, 0.0, 0.2)
    assert after[TWIST] == 0.2, "the rows themselves stay as they are"


def test_a_long_way_is_no_flip():
    root = column_of(182)
    before, after = rows()
    after[root] = 3.0
    assert in_between(bap_skeleton(), before, after, 0.5)[root] == 1.5
