"""The parameter table and the skeleton made of it."""

from collections import Counter

import numpy as np
import pytest

from qmd_studio.motion.bap import N_BAPS, N_DEFINED_BAPS, bap, bap_skeleton, bap_table, column_of
from qmd_studio.motion.kinematics import node_positions, rest_values
from qmd_studio.motion.skeleton import ColumnKind


def test_table_numbers_the_296_parameters_in_order():
    assert [parameter.id for parameter in bap_table()] == list(range(1, N_BAPS + 1))
    assert len({parameter.name for parameter in bap_table()}) == N_BAPS
    kinds = Counter(parameter.kind for parameter in bap_table())
    assert kinds == {ColumnKind.ROTATION: 183, ColumnKind.TRANSLATION: 3, ColumnKind.OPAQUE: 110}


def test_groups_partition_the_parameters_in_coding_order():
    sizes = Counter(parameter.group for parameter in bap_table())
    wanted = [3, 4, 4, 6, 6, 5, 5, 7, 7, 12, 15, 18, 18, 12, 16, 16, 13, 13, 6, 22, 22, 22, 22, 22]
    assert [sizes[group] for group in range(1, 25)] == wanted
    for group, size in sizes.items():
        assert sorted(p.place for p in bap_table() if p.group == group) == list(range(size))


def test_old_numbering_is_1_to_169_each_once():
    assert sorted(p.old_id for p in bap_table() if p.old_id is not None) == list(range(1, 170))


def test_each_defined_parameter_says_what_positive_means():
    assert all(parameter.positive_means for parameter in bap_table()[:N_DEFINED_BAPS])


def test_columns_start_with_the_root_and_go_down_the_levels():
    skeleton = bap_skeleton()
    assert skeleton.n_columns == N_DEFINED_BAPS
    assert [column.bap_id for column in skeleton.columns[:6]] == [182, 181, 183, 186, 184, 185]
    assert list(skeleton.levels) == sorted(skeleton.levels)
    level_joints = {
        level: {skeleton.joints[c.joint].name for c in skeleton.columns if c.level == level} for level in range(1, 7)
    }
    assert level_joints[1] == {"HumanoidRoot"}
    assert level_joints[2] == {"sacroiliac", "vl1", "vl2", "vl3", "vl4", "vl5"}
    assert level_joints[5] == {"l_ankle", "r_ankle", "l_elbow", "r_elbow"}
    assert {"l_wrist", "r_pinky3", "l_subtalar", "r_metatarsal"} <= level_joints[6]
    assert {"skullbase", "vc1", "l_knee", "r_shoulder", "l_sternoclavicular", "l_acromioclavicular"} <= level_joints[4]


def test_extensions_come_last_and_move_nothing():
    plain, full = bap_skeleton(), bap_skeleton(extensions=True)
    assert full.columns[:N_DEFINED_BAPS] == plain.columns
    assert [column.bap_id for column in full.columns[N_DEFINED_BAPS:]] == list(range(187, 297))
    X = np.zeros((1, N_BAPS))
    X[:, N_DEFINED_BAPS:] = 7.0
    assert np.array_equal(node_positions(full, X), node_positions(plain, np.zeros((1, N_DEFINED_BAPS))))


def test_column_of_finds_every_parameter():
    columns = bap_skeleton(extensions=True).columns
    assert all(columns[column_of(bap_id)].bap_id == bap_id for bap_id in range(1, N_BAPS + 1))
    for wrong in (0, -1, 297):
        with pytest.raises(KeyError, match="1 to 296"):
            column_of(wrong)


def test_rest_pose_stands_on_the_ground_at_its_stature():
    skeleton = bap_skeleton()
    points = dict(zip(skeleton.node_names, node_positions(skeleton, rest_values(skeleton)[None])[0], strict=True))
    assert len(points) == 87 + 15
    assert points["skull_tip"] == pytest.approx((0.005, 1.7504, 0.0055), abs=1e-9)
    assert points["HumanoidRoot"] == pytest.approx((0.0, 0.8240, 0.0277), abs=1e-9)
    assert -1e-9 <= min(point[1] for point in points.values()) < 0.01
    for name, point in points.items():
        if name.startswith("r_"):
            assert point * (-1, 1, 1) == pytest.approx(
                points["l" + name[1:]], abs=0.014
            )  # the spine stands 6.6 mm aside


def test_root_moves_by_metres_along_its_own_axes():
    skeleton = bap_skeleton()
    X = np.zeros((1, skeleton.n_columns))
    X[0, [column_of(182), column_of(181), column_of(183)]] = (1.0, 2.0, 3.0)
    moved = node_positions(skeleton, X) - node_positions(skeleton, np.zeros_like(X))
    assert np.allclose(moved, (1.0, 2.0, 3.0))
    assert bap(181).si_per_unit == 1e-3


def test_least_numbered_turn_of_a_joint_is_applied_first():
    skeleton = bap_skeleton()
    for joint in skeleton.joints:
        ids = [skeleton.columns[index].bap_id for index in joint.product]
        assert ids == sorted(ids, reverse=True)
