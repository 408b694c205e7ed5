"""The skeleton model refuses parts that do not fit, and keeps what it promises when levels or lengths change."""

import math

import numpy as np
import pytest

from qmd_studio.errors import FormatError
from qmd_studio.motion.kinematics import node_positions, rest_values, world_from_joint
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind, depths


def arm(**changes) -> Skeleton:
    """A root that moves and turns, and an elbow one metre up with a hand half a metre further."""
    parts = {
        "name": "arm",
        "kind": SkeletonKind.BVH,
        "joints": (
            Joint("root", -1, (0.0, 1.0, 0.0), product=(1, 2)),
            Joint("elbow", 0, (0.0, 1.0, 0.0), product=(3,)),
        ),
        "end_sites": (EndSite("hand", 1, (0.0, 0.5, 0.0)),),
        "columns": (
            Column("root ty", 0, ColumnKind.TRANSLATION, axis=1, rest=1.0),
            Column("root rz", 0, ColumnKind.ROTATION, axis=2),
            Column("root rx", 0, ColumnKind.ROTATION, axis=0),
            Column("elbow rz", 1, ColumnKind.ROTATION, axis=2, sign=-1, level=2),
        ),
        "points": (0, 1, 2),
        "metres_per_unit": 0.01,
    }
    return Skeleton(**{**parts, **changes})


def test_positions_at_rest_follow_the_offsets():
    skeleton = arm()
    positions = node_positions(skeleton, rest_values(skeleton)[None])
    np.testing.assert_allclose(positions[0], [[0, 1, 0], [0, 2, 0], [0, 2.5, 0]], atol=1e-12)


def test_translation_value_replaces_its_rest_value():
    positions = node_positions(arm(), np.array([[4.0, 0, 0, 0]]))
    np.testing.assert_allclose(positions[0, 0], [0, 4, 0], atol=1e-12)


def test_positive_value_turns_about_the_signed_axis_by_the_right_hand_rule():
    quarter = math.pi / 2
    turned_at_root = node_positions(arm(), np.array([[1.0, quarter, 0, 0]]))[0]
    np.testing.assert_allclose(turned_at_root[1:], [[-1, 1, 0], [-1.5, 1, 0]], atol=1e-12)
    turned_at_elbow = node_positions(arm(), np.array([[1.0, 0, 0, quarter]]))[0]
    np.testing.assert_allclose(turned_at_elbow[2], [0.5, 2, 0], atol=1e-12)


def test_product_order_not_column_order_decides_the_composition():
    row = np.array([[1.0, math.pi / 2, math.pi / 2, 0]])
    z_after_x = node_positions(arm(), row)[0, 1] - [0, 1, 0]
    joints = (Joint("root", -1, (0.0, 1.0, 0.0), product=(2, 1)), arm().joints[1])
    x_after_z = node_positions(arm(joints=joints), row)[0, 1] - [0, 1, 0]
    np.testing.assert_allclose(z_after_x, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(x_after_z, [-1, 0, 0], atol=1e-12)


def test_world_matrices_are_rigid_for_any_pose():
    rotations = world_from_joint(arm(), np.random.default_rng(5).normal(size=(40, 4)))[..., :3, :3]
    products = rotations @ np.swapaxes(rotations, -1, -2)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"joints": ()}, "no joint"),
        ({"joints": (Joint("root", 0, (0, 0, 0)),)}, "parent does not come before"),
        ({"end_sites": (EndSite("hand", 7, (0, 0, 0)),)}, "hangs from no joint"),
        ({"points": (3,)}, "not a node"),
        ({"columns": (Column("x", 9, ColumnKind.OPAQUE, axis=0),)}, "belongs to no joint"),
        ({"columns": (Column("x", 0, ColumnKind.ROTATION, axis=3),)}, "no axis"),
        ({"columns": (Column("x", 0, ColumnKind.ROTATION, axis=0),)}, "product and its rotation columns differ"),
    ],
)
def test_parts_that_do_not_fit_are_refused_with_their_place(change, message):
    with pytest.raises(FormatError, match=message):
        arm(**change)


def test_levels_can_be_edited_by_column_name():
    changed = arm().with_levels({"elbow rz": 5})
    assert changed.levels == (1, 1, 1, 5)
    assert changed != arm()
    with pytest.raises(FormatError, match="no such column"):
        arm().with_levels({"knee rx": 2})
    with pytest.raises(FormatError, match="out of range"):
        arm().with_levels({"elbow rz": 7})


def test_scaling_a_motion_scales_every_position():
    motion = Motion(arm(), np.array([[1.5, 0.3, 0.2, -1.0], [1.0, 0.0, 0.1, 2.0]]), 30.0)
    doubled = motion.scaled(2.0)
    np.testing.assert_allclose(
        node_positions(doubled.skeleton, doubled.X), 2 * node_positions(motion.skeleton, motion.X), atol=1e-12
    )
    assert doubled.skeleton.metres_per_unit == pytest.approx(0.02)


def test_equal_skeletons_are_equal_and_hash_alike():
    assert arm() == arm()
    assert hash(arm()) == hash(arm())


def test_depths_count_from_the_root():
    assert depths((-1, 0, 1, 0, -1)) == (1, 2, 3, 2, 1)


@pytest.mark.parametrize(
    ("values", "fps", "message"),
    [
        (np.zeros((0, 4)), 30.0, "no frame"),
        (np.zeros((2, 3)), 30.0, "does not fit the skeleton"),
        (np.zeros((2, 4)), 0.0, "frame rate"),
        (np.zeros((2, 4)), math.nan, "frame rate"),
        (np.array([[0, 0, math.inf, 0]]), 30.0, "not a number"),
    ],
)
def test_a_motion_that_cannot_be_played_is_refused(values, fps, message):
    with pytest.raises(FormatError, match=message):
        Motion(arm(), values, fps)


def test_a_motion_cannot_be_changed_in_place():
    values = np.zeros((2, 4))
    motion = Motion(arm(), values, 30.0)
    with pytest.raises(ValueError, match="read-only"):
        motion.X[0, 0] = 1.0
    values[0, 0] = 1.0
    assert motion.X[0, 0] == 0.0, "the caller's array and the motion's must not be one"


@pytest.mark.parametrize("length", [1e300, -1.1e12, math.nan, math.inf])
def test_lengths_that_no_arithmetic_bears_are_refused(length):
    with pytest.raises(FormatError, match="elbow"):
        arm(joints=(arm().joints[0], Joint("elbow", 0, (0.0, length, 0.0), product=(3,))))
    with pytest.raises(FormatError, match="hand"):
        arm(end_sites=(EndSite("hand", 1, (length, 0.0, 0.0)),))
    with pytest.raises(FormatError, match="root ty"):
        arm(columns=(Column("root ty", 0, ColumnKind.TRANSLATION, axis=1, rest=length), *arm().columns[1:]))


@pytest.mark.parametrize("unit", [0.0, -1.0, 1e-7, 1e7, math.nan])
def test_length_unit_out_of_range_is_refused(unit):
    with pytest.raises(FormatError, match="unit"):
        arm(metres_per_unit=unit)


@pytest.mark.parametrize(("value", "said"), [(1e13, "too large"), (-1e300, "too large"), (math.inf, "not a number")])
def test_values_that_no_arithmetic_bears_are_refused_with_their_place(value, said):
    X = np.zeros((4, 4))
    X[2, 3] = value
    with pytest.raises(FormatError, match=said) as caught:
        Motion(arm(), X, 30.0)
    assert caught.value.at == "frame 2, column elbow rz"


@pytest.mark.parametrize("fps", [0.0, -30.0, 1e-320, 1e-4, 1e6, math.inf, math.nan])
def test_frame_rate_that_nothing_plays_is_refused(fps):
    with pytest.raises(FormatError, match="rate"):
        Motion(arm(), np.zeros((1, 4)), fps)
