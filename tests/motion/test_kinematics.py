"""Every path of forward kinematics gives the poses that the skeleton's formula spells out, however it gets there."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from qmd_studio.errors import FormatError
from qmd_studio.motion import fast_kinematics as fast
from qmd_studio.motion import kinematics as plain
from qmd_studio.motion.fast_metrics import measure_positions
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import open_file
from tests.corpus import corpus_file
from tests.generated_motion import walker

HUNDREDTH_MM = 1e-5


def twin(skeleton, row):
    """Return the 4 × 4 pose of every joint and the place of every node for one row of X, straight from the formula."""
    poses = []
    for joint in skeleton.joints:
        move, turn = np.eye(4), np.eye(4)
        move[:3, 3] = joint.offset
        turn[:3, :3] = joint.orientation
        for column, value in zip(skeleton.columns, row, strict=True):
            if column.kind is ColumnKind.TRANSLATION and skeleton.joints[column.joint] is joint:
                move[column.axis, 3] += column.sign * (value - column.rest)
        for index in joint.product:
            column = skeleton.columns[index]
            own = np.eye(4)
            own[:3, :3] = Rotation.from_rotvec(column.sign * row[index] * np.eye(3)[column.axis]).as_matrix()
            turn = turn @ own
        outer = poses[joint.parent] if joint.parent >= 0 else np.eye(4)
        poses.append(outer @ move @ turn)
    places = [pose[:3, 3] for pose in poses]
    places += [(poses[site.joint] @ [*site.offset, 1.0])[:3] for site in skeleton.end_sites]
    return np.array(poses), np.array(places)


@st.composite
def skeletons(draw):
    """Trees of up to six joints, some with two roots: turns in any order and sense, moves, bones of no length."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    joints, columns = [], []
    for index in range(draw(st.integers(1, 6))):
        turning = list(random.permutation(3)[: random.integers(0, 4)])
        first = len(columns)
        columns += [
            Column(f"{index} r{a}", index, ColumnKind.ROTATION, int(a), int(random.choice([1, -1]))) for a in turning
        ]
        product = tuple(int(k) for k in random.permutation(np.arange(first, len(columns))))
        for a in range(3):
            if random.random() < 0.3:
                sign, rest = int(random.choice([1, -1])), float(random.normal())
                columns.append(Column(f"{index} t{a}", index, ColumnKind.TRANSLATION, a, sign, rest=rest))
        if random.random() < 0.2:
            columns.append(Column(f"{index} extension", index, ColumnKind.OPAQUE, 0))
        offset = tuple(random.normal(size=3).tolist()) if random.random() < 0.7 else (0.0, 0.0, 0.0)
        turned = Rotation.random(rng=random).as_matrix() if random.random() < 0.5 else np.eye(3)
        orientation = tuple(tuple(line) for line in turned.tolist())
        joints.append(Joint(str(index), int(random.integers(-1, index)) if index else -1, offset, product, orientation))
    sites = [EndSite(f"end {k}", int(random.integers(len(joints))), tuple(random.normal(size=3))) for k in range(3)]
    points = random.permutation(len(joints) + 3)[: random.integers(1, len(joints) + 4)]
    return Skeleton(
        "made up", SkeletonKind.BVH, tuple(joints), tuple(sites), tuple(columns), tuple(int(k) for k in points)
    )


@settings(max_examples=60, deadline=None)
@given(skeleton=skeletons(), seed=st.integers(0, 2**32 - 1), n_frames=st.sampled_from([1, 2, 63, 64, 65, 130]))
def test_all_paths_agree_with_the_formula_on_any_skeleton(skeleton, seed, n_frames):
    X = np.random.default_rng(seed).normal(scale=3.0, size=(n_frames, skeleton.n_columns))
    poses, places = twin(skeleton, X[-1])
    points = list(skeleton.points)
    np.testing.assert_allclose(plain.world_from_joint(skeleton, X)[-1], poses, atol=1e-11)
    np.testing.assert_allclose(plain.node_positions(skeleton, X)[-1], places, atol=1e-11)
    np.testing.assert_allclose(fast.world_from_joint_fast(skeleton, X), plain.world_from_joint(skeleton, X), atol=1e-11)
    wanted = plain.node_positions(skeleton, X)
    np.testing.assert_allclose(fast.point_positions_64(skeleton, X), wanted[:, points], atol=1e-11)
    Xt = fast.columns_first(X)
    np.testing.assert_allclose(unrolled(fast.node_positions_32(skeleton, Xt)), wanted, atol=1e-4)
    np.testing.assert_allclose(unrolled(fast.point_positions_32(skeleton, Xt)), wanted[:, points], atol=1e-4)


def unrolled(rows):
    """Return positions (n_frames, n, 3) of rows (3 * n, n_frames)."""
    return rows.T.reshape(rows.shape[1], -1, 3)


@pytest.mark.corpus
@pytest.mark.parametrize("name", ["60_01", "02_01", "49_08"])
def test_single_precision_stays_within_a_hundredth_of_a_millimetre_on_real_motion(name):
    motion = open_file(corpus_file(f"cmu_asfamc/{name}.amc")).motion
    if name == "60_01":
        assert np.degrees(np.abs(motion.X[:, 3:]).max()) > 1100  # turns that only count modulo a full one
    positions = unrolled(fast.point_positions_32(motion.skeleton, fast.columns_first(motion.X)))
    exact = plain.point_positions(motion.skeleton, motion.X)
    assert np.linalg.norm(positions - exact, axis=2).max() < HUNDREDTH_MM


def test_single_precision_stays_within_a_hundredth_of_a_millimetre_on_a_generated_walk():
    motion = walker(343)
    turned = motion.with_values(
        motion.X + 2 * np.pi * np.arange(-31, 31)
    )  # whole turns change nothing but the rounding
    exact = plain.point_positions(motion.skeleton, motion.X)
    shift = np.arange(-31, -28) * 2 * np.pi
    positions = unrolled(fast.point_positions_32(motion.skeleton, fast.columns_first(motion.X)))
    assert np.linalg.norm(positions - exact, axis=2).max() < HUNDREDTH_MM
    far = unrolled(fast.point_positions_32(motion.skeleton, fast.columns_first(turned.X))) - shift
    assert np.linalg.norm(far - exact, axis=2).max() < 30 * HUNDREDTH_MM  # float32 itself is that coarse at 31 turns


def test_inputs_are_not_changed_and_calls_do_not_disturb_each_other():
    motion = walker(100)
    Xt = fast.columns_first(motion.X)
    kept = Xt.copy()
    first = fast.point_positions_32(motion.skeleton, Xt)
    again = first.copy()
    fast.node_positions_32(motion.skeleton, Xt)
    fast.point_positions_32(motion.skeleton, Xt * np.float32(0.5))
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(Xt, kept)


@pytest.mark.parametrize("n_frames", [1, 2, 343])
def test_fast_measure_equals_the_plain_one(n_frames):
    motion = walker(n_frames)
    decoded = motion.with_values(motion.X + np.random.default_rng(3).normal(scale=1e-3, size=motion.X.shape))
    ours, theirs = (fast.point_positions_32(motion.skeleton, fast.columns_first(m.X)) for m in (motion, decoded))
    error, exact = measure_positions(motion.skeleton, ours, theirs, fps=motion.fps), measure(motion, decoded)
    assert (error.worst_joint, error.worst_frame) == (exact.worst_joint, exact.worst_frame)
    wanted, got = exact.as_json(), error.as_json()
    for name in ("def", "mean_mm", "p99_mm", "max_mm", "velocity_mm_s", "acceleration_mm_s2"):
        assert got[name] == pytest.approx(wanted[name], rel=1e-3), name
    np.testing.assert_allclose(error.distance_mm, exact.distance_mm, atol=2e-3)


def test_fast_measure_refuses_other_shapes():
    motion = walker(5)
    rows = fast.point_positions_32(motion.skeleton, fast.columns_first(motion.X))
    with pytest.raises(FormatError):
        measure_positions(motion.skeleton, rows, rows[:, :4], fps=30)
    with pytest.raises(FormatError):
        measure_positions(motion.skeleton, rows[:-3], rows[:-3], fps=30)


BVH_BONES = {
    "LowerBack": "lowerback", "Spine": "upperback", "Spine1": "thorax", "Neck": "lowerneck", "Neck1": "upperneck",
    "Head": "head", "Hips": "root",
    **{
        f"{long}{part}": f"{short}{bone}"
        for long, short in (("Left", "l"), ("Right", "r"))
        for part, bone in (
            ("UpLeg", "femur"), ("Leg", "tibia"), ("Foot", "foot"), ("ToeBase", "toes"), ("Shoulder", "clavicle"),
            ("Arm", "humerus"), ("ForeArm", "radius"), ("Hand", "wrist"), ("FingerBase", "hand"),
        )
    },
    "LFingers": "lfingers", "RFingers": "rfingers", "LThumb": "lthumb", "RThumb": "rthumb",
}  # fmt: skip


@pytest.mark.corpus
def test_acclaim_take_moves_as_the_bvh_of_the_same_take():
    amc = open_file(corpus_file("cmu_asfamc/01_01.amc")).motion
    bvh = open_file(corpus_file("bvh/fairmotion_01_01.bvh")).motion
    unit = amc.skeleton.metres_per_unit
    bvh = bvh.scaled(unit / bvh.skeleton.metres_per_unit)  # the same file unit in both
    assert bvh.n_frames == amc.n_frames + 1  # the first frame of the BVH is a reference pose
    frames = np.arange(0, amc.n_frames, 137)
    rest = plain.world_from_joint(amc.skeleton, np.zeros((1, amc.skeleton.n_columns)))[0, :, :3, :3]
    ours = plain.world_from_joint(amc.skeleton, amc.X[frames])
    theirs = plain.world_from_joint(with_lengths(bvh.skeleton, amc.skeleton), bvh.X[frames + 1])
    for bvh_name, bone in BVH_BONES.items():
        j, k = bvh.skeleton.joint_index(bvh_name), amc.skeleton.joint_index(bone)
        turned = ours[:, k, :3, :3] @ rest[k].T  # a bone's turn against its rest, in the world's axes
        np.testing.assert_allclose(theirs[:, j, :3, :3], turned, atol=2e-5, err_msg=bone)
        np.testing.assert_allclose(theirs[:, j, :3, 3], ours[:, k, :3, 3], atol=1e-4 * unit, err_msg=bone)


def with_lengths(bvh, asf):
    """Return the BVH's skeleton with the lengths of thorax and wrist bones, which the converter dropped, put back."""
    rest = plain.world_from_joint(asf, np.zeros((1, asf.n_columns)))[0, :, :3, 3]
    joints = list(bvh.joints)
    for name in ("Neck", "LeftShoulder", "RightShoulder", "LeftFingerBase", "RightFingerBase", "LThumb", "RThumb"):
        index, bone = bvh.joint_index(name), asf.joint_index(BVH_BONES[name])
        assert joints[index].offset == (0.0, 0.0, 0.0)
        vector = rest[bone] - rest[asf.joints[bone].parent]
        joints[index] = replace(joints[index], offset=tuple(vector.tolist()))
    return replace(bvh, joints=tuple(joints))


def test_moving_one_column_moves_only_what_hangs_from_it():
    motion = walker(2)
    skeleton = motion.skeleton
    bent = motion.X.copy()
    bent[1] = bent[0]
    column = next(k for k, c in enumerate(skeleton.columns) if c.name == "lhumerus.rz")
    bent[1, column] += 0.5
    before, after = fast.point_positions_64(skeleton, bent)
    moved = {
        name for name, far in zip(skeleton.point_names, np.abs(after - before).max(axis=1) > 1e-9, strict=True) if far
    }
    assert moved == {"lradius", "lwrist", "lhand", "lfingers", "lfingers_end", "lthumb_end"}
