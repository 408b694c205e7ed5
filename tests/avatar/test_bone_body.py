"""What holds for the body of every skeleton, usual or strange."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.avatar.bone_body import MAX_FACES, bone_body
from qmd_studio.avatar.bone_body_plan import plan_body
from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.skeleton import EndSite, Joint, Skeleton, SkeletonKind
from tests.corpus import corpus_files

MOTIONS = [*corpus_files("bvh/*.bvh"), *corpus_files("cmu_asfamc/*.asf"), *corpus_files("other_asfamc/*.asf")]

STUMPS = ("pybvh_full_precision_frame_time.bvh", "pybvh_rotation_first_root.bvh")


def skeleton_of(*joints: Joint, sites: tuple[EndSite, ...] = ()) -> Skeleton:
    return Skeleton("made up", SkeletonKind.BVH, joints, sites, (), tuple(range(len(joints))))


def figure(scale: float = 1.0, *, turn=lambda v: v, name=lambda n: n) -> Skeleton:
    rows = (
        ("Hips", -1, (0.0, 0.95, 0.0)),
        ("Spine", 0, (0.0, 0.12, 0.0)),
        ("Chest", 1, (0.0, 0.2, 0.0)),
        ("Head", 2, (0.0, 0.34, 0.02)),
        ("LeftShoulder", 2, (0.05, 0.15, 0.0)),
        ("LeftArm", 4, (0.15, 0.02, 0.0)),
        ("LeftForeArm", 5, (0.29, 0.0, 0.0)),
        ("LeftHand", 6, (0.26, 0.0, 0.0)),
        ("RightShoulder", 2, (-0.05, 0.15, 0.0)),
        ("RightArm", 8, (-0.15, 0.02, 0.0)),
        ("RightForeArm", 9, (-0.29, 0.0, 0.0)),
        ("RightHand", 10, (-0.26, 0.0, 0.0)),
        ("LeftUpLeg", 0, (0.1, -0.04, 0.0)),
        ("LeftLeg", 12, (0.0, -0.42, 0.0)),
        ("LeftFoot", 13, (0.0, -0.42, 0.0)),
        ("RightUpLeg", 0, (-0.1, -0.04, 0.0)),
        ("RightLeg", 15, (0.0, -0.42, 0.0)),
        ("RightFoot", 16, (0.0, -0.42, 0.0)),
    )

    def place(vector):
        return tuple(float(scale * v) for v in turn(vector))

    joints = tuple(Joint(name(n), parent, place(offset)) for n, parent, offset in rows)
    sites = (
        EndSite("crown", 3, place((0.0, 0.16, 0.0))),
        EndSite("left toe", 14, place((0.0, -0.05, 0.15))),
        EndSite("right toe", 17, place((0.0, -0.05, 0.15))),
    )
    return skeleton_of(*joints, sites=sites)


def check(body: Body, *, faces: int = MAX_FACES) -> None:
    """What must hold of any body."""
    surface, n_joints = body.surface, len(body.skeleton.joints)
    n = len(surface.vertices)
    assert 0 < len(surface.faces) <= faces
    for array in (surface.vertices, surface.normals, surface.colours, surface.weights, body.bind):
        assert np.isfinite(array).all()
    assert surface.normals.shape == surface.colours.shape == (n, 3)
    assert surface.joints.shape == surface.weights.shape == (n, 4)
    assert surface.faces.min() >= 0
    assert surface.faces.max() < n
    assert surface.joints.min() >= 0
    assert surface.joints.max() < n_joints
    assert surface.weights.min() >= -1e-6
    np.testing.assert_allclose(surface.weights.sum(axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, atol=1e-4)
    check_closed(surface.faces)
    check_bounds(body)
    check_carriers(body)


def check_closed(faces: np.ndarray) -> None:
    """Every edge belongs to two triangles that run along it in opposite directions."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = np.sort(edges[:, 0] * (faces.max() + 1) + edges[:, 1])
    back = np.sort(edges[:, 1] * (faces.max() + 1) + edges[:, 0])
    np.testing.assert_array_equal(there, back)
    assert len(np.unique(there)) == len(there)


def check_bounds(body: Body) -> None:
    """Flesh is near bones: within a quarter of the figure's size."""
    plan = plan_body(body.skeleton)
    size = max(float(np.linalg.norm(np.ptp(plan.nodes, axis=0))), 1.75 * plan.unit)
    assert (body.surface.vertices >= plan.nodes.min(axis=0) - 0.4 * size).all()
    assert (body.surface.vertices <= plan.nodes.max(axis=0) + 0.4 * size).all()


def check_carriers(body: Body) -> None:
    """Every joint that has a bone carries some of the body."""
    plan = plan_body(body.skeleton)
    carrying = set(np.unique(body.surface.joints[body.surface.weights > 1e-3]).tolist())
    for joint, children in enumerate(plan.children):
        long = [c for c in children if np.linalg.norm(plan.nodes[c] - plan.nodes[joint]) > 0.005 * plan.unit]
        assert not long or joint in carrying, body.skeleton.joints[joint].name


@pytest.mark.parametrize("path", MOTIONS)
def test_every_skeleton_of_the_corpus_gets_a_sound_body(path):
    from qmd_studio.registry import open_file

    check(bone_body(open_file(path).skeleton))


@pytest.mark.parametrize("path", [motion for motion in MOTIONS if motion.id not in STUMPS])
def test_every_figure_of_the_corpus_has_head_arms_and_legs(path):
    from qmd_studio.registry import open_file

    plan = plan_body(open_file(path).motion.skeleton)
    assert plan.head is not None
    assert sorted(limb.side for limb in plan.arms) == [-1, 1]
    assert sorted(limb.side for limb in plan.legs) == [-1, 1]
    assert all(limb.upper and limb.lower for limb in (*plan.arms, *plan.legs))
    assert 0.6 < plan.unit < 1.4


@pytest.mark.parametrize("scale", [1.0, 0.01, 40.0])
def test_body_scales_with_its_skeleton(scale):
    body = bone_body(figure(scale))
    check(body)
    np.testing.assert_allclose(body.surface.vertices / scale, bone_body(figure()).surface.vertices, atol=2e-3)


def test_soles_are_flat_and_toes_point_forward():
    body = bone_body(figure())
    left_foot = np.isin(body.surface.joints[:, 0], [14])
    foot = body.surface.vertices[left_foot]
    sole = foot[foot[:, 1] < foot[:, 1].min() + 0.004]
    assert len(sole) > 20
    assert np.ptp(sole[:, 2]) > 0.18
    assert sole[:, 2].max() > 0.1 > -sole[:, 2].min()


def test_face_looks_forward_and_head_stands_over_the_neck():
    body = bone_body(figure())
    eyes = body.surface.vertices[body.surface.colours.max(axis=1) < 0.05]
    assert len(eyes) > 10
    assert eyes[:, 2].min() > 0.05
    assert abs(float(eyes[:, 0].mean())) < 1e-3
    assert body.surface.vertices[:, 1].max() == pytest.approx(1.77, abs=0.02)


def test_torso_is_wider_than_deep_and_left_mirrors_right():
    vertices = bone_body(figure()).surface.vertices
    trunk = vertices[(vertices[:, 1] > 1.15) & (vertices[:, 1] < 1.3)]
    assert 0.24 < np.ptp(trunk[:, 0]) < 0.42
    assert 0.15 < np.ptp(trunk[:, 2]) < 0.28
    mirrored = vertices * (-1, 1, 1)
    np.testing.assert_allclose(mirrored.min(axis=0), vertices.min(axis=0), atol=1e-3)
    np.testing.assert_allclose(mirrored.mean(axis=0), vertices.mean(axis=0), atol=1e-3)


def test_names_without_meaning_are_read_from_the_tree():
    number = iter(range(100))
    plan = plan_body(figure(name=lambda n: f"b{next(number):02d}"))
    assert plan.head == 3
    assert {(arm.side, arm.end) for arm in plan.arms} == {(1, 7), (-1, 11)}
    assert {(leg.side, leg.end) for leg in plan.legs} == {(1, 14), (-1, 17)}


def test_figure_along_z_stands_along_z():
    plan = plan_body(figure(turn=lambda v: (v[0], -v[2], v[1])))
    np.testing.assert_allclose(plan.up, (0, 0, 1), atol=1e-9)
    np.testing.assert_allclose(plan.forward, (0, -1, 0), atol=1e-9)
    check(bone_body(figure(turn=lambda v: (v[0], -v[2], v[1]))))


def test_fingers_get_bones_of_their_own():
    joints = list(figure().joints)
    for hand, side, sign in ((7, "Left", 1), (11, "Right", -1)):
        for k, finger in enumerate(("Thumb", "Index", "Middle", "Ring", "Pinky")):
            across = 0.035 - 0.022 * k
            parent = hand
            for bone in range(3):
                step = (0.03 if bone else 0.085, 0.0, 0.0 if bone else across)
                joints.append(Joint(f"{side}Hand{finger}{bone + 1}", parent, (sign * step[0], 0.0, step[2])))
                parent = len(joints) - 1
    body = bone_body(skeleton_of(*joints))
    check(body)
    carrying = set(np.unique(body.surface.joints[body.surface.weights > 0.5]).tolist())
    assert carrying >= set(range(18, len(joints)))


@pytest.mark.parametrize(
    "skeleton",
    [
        skeleton_of(Joint("only", -1, (0.0, 0.0, 0.0))),
        skeleton_of(Joint("a", -1, (0.0, 0.0, 0.0)), Joint("b", 0, (0.0, 0.0, 0.0))),
        skeleton_of(Joint("Hips", -1, (0.0, 1.0, 0.0)), Joint("Head", 0, (0.0, 0.6, 0.0))),
        skeleton_of(
            Joint("Hips", -1, (0.0, 1.0, 0.0)),
            Joint("LeftHand", 0, (0.5, 0.0, 0.0)),
            Joint("RightHand", 0, (-0.5, 0, 0)),
        ),
        skeleton_of(*[Joint(f"link {k}", k - 1, (0.1, 0.02 * k, 0.0)) for k in range(60)]),
        skeleton_of(*[Joint("Left" * (k % 2) + "Hand", k - 1, (0.0, 0.0, 0.0)) for k in range(9)]),
    ],
    ids=["one", "no length", "two", "hands only", "chain", "many hands"],
)
def test_strange_skeleton_gets_a_sound_body(skeleton):
    check(bone_body(skeleton))


ARMS = ["LeftArm", "RightArm", "LeftHand", "RightHand", "LeftThumb", "l_wrist"]
LEGS = ["LeftUpLeg", "LeftFoot", "RightFoot", "RightLeg", "r_ankle"]
NAMES = st.sampled_from(["Hips", "Spine", "Neck", "Head", "bone", *ARMS, *LEGS])
LENGTHS = st.sampled_from([0.0, 0.0, 0.1, -0.1, 0.4, -0.4, 1e-7])


@st.composite
def trees(draw):
    n = draw(st.integers(1, 24))
    joints = []
    for k in range(n):
        parent = draw(st.integers(0, k - 1)) if k else -1
        joints.append(Joint(draw(NAMES), parent, (draw(LENGTHS), draw(LENGTHS), draw(LENGTHS))))
    sites = tuple(
        EndSite("end", draw(st.integers(0, n - 1)), (0.0, draw(LENGTHS), 0.0)) for _ in range(draw(st.integers(0, 4)))
    )
    return skeleton_of(*joints, sites=sites)


@settings(max_examples=60, deadline=None)
@given(trees())
def test_any_tree_gets_a_finite_closed_body(skeleton):
    surface = bone_body(skeleton).surface
    assert np.isfinite(surface.vertices).all()
    assert np.isfinite(surface.normals).all()
    np.testing.assert_allclose(surface.weights.sum(axis=1), 1.0, atol=1e-5)
    check_closed(surface.faces)
