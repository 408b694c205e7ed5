"""Inverse kinematics brings nodes to their targets, keeps limits and pins, and says what it could not do."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from qmd_studio.errors import EditError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.bap_mirror import mirrored
from qmd_studio.motion.channels import ROTATIONS_ZYX, channel_skeleton
from qmd_studio.motion.ik import IkSettings, solve_pose, spine_stiffness
from qmd_studio.motion.ik_targets import Effector, bend_of, misses_of, pinned, targets_of
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.skeleton import EndSite
from tests.generated_motion import walker_skeleton
from tests.motion.test_kinematics import skeletons

BODY = bap_skeleton()
NODE = BODY.node_names.index
REST = rest_values(BODY)
PLACES = node_positions(BODY, REST[None])[0]
WITH_SPINE = IkSettings(stiffness=spine_stiffness(BODY, 3.0))


def places(skeleton, pose):
    return node_positions(skeleton, pose[None])[0]


def within_limits(skeleton, pose):
    return all(c.limits is None or c.limits[0] <= v <= c.limits[1] for c, v in zip(skeleton.columns, pose, strict=True))


def feet(pose=REST):
    return [pinned(BODY, pose, NODE(name)) for name in ("l_ankle", "r_ankle")]


def drag(path, others=(), *, start=REST, node="l_wrist", chosen=WITH_SPINE):
    """Solve for each place of `path`, each from the solution before."""
    solutions = []
    for place in path:
        solutions.append(solve_pose(BODY, start, [*others, Effector(NODE(node), place)], chosen))
        start = solutions[-1].pose
    return solutions


def circle(centre, radius, n=60):
    turn = np.linspace(0, 2 * np.pi, n)
    return centre + radius * np.stack([np.sin(turn), 1 - np.cos(turn), np.sin(turn)], axis=1)


def misses(skeleton, pose, effectors):
    """The residuals, written anew from the definition: plain kinematics, SciPy's rotation vectors."""
    world, nodes = world_from_joint(skeleton, pose[None])[0], places(skeleton, pose)
    rows = []
    for effector in effectors:
        if effector.position is not None:
            rows.append(effector.weight * (nodes[effector.node] - effector.position))
        if effector.orientation is not None:
            sites = [site.joint for site in skeleton.end_sites]
            joint = [*range(len(skeleton.joints)), *sites][effector.node]
            turn = Rotation.from_matrix(world[joint, :3, :3] @ effector.orientation.T)
            rows.append(effector.orientation_weight * turn.as_rotvec())
    return np.concatenate(rows)


@settings(max_examples=50, deadline=None)
@given(skeleton=skeletons(), seed=st.integers(0, 2**32 - 1))
def test_the_jacobian_and_the_bend_are_those_of_small_differences(skeleton, seed):
    random = np.random.default_rng(seed)
    pose = random.normal(size=skeleton.n_columns)
    nodes = random.integers(skeleton.n_nodes, size=3)
    effectors = [Effector(int(k), random.normal(size=3), None, weight=2.0) for k in nodes]
    turned = Effector(int(nodes[0]), None, Rotation.random(rng=random).as_matrix())
    found = misses_of(targets_of(skeleton, [*effectors, turned]), pose)
    np.testing.assert_allclose(found.residual, misses(skeleton, pose, [*effectors, turned]), atol=1e-9)
    targets = targets_of(skeleton, effectors)

    def slope(row):
        at = misses_of(targets, row)
        return at.jacobian.T @ at.residual

    nudges = 1e-6 * np.eye(len(pose))
    jacobian = [
        (misses(skeleton, pose + d, [*effectors, turned]) - misses(skeleton, pose - d, [*effectors, turned])) / 2e-6
        for d in nudges
    ]
    if np.linalg.norm(found.residual[-3:]) < 0.1 * (math.pi - 0.01):  # there the rotation vector itself jumps
        np.testing.assert_allclose(found.jacobian, np.reshape(jacobian, (-1, len(found.residual))).T, atol=1e-5)
    hessian = np.reshape([(slope(pose + d) - slope(pose - d)) / 2e-6 for d in nudges], (len(pose), len(pose)))
    at = misses_of(targets, pose)
    np.testing.assert_allclose(at.jacobian.T @ at.jacobian + bend_of(targets, at), hessian, atol=1e-4)


def test_five_effectors_are_reached_within_a_tenth_of_a_millimetre():
    shifts = {
        "l_wrist": (0.1, 0.3, 0.3),
        "r_wrist": (-0.2, 0.2, 0.2),
        "l_ankle": (0.05, 0.1, 0.2),
        "r_ankle": (0.0, 0.0, 0.0),
        "skull_tip": (0.03, -0.05, 0.05),
    }
    effectors = [Effector(NODE(name), PLACES[NODE(name)] + shift) for name, shift in shifts.items()]
    solution = solve_pose(BODY, REST, effectors)
    found = places(BODY, solution.pose)[[e.node for e in effectors]]
    missed = np.linalg.norm(found - [e.position for e in effectors], axis=1)
    assert solution.reached
    assert missed.max() < 1e-4
    np.testing.assert_allclose(solution.metres, missed, atol=1e-9)
    assert solution.iterations <= 30
    assert within_limits(BODY, solution.pose)


@pytest.mark.parametrize("seed", range(6))
def test_least_squares_of_scipy_finds_nothing_better(seed):
    random = np.random.default_rng(seed)
    arm = [k for k, c in enumerate(BODY.columns) if c.name.startswith(("l_shoulder", "l_elbow", "vt1_"))]
    active = np.isin(np.arange(BODY.n_columns), arm)
    shift = random.normal((0.1, 0.2, 0.3), 0.25 if seed < 3 else 1.0)
    target = Effector(NODE("l_wrist"), PLACES[NODE("l_wrist")] + shift)
    lowest, highest = np.array([BODY.columns[k].limits for k in arm]).T
    start = REST.copy()
    start[arm] = np.clip(0.2, lowest + 1e-6, highest - 1e-6)

    def all_residuals(values):
        poses = np.tile(start, (len(values), 1))
        poses[:, arm] = values
        off = node_positions(BODY, poses)[:, target.node] - target.position
        return np.concatenate([off, 2e-3 * (values - start[arm])], axis=1)

    def residuals(values):
        return all_residuals(values[None])[0]

    def slopes(values):
        nudges = 1e-6 * np.eye(len(arm))
        return (all_residuals(values + nudges) - all_residuals(values - nudges)).T / 2e-6

    twin = least_squares(residuals, start[arm], jac=slopes, bounds=(lowest, highest), max_nfev=200)
    ours = solve_pose(BODY, start, [target], IkSettings(active=active, max_iterations=200))
    assert ours.cost <= twin.cost * 1.001 + 1e-10
    assert ours.cost == pytest.approx((residuals(ours.pose[arm]) ** 2).sum() / 2, rel=1e-6)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_limits_are_never_left_and_locked_columns_never_move(seed):
    random = np.random.default_rng(seed)
    start = random.normal(scale=1.5, size=BODY.n_columns)
    active = random.random(BODY.n_columns) < 0.7
    nodes = random.integers(BODY.n_nodes, size=3)
    effectors = [Effector(int(k), PLACES[k] + random.normal(scale=0.5, size=3)) for k in nodes]
    free = bool(random.random() < 0.5)
    solution = solve_pose(BODY, start, effectors, IkSettings(active=active, root_free=free, max_iterations=12))
    rooted = np.array([c.joint == 0 for c in BODY.columns]) & (not free)
    moving = active & ~rooted
    np.testing.assert_array_equal(solution.pose[~moving], start[~moving])
    for column, value, moves in zip(BODY.columns, solution.pose, moving, strict=True):
        if moves and column.limits:
            assert column.limits[0] <= value <= column.limits[1]


def test_pinned_feet_stay_while_a_hand_is_pulled_through_and_out_of_reach():
    path = np.concatenate([circle(PLACES[NODE("l_wrist")], 0.25), circle(PLACES[NODE("l_wrist")], 0.9, 25)])
    for solution in drag(path, feet()):
        for name in ("l_ankle", "r_ankle"):
            assert np.linalg.norm(places(BODY, solution.pose)[NODE(name)] - PLACES[NODE(name)]) < 1e-3
        assert within_limits(BODY, solution.pose)


def test_a_drag_turns_no_joint_by_more_than_a_degree_a_millimetre():
    path = circle(PLACES[NODE("l_wrist")], 0.25, 150)
    poses = [solution.pose for solution in drag(path, feet())]
    steps_mm = 1e3 * np.linalg.norm(np.diff(path, axis=0), axis=1)
    turned = np.degrees(np.abs(np.diff(poses, axis=0)).max(axis=1))
    assert (turned[1:] <= 1.0 * steps_mm[1:]).all()


def test_an_unreachable_target_is_come_as_near_as_can_be_and_said():
    active = np.array([c.name.startswith(("l_shoulder", "l_elbow")) for c in BODY.columns])
    shoulder = PLACES[NODE("l_shoulder")]
    target = shoulder + np.array([0.6, 0.0, 1.5])
    chosen = IkSettings(active=active, max_iterations=200)
    first = solve_pose(BODY, REST, [Effector(NODE("l_wrist"), target)], chosen)
    bones = PLACES[[NODE("l_elbow"), NODE("l_wrist")]] - PLACES[[NODE("l_shoulder"), NODE("l_elbow")]]
    longest = np.linalg.norm(bones, axis=1).sum()
    assert not first.reached
    assert first.metres[0] == pytest.approx(np.linalg.norm(target - shoulder) - longest, abs=2e-3)
    again = solve_pose(BODY, first.pose, [Effector(NODE("l_wrist"), target)], chosen)
    np.testing.assert_allclose(again.pose, first.pose, atol=2e-3)


def test_a_target_far_beyond_the_body_does_not_shake_it():
    far = np.array([3.0, 4.0, 5.0])
    poses = [s.pose for s in drag([far] * 12, feet())]
    assert np.abs(poses[-1] - poses[-2]).max() < 5e-3
    assert np.abs(poses[-1]).max() < 2 * np.pi


def test_a_mirrored_task_has_the_mirrored_solution():
    place, mirror = PLACES[NODE("l_wrist")] + [0.1, 0.3, 0.2], np.array([-1.0, 1.0, 1.0])
    left = solve_pose(BODY, REST, [*feet(), Effector(NODE("l_wrist"), place)], WITH_SPINE)
    right = solve_pose(BODY, REST, [*feet(), Effector(NODE("r_wrist"), place * mirror)], WITH_SPINE)
    np.testing.assert_allclose(mirrored(left.pose), right.pose, atol=5e-3)


def test_an_orientation_is_kept_while_the_hand_moves():
    hand = NODE("l_wrist")
    wanted = world_from_joint(BODY, REST[None])[0, hand, :3, :3]
    solution = solve_pose(BODY, REST, [Effector(hand, PLACES[hand] + [0.1, 0.1, 0.1], wanted)])
    turned = world_from_joint(BODY, solution.pose[None])[0, hand, :3, :3]
    assert solution.reached
    assert Rotation.from_matrix(turned @ wanted.T).magnitude() < 1e-3


def test_a_stiff_spine_bends_less():
    spine = [k for k, c in enumerate(BODY.columns) if BODY.joints[c.joint].name.startswith(("vl", "vt"))]
    reach = [*feet(), Effector(NODE("l_wrist"), PLACES[NODE("l_wrist")] + [0.0, 0.2, 0.2])]
    loose, stiff = (
        solve_pose(BODY, REST, reach, IkSettings(stiffness=spine_stiffness(BODY, factor), root_free=False))
        for factor in (1.0, 10.0)
    )
    assert stiff.reached
    assert np.linalg.norm(stiff.pose[spine]) < 0.5 * np.linalg.norm(loose.pose[spine])


def test_a_fixed_root_stays_and_a_free_one_goes_along():
    target = [Effector(NODE("l_wrist"), PLACES[NODE("l_wrist")] + [0.0, 0.0, 3.0])]
    assert not solve_pose(BODY, REST, target, IkSettings(root_free=False)).reached
    assert solve_pose(BODY, REST, target, IkSettings(max_iterations=100)).reached


def test_other_skeletons_are_solved_too():
    walker = walker_skeleton()
    node = walker.node_names.index("lhand")
    target = places(walker, rest_values(walker))[node] + [0.1, 0.1, 0.1]
    assert solve_pose(walker, rest_values(walker), [Effector(node, target)]).reached
    arm = [("a", -1, (0.0, 0.0, 0.0), ROTATIONS_ZYX), ("b", 0, (0.0, 1.0, 0.0), ROTATIONS_ZYX)]
    chain = channel_skeleton(arm, [EndSite("tip", 1, (0.0, 1.0, 0.0))])
    assert solve_pose(chain, rest_values(chain), [Effector(2, np.array([1.0, 1.0, 0.5]))]).reached


def test_bones_of_no_length_are_stood():
    chain = channel_skeleton([("a", -1, (0.0,) * 3, ROTATIONS_ZYX)], [EndSite("tip", 0, (0.0,) * 3)])
    solution = solve_pose(chain, np.zeros(3), [Effector(1, np.array([1.0, 0.0, 0.0]))])
    assert solution.metres[0] == pytest.approx(1.0)
    assert not solution.reached
    np.testing.assert_array_equal(solution.pose, 0.0)


WRIST = NODE("l_wrist")
REFUSED = {
    "no effector": ([], IkSettings()),
    "no column": ([Effector(WRIST, np.zeros(3))], IkSettings(active=np.zeros(186, dtype=bool))),
    "a mask too short": ([Effector(WRIST, np.zeros(3))], IkSettings(active=np.ones(3, dtype=bool))),
    "nan": ([Effector(WRIST, np.array([0.0, np.nan, 0.0]))], IkSettings()),
    "infinite": ([Effector(WRIST, np.array([0.0, np.inf, 0.0]))], IkSettings()),
    "two numbers": ([Effector(WRIST, np.zeros(2))], IkSettings()),
    "no target": ([Effector(WRIST)], IkSettings()),
    "no rotation": ([Effector(WRIST, None, 2 * np.eye(3))], IkSettings()),
    "no node": ([Effector(9999, np.zeros(3))], IkSettings()),
    "a weight of nothing": ([Effector(WRIST, np.zeros(3), weight=0.0)], IkSettings()),
    "a negative stiffness": ([Effector(WRIST, np.zeros(3))], IkSettings(stiffness=-np.ones(186))),
}


@pytest.mark.parametrize(("effectors", "chosen"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_asked_is_refused(effectors, chosen):
    with pytest.raises(EditError):
        solve_pose(BODY, REST, effectors, chosen)


def test_a_pose_that_is_no_number_is_refused():
    with pytest.raises(EditError):
        solve_pose(BODY, np.full(186, np.nan), feet())
