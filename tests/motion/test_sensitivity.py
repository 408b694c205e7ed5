"""What the columns do to the joints is what moving them a little does, on any skeleton."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import point_positions, world_from_joint
from qmd_studio.motion.motion import ASF_UNIT_M
from qmd_studio.motion.sensitivity import ORIENTATION_REACH, column_sensitivities, sensitivities
from qmd_studio.motion.skeleton import ColumnKind
from tests.codecs.tiny_motions import pendulum_skeleton
from tests.generated_motion import walker_skeleton
from tests.motion.test_kinematics import skeletons

STEP = 1e-5


def by_differences(skeleton, row):
    """Return Jᵀ J by central differences: points, and the joints' turns as rotation vectors, in ASF units."""
    scale = np.array([ASF_UNIT_M if c.kind is ColumnKind.TRANSLATION else 1.0 for c in skeleton.columns])

    def places_and_turns(values):
        X = (values * scale)[np.newaxis]
        places = point_positions(skeleton, X)[0].ravel() / ASF_UNIT_M
        return places, world_from_joint(skeleton, X)[0, :, :3, :3]

    upright = places_and_turns(row)[1]
    columns = []
    for nudge in STEP * np.eye(skeleton.n_columns):
        (ahead, turned), (behind, turned_back) = places_and_turns(row + nudge), places_and_turns(row - nudge)
        spin = (turned - turned_back) @ np.swapaxes(upright, 1, 2) / (2 * STEP)
        vectors = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
        columns.append(np.concatenate([(ahead - behind) / (2 * STEP), ORIENTATION_REACH * vectors.ravel()]))
    J = np.array(columns).reshape(skeleton.n_columns, len(upright) * 3 + len(skeleton.points) * 3).T
    return J.T @ J


def assert_close(found, wanted):
    np.testing.assert_allclose(found, wanted, atol=1e-6 * max(1.0, np.abs(wanted).max(initial=0.0)))


@settings(max_examples=60, deadline=None)
@given(skeleton=skeletons(), seed=st.integers(0, 2**32 - 1))
def test_sensitivities_of_any_skeleton_are_those_of_small_differences(skeleton, seed):
    rows = np.random.default_rng(seed).normal(scale=2.0, size=(2, skeleton.n_columns))
    found = sensitivities(skeleton, rows)
    for row, H in zip(rows, found, strict=True):
        assert_close(H, by_differences(skeleton, row))
        assert np.array_equal(H, H.T)
    assert np.array_equal(column_sensitivities(skeleton, rows), np.diagonal(found, axis1=1, axis2=2))


@pytest.mark.parametrize("skeleton", [walker_skeleton(), bap_skeleton()], ids=lambda s: s.name)
def test_sensitivities_of_a_body_are_those_of_small_differences(skeleton):
    row = np.random.default_rng(8).normal(scale=0.4, size=skeleton.n_columns)
    assert_close(sensitivities(skeleton, row[np.newaxis])[0], by_differences(skeleton, row))


def test_sensitivities_do_not_know_where_the_body_stands():
    skeleton = walker_skeleton()
    near = np.random.default_rng(9).normal(scale=0.4, size=(1, skeleton.n_columns))
    far = near.copy()
    far[0, :3] += 1e7
    np.testing.assert_allclose(sensitivities(skeleton, far), sensitivities(skeleton, near), rtol=1e-6, atol=1e-4)


def test_sensitivities_of_a_column_that_moves_nothing_are_zero():
    H = sensitivities(pendulum_skeleton(), np.array([[1.0, 0.5, 1.0]]))[0]
    lamp = [column.name for column in pendulum_skeleton().columns].index("lamp")
    assert np.flatnonzero(H.any(axis=0)).tolist() == [0, 1]
    assert not H[lamp].any()


def test_sensitivities_change_neither_their_input_nor_earlier_answers():
    skeleton = walker_skeleton()
    rows = np.random.default_rng(1).normal(size=(3, skeleton.n_columns))
    kept, first = rows.copy(), sensitivities(skeleton, rows)
    again = first.copy()
    sensitivities(skeleton, rows + 1.0)
    assert np.array_equal(rows, kept)
    assert np.array_equal(first, again)
