"""Joints are recognised in every program's naming, and maps of joints are kept in files that may be damaged."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.errors import FormatError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.joint_map import JointMap, cmu_62_map, match_joints, read_joint_map, write_joint_map
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged
from tests.motion.retarget_figures import NAMINGS, figure, names_in

GOLDEN = write_joint_map(match_joints(figure("cmu"), bap_skeleton()))


@pytest.mark.parametrize("naming", NAMINGS)
def test_every_naming_is_recognised(naming):
    skeleton, names = figure(naming), names_in(naming)
    parts = parts_of(skeleton)
    found = {part: skeleton.joints[joint].name for part, joint in parts.named.items()}
    skipped = ("root", "spine1", "spine2", "neck") + (("l_toe", "r_toe") if naming == "unknown" else ())
    assert found == {part: name for part, name in names.items() if part not in skipped}
    assert [skeleton.joints[j].name for j in parts.spine] == [names["spine1"], names["spine2"]]
    assert [skeleton.joints[j].name for j in parts.neck] == [names["neck"]]


def test_shoulder_is_the_collar_bone_only_where_another_joint_is_the_arm():
    collar = parts_of(figure("mixamo")).named["l_clavicle"]
    assert figure("mixamo").joints[collar].name == "mixamorig:LeftShoulder"
    upper = parts_of(figure("xsens")).named["l_shoulder"]
    assert figure("xsens").joints[upper].name == "LeftShoulder"
    mixed = parts_of(figure("mixed")).named
    assert figure("mixed").joints[mixed["l_shoulder"]].name == "LeftShoulder"
    assert figure("mixed").joints[mixed["l_clavicle"]].name == "LeftCollar"


def test_fingers_in_one_move_all_four():
    pairs = dict(match_joints(bap_skeleton(), bap_skeleton()).pairs)
    assert pairs["l_index2"] == ("l_index2",)
    assert len(pairs) == len(bap_skeleton().joints)


def test_map_comes_back_from_its_file():
    for joint_map in (read_joint_map(GOLDEN), JointMap((("a", ("b", "c")),), ("b_turn",)), JointMap((('"é', ()),))):
        assert read_joint_map(write_joint_map(joint_map)) == joint_map
    assert read_joint_map(GOLDEN) == match_joints(figure("cmu"), bap_skeleton())


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"joint map": 2, "joints": []}',
        '{"joint map": 1}',
        '{"joint map": 1, "joints": [3]}',
        '{"joint map": 1, "joints": [{"source": "a", "targets": "b"}]}',
        '{"joint map": 1, "joints": [{"source": "a", "targets": ["b"]}, {"source": "a", "targets": ["c"]}]}',
        '{"joint map": 1, "joints": [{"source": "a", "targets": ["b", "b"]}]}',
        '{"joint map": 1, "joints": [], "columns": 7}',
        "[" * 100_000,
    ],
)
def test_what_is_no_map_is_refused(text):
    with pytest.raises(FormatError):
        read_joint_map(text.encode())


def test_map_cut_anywhere_ends_well():
    assert_every_prefix_ends_well(read_joint_map, write_joint_map(JointMap((("a", ("b", "c")), ("d", ())), ("e",))))


@given(damaged(GOLDEN))
def test_damaged_map_ends_well(data):
    assert_ends_well(read_joint_map, data)


@given(st.binary(max_size=200))
def test_noise_ends_well(data):
    assert_ends_well(read_joint_map, data)


@pytest.mark.parametrize("seed", range(8))
def test_a_tree_of_any_shape_gives_a_map_that_can_be_used(seed):
    random = np.random.default_rng(seed)
    joints, columns = [], []
    for number in range(200):
        columns += [Column(f"{number} r{a}", number, ColumnKind.ROTATION, a) for a in range(3)]
        parent = int(random.integers(0, number)) if number else -1
        offset = tuple(random.normal(0, 0.1, 3).tolist())
        joints.append(Joint(f"j{number}", parent, offset, (3 * number + 2, 3 * number + 1, 3 * number)))
    tree = Skeleton("tree", SkeletonKind.BVH, tuple(joints), (), tuple(columns), tuple(range(200)))
    for source, target in ((tree, bap_skeleton()), (bap_skeleton(), tree), (figure("cmu"), tree)):
        assert match_joints(source, target).checked(source, target).pairs


def test_map_of_other_joints_is_refused_by_name():
    with pytest.raises(FormatError, match="no joint of the target"):
        JointMap((("mixamorig:Hips", ("pelvis",)),)).checked(figure(), bap_skeleton())
    with pytest.raises(FormatError, match="no joint of the source"):
        cmu_62_map(figure(), bap_skeleton())


def test_map_is_plain_to_read():
    rows = json.loads(GOLDEN)["joints"]
    assert {"source": "lradius", "targets": ["l_elbow"]} in rows
