"""What each parameter does to the body, seen at the joints: planes, directions, curl and mirror."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.motion.bap import bap, bap_skeleton, bap_table, column_of
from qmd_studio.motion.bap_mirror import mirrored, opposite
from qmd_studio.motion.kinematics import node_positions
from qmd_studio.motion.skeleton import ColumnKind

SKELETON = bap_skeleton()
X_LEFT, Y_UP, Z_FRONT = 0, 1, 2
FINGERS = ("index", "middle", "ring", "pinky")


def pose(values):
    """Return the nodes by name under {parameter: degrees}."""
    row = np.zeros((1, SKELETON.n_columns))
    for bap_id, degrees in values.items():
        row[0, column_of(bap_id)] = np.radians(degrees)
    return dict(zip(SKELETON.node_names, node_positions(SKELETON, row)[0], strict=True))


def shift(name, values):
    """Return how far a node moves from rest, metres."""
    return pose(values)[name] - pose({})[name]


def ids(pattern):
    """Return the parameters named `pattern` on the left and the right."""
    number = {parameter.name: parameter.id for parameter in bap_table()}
    return number["l_" + pattern], number["r_" + pattern]


def test_bap_34_moves_the_left_arm_in_the_coronal_plane():
    for degrees in (30, 90, 150):
        moved = pose({34: degrees})
        for name in ("l_elbow", "l_wrist", "l_middle_distal_tip"):
            assert moved[name][Z_FRONT] == pytest.approx(pose({})[name][Z_FRONT], abs=1e-9)
        assert np.linalg.norm(moved["l_wrist"] - pose({})["l_wrist"]) > 0.25
    assert shift("l_wrist", {34: 90})[X_LEFT] > 0.5
    assert pose({34: 90})["l_wrist"][Y_UP] == pytest.approx(pose({})["l_shoulder"][Y_UP], abs=0.02)
    assert np.allclose(shift("r_wrist", {34: 90}), 0)


def test_bap_33_moves_the_right_arm_in_the_sagittal_plane():
    for degrees in (30, 90, 150):
        moved = pose({33: degrees})
        for name in ("r_elbow", "r_wrist", "r_middle_distal_tip"):
            assert moved[name][X_LEFT] == pytest.approx(pose({})[name][X_LEFT], abs=1e-9)
    assert shift("r_wrist", {33: 90})[Z_FRONT] > 0.5
    assert np.allclose(shift("l_wrist", {33: 90}), 0)


@pytest.mark.parametrize("side", [0, 1])
def test_positive_elbow_flexion_bends_forward(side):
    bap_id, name = ids("elbow_flexion")[side], "lr"[side] + "_wrist"
    assert shift(name, {bap_id: 60})[Z_FRONT] > 0.2
    assert shift(name, {bap_id: 60})[X_LEFT] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("side", [0, 1])
def test_knees_bend_backward_within_their_limits(side):
    bap_id, ankle = ids("knee_flexion")[side], "lr"[side] + "_ankle"
    least, most = np.degrees(bap(bap_id).limits)
    bend = least if abs(least) > abs(most) else most
    assert abs(bend) > 100
    assert shift(ankle, {bap_id: bend / 2})[Z_FRONT] < -0.2
    assert np.sign(bend) == -1  # the standard's axis is the hip's: positive swings forward


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("finger", FINGERS)
def test_fingers_curl_to_the_palm(side, finger):
    prefix = "lr"[side]
    curl = {ids(f"{finger}{k}_flexion")[side]: degrees for k, degrees in ((1, -80), (2, -90), (3, -50))}
    rest, curled = pose({}), pose(curl)
    tip, knuckle = f"{prefix}_{finger}_distal_tip", f"{prefix}_{finger}1"
    to_the_thigh = -1 if prefix == "l" else 1
    half = shift(tip, {bap_id: degrees / 2 for bap_id, degrees in curl.items()})
    assert half[X_LEFT] * to_the_thigh > 0.03
    assert np.linalg.norm(curled[tip] - rest[knuckle]) < 0.06  # into the palm, not out behind it
    assert curled[tip][Z_FRONT] == pytest.approx(rest[tip][Z_FRONT], abs=0.006)
    assert all(degrees > 0 or bap(bap_id).limits[0] <= np.radians(degrees) for bap_id, degrees in curl.items())


@pytest.mark.parametrize("side", [0, 1])
def test_thumb_curls_toward_the_fingers_and_turns_before_the_palm(side):
    prefix = "lr"[side]
    tip = f"{prefix}_thumb_distal_tip"
    curl = {ids("thumb1_flexion")[side]: -15, ids("thumb2_flexion")[side]: -40, ids("thumb3_flexion")[side]: -60}
    rest, curled = pose({}), pose(curl)
    index = rest[f"{prefix}_index2"]
    assert np.linalg.norm(curled[tip] - index) < np.linalg.norm(rest[tip] - index) - 0.02
    pivot = ids("thumb1_pivot")[side]
    to_the_thigh = -1 if prefix == "l" else 1
    least, most = np.degrees(bap(pivot).limits)
    opposed = least if abs(least) > abs(most) else most
    assert shift(tip, {pivot: opposed})[X_LEFT] * to_the_thigh > 0.06


def test_finger_pivots_spread_in_the_plane_of_the_palm():
    for side, prefix in enumerate("lr"):
        outward = 1 if prefix == "l" else -1
        moved = shift(f"{prefix}_pinky_distal_tip", {ids("pinky1_pivot")[side]: 15 * outward})
        assert moved[Z_FRONT] < -0.015
        assert moved[X_LEFT] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("values", "node", "axis", "sign"),
    [
        ({4: 45}, "l_knee", Z_FRONT, 1),
        ({5: 45}, "r_knee", Z_FRONT, 1),
        ({6: 30}, "l_knee", X_LEFT, 1),
        ({7: -30}, "r_knee", X_LEFT, -1),
        ({14: 20}, "l_digit2", Y_UP, 1),
        ({22: 30}, "l_digit2", Y_UP, 1),
        ({24: 20}, "l_shoulder", Y_UP, 1),
        ({25: -20}, "r_shoulder", Y_UP, 1),
        ({42: 45}, "l_middle3", X_LEFT, -1),
        ({43: -45}, "r_middle3", X_LEFT, 1),
        ({44: 20}, "l_middle3", Z_FRONT, 1),
        ({50: 20}, "skull_tip", Z_FRONT, -1),
        ({48: 10}, "skull_tip", X_LEFT, -1),
        ({122: 15}, "skull_tip", Z_FRONT, -1),
        ({186: 20}, "skull_tip", Z_FRONT, 1),
        ({184: 30}, "l_digit2", X_LEFT, 1),
    ],
)
def test_positive_values_do_what_the_table_says(values, node, axis, sign):
    assert shift(node, values)[axis] * sign > 0.005


def test_opposite_pairs_the_sides():
    assert (opposite(34), opposite(35), opposite(122), opposite(182)) == (35, 34, 122, 182)
    assert all(opposite(opposite(parameter.id)) == parameter.id for parameter in bap_table())


def symmetric_skeleton():
    """Return the skeleton with its spine, which the standard puts 6.6 mm aside, in the middle."""
    middle = {joint.name for joint in SKELETON.joints if joint.name[:2] not in ("l_", "r_")}
    shifted = {site.name: replace(site, offset=(0.0, *site.offset[1:])) for site in SKELETON.end_sites[:1]}
    joints = []
    for joint in SKELETON.joints:
        offset = joint.offset
        if joint.name in middle:
            offset = (0.0, *offset[1:])
        elif joint.name[2:] == "sternoclavicular":
            offset = (0.08 if joint.name[0] == "l" else -0.08, *offset[1:])
        joints.append(replace(joint, offset=offset))
    sites = tuple(shifted.get(site.name, site) for site in SKELETON.end_sites)
    return replace(SKELETON, joints=tuple(joints), end_sites=sites)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_mirror_poses_mirror(seed):
    row = np.random.default_rng(seed).uniform(-1.5, 1.5, (2, SKELETON.n_columns))
    skeleton = symmetric_skeleton()
    names = skeleton.node_names
    other = [names.index({"l_": "r_", "r_": "l_"}.get(n[:2], n[:2]) + n[2:]) for n in names]
    image = node_positions(skeleton, row)[:, other] * (-1, 1, 1)
    assert np.allclose(node_positions(skeleton, mirrored(row)), image, atol=1e-9)
    assert np.array_equal(mirrored(mirrored(row)), row)


def test_mirror_of_the_standard_facts():
    row = np.zeros(SKELETON.n_columns)
    row[column_of(34)], row[column_of(4)], row[column_of(182)], row[column_of(49)] = 1.0, 0.5, 0.2, 0.3
    image = mirrored(row)
    assert image[column_of(35)] == -1.0  # outward on the right is negative
    assert image[column_of(5)] == 0.5
    assert image[column_of(182)] == -0.2
    assert image[column_of(49)] == -0.3
    assert np.count_nonzero(image) == 4


def test_limits_stand_on_both_sides_alike_and_hold_the_rest_pose():
    lows = np.array([c.limits[0] if c.limits else np.nan for c in SKELETON.columns])
    highs = np.array([c.limits[1] if c.limits else np.nan for c in SKELETON.columns])
    a, b = mirrored(lows), mirrored(highs)
    assert np.allclose(np.fmin(a, b), lows, equal_nan=True)
    assert np.allclose(np.fmax(a, b), highs, equal_nan=True)
    for column in SKELETON.columns:
        if column.level == 1:
            assert column.limits is None
        else:
            assert column.kind is ColumnKind.ROTATION
            assert -np.pi <= column.limits[0] <= 0 <= column.limits[1] <= np.pi
