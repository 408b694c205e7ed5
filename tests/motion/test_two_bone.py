"""The closed form puts wrists and ankles where they shall be, at the swivel asked for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.errors import EditError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import node_positions, rest_values
from qmd_studio.motion.two_bone import limb_of, solve_limb, swivel_of

BODY = bap_skeleton()
REST = rest_values(BODY)
LIMBS = {name: limb_of(BODY, BODY.joint_index(name)) for name in ("l_wrist", "r_wrist", "l_ankle", "r_ankle")}


def places(pose):
    return node_positions(BODY, pose[None])[0]


@settings(max_examples=100, deadline=None)
@given(name=st.sampled_from(sorted(LIMBS)), seed=st.integers(0, 2**32 - 1))
def test_any_place_in_reach_is_hit_with_the_swivel_asked_for(name, seed):
    random = np.random.default_rng(seed)
    limb = LIMBS[name]
    pose = random.normal(scale=0.4, size=BODY.n_columns)
    near, middle, end = places(pose)[[limb.near, limb.middle, limb.end]]
    longest = np.linalg.norm(middle - near) + np.linalg.norm(end - middle)
    way = random.normal(size=3)
    target = near + way / np.linalg.norm(way) * longest * random.uniform(0.3, 0.95)
    swivel = float(random.uniform(-np.pi, np.pi))
    found = solve_limb(BODY, pose, limb, target, swivel=swivel)
    assert found.metres < 1e-9
    np.testing.assert_allclose(places(found.pose)[limb.end], target, atol=1e-9)
    assert abs((swivel_of(BODY, found.pose, limb) - swivel + np.pi) % (2 * np.pi) - np.pi) < 1e-6
    changed = np.flatnonzero(found.pose != pose)
    assert {BODY.columns[c].joint for c in changed} <= {limb.near, limb.middle}


def test_without_a_swivel_the_elbow_stays_on_its_side():
    pose = REST.copy()
    pose[[c.name for c in BODY.columns].index("l_elbow_flexion")] = 1.0
    limb = LIMBS["l_wrist"]
    before = swivel_of(BODY, pose, limb)
    found = solve_limb(BODY, pose, limb, places(pose)[limb.end] + [0.05, 0.05, 0.0])
    assert found.metres < 1e-9
    assert swivel_of(BODY, found.pose, limb) == pytest.approx(before, abs=1e-9)


@pytest.mark.parametrize("name", sorted(LIMBS))
def test_where_it_is_it_stays(name):
    pose = np.random.default_rng(3).normal(scale=0.2, size=BODY.n_columns)
    limits = np.array([c.limits or (-9.0, 9.0) for c in BODY.columns])
    pose = np.clip(pose, *limits.T)  # beyond them the other way to bend would be the better one
    limb = LIMBS[name]
    found = solve_limb(BODY, pose, limb, places(pose)[limb.end])
    np.testing.assert_allclose(places(found.pose), places(pose), atol=1e-7)


def test_out_of_reach_the_limb_is_straight_towards_the_target():
    limb = LIMBS["l_wrist"]
    near = places(REST)[limb.near]
    found = solve_limb(BODY, REST, limb, near + np.array([0.0, 0.0, 2.0]))
    end = places(found.pose)[limb.end]
    np.testing.assert_allclose(np.cross(end - near, [0, 0, 1]), 0, atol=1e-9)
    assert found.metres == pytest.approx(2.0 - np.linalg.norm(end - near))


def test_the_pose_given_is_not_changed():
    kept = REST.copy()
    solve_limb(BODY, REST, LIMBS["l_wrist"], np.array([0.4, 1.2, 0.3]))
    np.testing.assert_array_equal(REST, kept)


def test_an_impossible_request_is_refused():
    with pytest.raises(EditError):
        solve_limb(BODY, REST, LIMBS["l_wrist"], np.array([0.0, np.nan, 0.0]))
    with pytest.raises(EditError):
        limb_of(BODY, 0)
