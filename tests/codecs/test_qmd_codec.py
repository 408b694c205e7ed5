"""Motions to QMD files and back: the paper's errors, the closed loop's, the edges of the settings, and two twins."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.qmd import payload
from qmd_studio.codecs.qmd.decode import decode, decode_payload
from qmd_studio.codecs.qmd.encode import encode, encode_matrix
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import open_file, save_motion
from tests.codecs import foreign_decoder
from tests.codecs.plain_qmd import encode_plainly
from tests.codecs.tiny_motions import pendulum
from tests.corpus import corpus_file
from tests.generated_motion import walker

PAPER, CLOSED = QmdSettings(encoder=Encoder.PAPER), QmdSettings(encoder=Encoder.CLOSED)
LEVELS = (1, 1, 2, 3, 3, 6)
SIX_COLUMNS = Skeleton(
    "six", SkeletonKind.BVH, (Joint("root", -1, (0.0, 0.0, 0.0)),), (),
    tuple(Column(f"c{k}", 0, ColumnKind.OPAQUE, 0, level=level) for k, level in enumerate(LEVELS)), (0,),
)  # fmt: skip
BY_COLUMN = (Encoder.PAPER, Encoder.PLAIN)
"""The encoders that treat each column by itself."""


def displacement_error(original, decoded):
    """DEF, worked out here from its definition: the norm over all points, averaged over frames, in ASF units."""
    error = point_positions(original.skeleton, original.X) - point_positions(decoded.skeleton, decoded.X)
    return float(np.mean([math.sqrt(float((frame**2).sum())) for frame in error])) / ASF_UNIT_M


@cache
def short_walk(n_frames=40):
    return walker(n_frames)


@pytest.mark.corpus
@pytest.mark.parametrize(("trial", "published"), [("02_01", 0.480), ("02_02", 1.474), ("05_03", 27.39)])
def test_encode_of_a_motion_of_the_paper_gives_its_error_and_the_closed_loop_a_thirtieth(trial, published):
    motion = open_file(corpus_file(f"cmu_asfamc/{trial}.amc")).motion
    paper = displacement_error(motion, decode(encode(motion, PAPER).data))
    closed = displacement_error(motion, decode(encode(motion, CLOSED).data))
    assert paper == pytest.approx(published, rel=0.03)
    assert closed < paper / 30


@pytest.mark.corpus
def test_encode_of_the_paper_s_optimum_for_dance_gives_its_size_and_error():
    motion = open_file(corpus_file("cmu_asfamc/05_03.amc")).motion
    encoded = encode(motion, QmdSettings(fdf=1, bits=8, segment=150, encoder=Encoder.PAPER))
    assert encoded.size.bytes / 1024 == pytest.approx(30.8, abs=0.15)
    assert displacement_error(motion, encoded.decoded) == pytest.approx(21, rel=0.05)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_encode_of_a_generated_walk_is_thirty_times_closer_in_the_closed_loop(seed):
    motion = walker(343, seed=seed)
    paper, closed = encode(motion, PAPER), encode(motion, CLOSED)
    assert len(paper.data) == len(closed.data)
    assert displacement_error(motion, closed.decoded) < displacement_error(motion, paper.decoded) / 30


def test_encode_error_of_the_closed_loop_does_not_grow_with_length():
    motion = walker(2000)
    decoded = encode(motion, CLOSED).decoded
    first, last = slice(0, 500), slice(1500, 2000)
    assert np.abs(decoded.X - motion.X)[last].mean() < 2 * np.abs(decoded.X - motion.X)[first].mean()


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n_frames=st.integers(1, 90),
    fdf=st.integers(0, 6),
    bits=st.sampled_from((8, 9, 12)),
    segment=st.sampled_from((0, 1, 7, 30, 64, 200)),
    encoder=st.sampled_from(BY_COLUMN),
    buckets=st.sampled_from(Buckets),
    k=st.sampled_from((0.0, 1.0, 2.5, math.inf)),
    spread=st.sampled_from((0.0, 1e-5, 0.01, 3.0, 1e6)),
)
def test_encode_gives_the_bytes_of_the_plain_twin(seed, n_frames, fdf, bits, segment, encoder, buckets, k, spread):
    random = np.random.default_rng(seed)
    matrix = np.cumsum(random.standard_cauchy((n_frames, 6)) * spread, axis=0).astype(np.float32)
    chosen = QmdSettings(fdf, bits, segment, encoder, k, buckets=buckets).checked(6, n_frames - 1)
    fast = encode_matrix(matrix, SIX_COLUMNS, chosen)
    plain, decoded = encode_plainly(matrix, np.array(LEVELS), chosen)
    packed = payload.pack(fast.payload)
    assert packed == payload.pack(plain)
    assert len(packed) == payload_size(n_frames - 1, 6, fdf, bits, chosen.segment).bytes
    assert np.array_equal(fast.decoded.T, decoded)
    assert np.array_equal(decode_payload(payload.unpack(memoryview(packed))), decoded)


@pytest.mark.parametrize("encoder", Encoder)
@pytest.mark.parametrize(("fdf", "bits", "segment"), [(6, 8, 0), (0, 9, 10), (62, 16, 0), (61, 16, 13), (1, 12, 39)])
def test_decode_by_a_stranger_s_decoder_gives_the_same_motion(encoder, fdf, bits, segment):
    motion = short_walk()
    encoded = encode(motion, QmdSettings(fdf, bits, segment, encoder))
    fps, poses, block = foreign_decoder.decode(encoded.data)
    ours = decode(encoded.data)
    assert fps == ours.fps == 120.0
    assert np.array_equal(codec_matrix(ours), np.array(poses, np.float32))
    assert block["name"] == motion.name
    assert [column["name"] for column in block["skeleton"]["columns"]] == [c.name for c in motion.skeleton.columns]
    assert encoded.size.bytes + 64 + encoded.skeleton_bytes == len(encoded.data)


@pytest.mark.parametrize("encoder", BY_COLUMN)
@pytest.mark.parametrize("n_frames", [40, 1500], ids=["a short motion", "one long enough for compiled code"])
def test_decode_gives_the_rows_of_the_plain_twin(encoder, n_frames):
    motion = walker(n_frames)
    chosen = QmdSettings(segment=700, bits=9, encoder=encoder).checked(62, n_frames - 1)
    contents, rows = encode_plainly(codec_matrix(motion), np.array(motion.skeleton.levels), chosen)
    assert np.array_equal(decode_payload(payload.unpack(memoryview(payload.pack(contents)))), rows)


@pytest.mark.parametrize("n_frames", [40, 1500])
def test_decode_gives_the_very_motion_that_encode_reports(n_frames):
    motion = walker(n_frames)
    encoded = encode(motion, CLOSED)
    decoded = decode(encoded.data)
    assert decoded.skeleton == motion.skeleton
    assert decoded.name == motion.name
    assert np.array_equal(decoded.X, encoded.decoded.X)


def test_encode_with_all_columns_fixed_is_the_motion_to_float32():
    motion = short_walk()
    decoded = encode(motion, QmdSettings(fdf=62)).decoded
    np.testing.assert_allclose(decoded.X, motion.X, rtol=1e-6, atol=1e-7)


def test_encode_of_one_frame_keeps_its_pose():
    motion = walker(1)
    encoded = encode(motion, CLOSED)
    assert encoded.size.bytes == 13 + 4 * 256 + 4 * 62
    assert len(foreign_decoder.decode(encoded.data)[1]) == 1
    np.testing.assert_allclose(decode(encoded.data).X, motion.X, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("encoder", Encoder)
@pytest.mark.parametrize("bits", [8, 16])
def test_encode_of_a_motion_that_stands_still_stands_still(encoder, bits):
    motion = short_walk()
    still = motion.with_values(np.repeat(motion.X[:1], 50, axis=0))
    decoded = encode(still, QmdSettings(bits=bits, encoder=encoder)).decoded
    assert np.array_equal(decoded.X, np.repeat(decoded.X[:1], 50, axis=0))


def test_encode_with_lengths_in_any_unit_holds_asf_units():
    motion = short_walk()
    _, poses, _ = foreign_decoder.decode(encode(motion, QmdSettings(fdf=62)).data)
    np.testing.assert_allclose(poses[7][:3], motion.X[7, :3] / 0.0564444, rtol=1e-5)
    np.testing.assert_allclose(poses[7][3:], motion.X[7, 3:], rtol=1e-4, atol=1e-6)


def test_encode_with_a_large_k_comes_to_selective_averaging():
    def encoded(k):
        return encode(short_walk(), QmdSettings(encoder=Encoder.PAPER, k=k))

    selective = encoded(math.inf).decoded.X
    assert np.array_equal(encoded(5000.0).decoded.X, selective)
    np.testing.assert_allclose(encoded(900.0).decoded.X, selective, atol=1e-6)
    assert np.abs(encoded(1.0).decoded.X - selective).max() > 1e-3


def test_encode_twice_gives_the_same_bytes():
    assert encode(walker(60), CLOSED).data == encode(walker(60), CLOSED).data


def test_encode_keeps_the_mask_of_body_animation_parameters():
    skeleton = bap_skeleton()
    random = np.random.default_rng(4)
    X = np.cumsum(random.normal(0, 0.01, (30, skeleton.n_columns)), axis=0)
    mask = random.random(X.shape) < 0.7
    mask[:, 5], mask[:, 6] = True, False
    decoded = decode(encode(Motion(skeleton, X, 25.0, "wave", mask)).data)
    assert np.array_equal(decoded.mask, mask)
    assert decoded.skeleton == skeleton
    assert decoded.fps == 25.0


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"fdf": 63}, "FDF"),
        ({"fdf": -1}, "FDF"),
        ({"bits": 7}, "b is"),
        ({"bits": 17}, "b is"),
        ({"segment": -1}, "n_d"),
        ({"rqt": 0}, "RQT"),
        ({"k": -0.5}, "k is"),
        ({"k": math.nan}, "k is"),
        ({"max_error_mm": 0.0}, "bound"),
        ({"max_error_mm": math.inf}, "bound"),
    ],
)
def test_encode_with_settings_out_of_range_says_which(wrong, said):
    with pytest.raises(CodecError, match=said):
        encode(short_walk(), QmdSettings(**wrong))


def test_encode_of_a_value_beyond_float32_says_where():
    motion = pendulum()
    X = motion.X.copy()
    X[3, 2] = 1e200
    with pytest.raises(CodecError) as caught:
        encode(motion.with_values(X))
    assert caught.value.at == "frame 3, column lamp"


def test_decode_without_any_skeleton_says_what_to_give():
    motion = short_walk()
    bare = encode(motion, with_skeleton=False).data
    with pytest.raises(FormatError, match="no skeleton") as caught:
        decode(bare)
    assert "--skeleton" in caught.value.hint
    assert decode(bare, motion.skeleton).skeleton == motion.skeleton
    with pytest.raises(FormatError, match="does not fit"):
        decode(bare, bap_skeleton())


def test_describe_says_what_the_file_was_made_with():
    said = describe(encode(short_walk(), QmdSettings(3, 10, 15, Encoder.PAPER, 2.0, 5000)).data)
    wanted = {"frames": 40, "dofs": 62, "fdf": 3, "bits": 10, "segment": 15, "segments": 3, "encoder": "paper"}
    assert {key: said[key] for key in wanted} == wanted
    assert (said["k"], said["rqt"], said["fps"], said["buckets"]) == (2.0, 5000, 120.0, "frequency")
    assert said["max_error_mm"] == math.inf
    assert said["payload_bytes"] == payload_size(39, 62, 3, 10, 15).bytes
    assert said["bytes"] == 64 + said["payload_bytes"] + said["skeleton_bytes"]


@pytest.mark.parametrize("encoder", Encoder)
@pytest.mark.parametrize("buckets", Buckets)
def test_describe_names_the_encoder_and_its_buckets(encoder, buckets):
    said = describe(encode(short_walk(), QmdSettings(encoder=encoder, buckets=buckets, max_error_mm=2.5)).data)
    assert said["encoder"] == encoder
    assert said["buckets"] == (buckets if encoder is Encoder.PAPER else "frequency")
    assert said["max_error_mm"] == (2.5 if encoder is Encoder.BOUNDED else math.inf)
    assert said["k"] == math.inf


def test_open_file_of_a_saved_motion_plays_it(tmp_path):
    motion = short_walk()
    save_motion(tmp_path / "walk.qmd", motion)
    loaded = open_file(tmp_path / "walk.qmd")
    assert loaded.skeleton == motion.skeleton
    np.testing.assert_allclose(loaded.motion.X, motion.X, atol=0.02)


def test_encode_of_a_skeleton_that_no_reader_would_take_is_refused():
    motion = short_walk()
    endless = replace(motion.skeleton, name="x" * (1 << 20))
    with pytest.raises(CodecError, match="too large"):
        encode(replace(motion, skeleton=endless))
    assert decode(encode(replace(motion, skeleton=endless), with_skeleton=False).data, endless).n_frames == 40


def test_decode_of_a_mask_that_turns_over_at_every_value_keeps_it():
    skeleton = bap_skeleton()
    X = np.zeros((60, skeleton.n_columns))
    mask = np.indices(X.shape).sum(axis=0) % 2 == 0
    assert np.array_equal(decode(encode(Motion(skeleton, X, 25.0, "flicker", mask)).data).mask, mask)
