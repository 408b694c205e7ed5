"""The encoder that chooses a frame's indices together: against a twin in NumPy, on odd bodies, and on real motions."""

import numpy as np
import pytest

from qmd_studio.codecs.qmd import payload
from qmd_studio.codecs.qmd.decode import decode, decode_payload
from qmd_studio.codecs.qmd.encode import encode, encode_matrix
from qmd_studio.codecs.qmd.joint_choice import STIFFNESS
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.sensitivity import sensitivities
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import open_file
from tests.corpus import corpus_file, corpus_files
from tests.generated_motion import walker

PAPER, PLAIN = QmdSettings(encoder=Encoder.PAPER), QmdSettings(encoder=Encoder.PLAIN)


def orientation_error_deg(original, decoded):
    """Return the mean angle between all joints' orientations, in degrees."""
    ours, theirs = (world_from_joint(m.skeleton, m.X)[:, :, :3, :3] for m in (original, decoded))
    chord = np.linalg.norm(ours - theirs, axis=(2, 3))
    return np.degrees(2 * np.arcsin(chord / np.sqrt(8))).mean()


def chosen_by_twin(H, table, wanted, fdf):
    """Return one frame's levels and what the exact columns are to be off by: Babai's nearest plane in NumPy.

    `wanted` (m - fdf,) is what the decoder lacks in the indexed columns.
    """
    m = len(H)
    H = H + STIFFNESS * np.eye(m)
    halfway = (table[1:] + table[:-1]) * np.float32(0.5)
    inner = H[fdf:, fdf:] - H[fdf:, :fdf] @ np.linalg.solve(H[:fdf, :fdf], H[:fdf, fdf:])
    nearest = np.searchsorted(halfway, wanted)
    room = table[np.minimum(nearest + 1, len(table) - 1)] - table[np.maximum(nearest - 1, 0)]
    order = np.argsort(room * np.sqrt(np.diag(inner)), kind="stable")
    U = np.linalg.cholesky(inner[np.ix_(order, order)]).T
    levels, error = nearest.copy(), np.zeros(m - fdf)
    for a in range(m - fdf - 1, -1, -1):
        asked = U[a, a + 1 :] @ error[order[a + 1 :]] / U[a, a]
        j = order[a]
        levels[j] = np.searchsorted(halfway, np.float32(wanted[j] - asked))
        error[j] = float(table[levels[j]]) - float(wanted[j])
    plain = table[nearest].astype(float) - wanted
    if error @ inner @ error > plain @ inner @ plain:
        levels, error = nearest, plain
    return levels, -np.linalg.solve(H[:fdf, :fdf], H[:fdf, fdf:] @ error)


@pytest.mark.parametrize("fdf", [0, 2, 6, 20])
def test_indices_of_every_frame_are_those_of_the_twin(fdf):
    motion = walker(120)
    matrix = codec_matrix(motion)
    encoded = encode_matrix(matrix, motion.skeleton, QmdSettings(fdf=fdf))
    (segment,) = encoded.payload.segments
    poses = encoded.decoded.T
    all_H = sensitivities(motion.skeleton, matrix)
    same = []
    for row in range(len(matrix) - 1):
        wanted = matrix[row + 1, fdf:] - poses[row, fdf:]
        levels, moved = chosen_by_twin(all_H[row + 1], segment.table, wanted, fdf)
        same.append(np.mean(levels == segment.indices[row]))
        if same[-1] == 1.0:
            np.testing.assert_allclose(poses[row + 1, :fdf], matrix[row + 1, :fdf] + moved, rtol=1e-5, atol=1e-6)
    # a tie may fall either way by rounding, and all that is chosen after it differs then
    assert np.mean(np.array(same) == 1.0) > 0.95


def test_choice_by_joints_is_several_times_closer_than_by_columns_at_equal_bytes():
    motion = walker(343)
    plain, closed = encode(motion, PLAIN), encode(motion)
    assert len(plain.data) == len(closed.data)
    assert measure(motion, closed.decoded).def_ < measure(motion, plain.decoded).def_ / 2.5
    assert orientation_error_deg(motion, closed.decoded) < 1.2 * orientation_error_deg(motion, plain.decoded)


def test_draft_has_the_size_of_the_exact_choice_and_is_true_of_its_bytes():
    motion = walker(200)
    matrix, settings = codec_matrix(motion), QmdSettings(segment=70)
    draft = encode_matrix(matrix, motion.skeleton, settings, draft=True)
    exact = encode_matrix(matrix, motion.skeleton, settings)
    assert draft.payload.size == exact.payload.size
    packed = payload.pack(draft.payload)
    assert packed != payload.pack(exact.payload)
    assert np.array_equal(decode_payload(payload.unpack(memoryview(packed))), draft.decoded.T)


def test_payload_size_is_the_length_of_its_bytes():
    motion = walker(100)
    contents = encode_matrix(codec_matrix(motion), motion.skeleton, QmdSettings(3, 9, 40)).payload
    size = contents.size
    assert size.bytes == len(payload.pack(contents))
    assert size.bytes == sum((size.header_bytes, size.table_bytes, size.exact_bytes, size.index_bytes, size.pose_bytes))


def odd_bodies():
    turn, move, opaque = ColumnKind.ROTATION, ColumnKind.TRANSLATION, ColumnKind.OPAQUE
    root = Joint("root", -1, (0.0, 0.0, 0.0))
    lamps = tuple(Column(f"lamp {k}", 0, opaque, 0) for k in range(5))
    still = Skeleton("lamps", SkeletonKind.BVH, (root,), (), lamps, (0,))
    twin = Joint("twin", 0, (0.0, 0.0, 0.0), (0, 1, 2, 3))
    same_axis = tuple(Column(f"turn {k}", 1, turn, 1, sign) for k, sign in enumerate((1, -1, 1, 1)))
    dependent = Skeleton(
        "dependent", SkeletonKind.BVH, (root, twin), (EndSite("tip", 1, (0.0, 0.0, 1.0)),), same_axis, (2, 2)
    )
    two = Skeleton(
        "two roots", SkeletonKind.BVH,
        (root, Joint("other", -1, (5.0, 0.0, 0.0), (3,)), Joint("far", 1, (0.0, 2.0, 0.0))), (),
        (Column("x", 0, move, 0), Column("y", 1, move, 1, -1), Column("far x", 2, move, 0), Column("turn", 1, turn, 2)),
        (0, 2, 1),
    )  # fmt: skip
    unmeasured = Skeleton("unmeasured", SkeletonKind.BVH, two.joints, (), two.columns, ())
    return [still, dependent, two, unmeasured]


@pytest.mark.parametrize("skeleton", odd_bodies(), ids=lambda skeleton: skeleton.name)
@pytest.mark.parametrize("fdf", [0, 1, 3, 4])
def test_encode_of_an_odd_body_keeps_every_column_near(skeleton, fdf):
    random = np.random.default_rng(3)
    X = np.cumsum(random.normal(0, 0.02, (80, skeleton.n_columns)), axis=0)
    motion = Motion(skeleton, X, 30.0)
    encoded = encode(motion, QmdSettings(fdf=fdf))
    assert np.array_equal(decode(encoded.data).X, encoded.decoded.X)
    assert np.abs(encoded.decoded.X - X).max() < 0.02


@pytest.mark.parametrize("size", [1e-30, 1e8, 1e11])
def test_encode_of_wild_values_ends_with_finite_ones(size):
    motion = walker(40)
    wild = np.random.default_rng(2).normal(scale=size, size=motion.X.shape)
    decoded = decode(encode(motion.with_values(wild)).data)
    assert np.isfinite(decoded.X).all()


def test_encode_of_wild_values_that_move_nothing_ends_with_finite_ones():
    skeleton = odd_bodies()[0]
    wild = np.random.default_rng(2).normal(scale=1e25, size=(40, skeleton.n_columns))
    decoded = decode(encode(Motion(skeleton, wild, 30.0), QmdSettings(fdf=2)).data)
    np.testing.assert_allclose(decoded.X, wild, atol=3e24)


def test_encode_of_body_animation_parameters_is_closer_by_joints_than_by_columns():
    skeleton = bap_skeleton()
    phase = np.arange(60)[:, np.newaxis] / 60 + np.random.default_rng(6).random(skeleton.n_columns)
    motion = Motion(skeleton, 0.2 * np.sin(2 * np.pi * phase), 25.0)
    plain, closed = (encode(motion, QmdSettings(encoder=e)).decoded for e in (Encoder.PLAIN, Encoder.CLOSED))
    assert measure(motion, closed).def_ < measure(motion, plain).def_ / 2.5


@pytest.mark.corpus
@pytest.mark.parametrize(
    ("trial", "ratio", "def_", "limit_deg"),
    [("02_01", 200, 0.0025, 0.03), ("02_02", 400, 0.0035, 0.03), ("141_01", 120, 1, 0.045)],
)
def test_encode_of_captured_motion_meets_its_targets(trial, ratio, def_, limit_deg):
    motion = open_file(corpus_file(f"cmu_asfamc/{trial}.amc")).motion
    paper, closed = encode(motion, PAPER), encode(motion)
    error = measure(motion, closed.decoded)
    assert len(paper.data) == len(closed.data)
    assert error.def_ <= def_
    assert measure(motion, paper.decoded).def_ / error.def_ >= ratio
    assert error.max_mm <= 8.0
    assert orientation_error_deg(motion, closed.decoded) <= limit_deg


@pytest.mark.parametrize(
    "path", corpus_files("bvh/*walk*.bvh") + corpus_files("bap/vreng_nak.bap") + corpus_files("bvh/fairmotion*.bvh")
)
def test_encode_of_other_bodies_is_closer_by_joints_than_by_columns(path):
    motion = open_file(path).motion
    plain, closed = (encode(motion, QmdSettings(encoder=e)).decoded for e in (Encoder.PLAIN, Encoder.CLOSED))
    assert measure(motion, closed).def_ < measure(motion, plain).def_
