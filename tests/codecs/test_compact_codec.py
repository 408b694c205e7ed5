"""The compact profile keeps to the error it was asked for, in files that any decoder of its page reads alike."""

import re
import threading
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from qmd_studio.codecs.compact.attempt import Meter, attempt
from qmd_studio.codecs.compact.decode import decode_payload, decode_segment
from qmd_studio.codecs.compact.encode import CompactEncoder
from qmd_studio.codecs.compact.file import encode
from qmd_studio.codecs.compact.payload import unpack
from qmd_studio.codecs.compact.prior import prior
from qmd_studio.codecs.compact.progress import EncodingCancelledError, Watch
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.synthesis import sines, step_sizes
from qmd_studio.codecs.qmd.container import HEADER, parse
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.errors import CodecError, FormatError, QmdStudioError
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from tests.codecs.foreign_compact_decoder import decode as decode_elsewhere
from tests.codecs.foreign_compact_decoder import prior as printed_prior
from tests.codecs.tiny_motions import pendulum, pendulum_skeleton
from tests.generated_motion import walker

WALK = walker(200)
SHAPES = [
    (n, CompactSettings(mean_error_mm=0.5, segment=s, block=b))
    for n, s, b in [
        (1, 0, 20), (2, 0, 20), (3, 0, 20), (21, 0, 20), (30, 0, 20), (31, 0, 20), (45, 20, 20), (41, 40, 20),
        (7, 1, 20), (9, 2, 20), (25, 10, 1), (25, 0, 2), (200, 120, 60),
    ]
]  # fmt: skip


def columns(data):
    return decode_payload(unpack(parse(data).payload))


@pytest.mark.parametrize("target", [{"mean_error_mm": 1.0}, {"mean_error_mm": 0.05}, {"max_error_mm": 2.0}])
@pytest.mark.parametrize("segment", [0, 60])
def test_encode_keeps_to_the_error_and_says_what_decoders_get(target, segment):
    encoded = encode(WALK, CompactSettings(segment=segment, **target))
    decoded = decode(encoded.data)
    assert np.array_equal(decoded.X, encoded.decoded.X)
    error = measure(WALK, decoded)
    assert error.mean_mm <= target.get("mean_error_mm", np.inf) * (1 + 1e-6)
    assert error.max_mm <= target.get("max_error_mm", np.inf) * (1 + 1e-6)
    assert len(encoded.data) == HEADER.size + encoded.payload_bytes + encoded.skeleton_bytes


def test_encode_with_a_larger_error_gives_a_smaller_file():
    sizes = [encode(WALK, CompactSettings(mean_error_mm=error)).payload_bytes for error in (0.1, 0.3, 1.0, 3.0)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > 1.5 * sizes[2]


@pytest.mark.parametrize(("n_frames", "wanted"), SHAPES)
def test_decode_elsewhere_gives_the_same_bits(n_frames, wanted):
    data = encode(pendulum(n_frames), wanted).data
    fps, poses = decode_elsewhere(data)
    assert fps == 30.0
    assert np.array_equal(np.array(poses, np.float32).view(np.int32), columns(data).view(np.int32))


def test_decode_elsewhere_of_a_walk_gives_the_same_bits():
    data = encode(WALK, CompactSettings(mean_error_mm=0.2, segment=90)).data
    assert np.array_equal(np.array(decode_elsewhere(data)[1], np.float32).view(np.int32), columns(data).view(np.int32))


def test_the_page_prints_the_prior_that_is_used():
    assert np.array_equal(np.array(printed_prior(), np.uint8), prior())
    page = (Path(__file__).parents[2] / "resources" / "help" / "qmd-compact.md").read_text(encoding="utf-8")
    words = re.search(r"^3F800000.*$", page, re.MULTILINE).group().split()
    assert [int(word, 16) for word in words] == step_sizes(np.arange(192, 200)).view(np.uint32).tolist()


def test_sines_come_near_no_tie_so_that_every_machine_rounds_alike():
    for length in range(2, 92):
        exact = 2**20 * np.sqrt(2 / length) * np.sin(np.pi * np.outer(range(1, length), range(1, length)) / length)
        assert np.abs(np.abs(exact - np.floor(exact)) - 0.5).min() > 1e-7
        assert np.array_equal(sines(length), np.rint(exact))


def test_decode_segment_needs_nothing_of_the_others():
    data = encode(WALK, CompactSettings(mean_error_mm=0.5, segment=60)).data
    contents = unpack(parse(data).payload)
    lost = type(contents)(
        n_frames=contents.n_frames,
        n_columns=contents.n_columns,
        segment=contents.segment,
        block=contents.block,
        prelude=contents.prelude,
        streams=(b"", b"", contents.streams[2], b""),
    )
    assert np.array_equal(decode_segment(lost, 2), columns(data)[120:180])


@settings(max_examples=40, deadline=None)
@given(
    arrays(np.float64, st.tuples(st.integers(1, 50), st.just(3)), elements=st.floats(-1e4, 1e4)),
    st.sampled_from([0, 1, 7, 24]),
)
def test_any_motion_comes_back_within_its_bound(X, segment):
    motion = Motion(pendulum_skeleton(), X, 30.0)
    encoded = encode(motion, CompactSettings(max_error_mm=50.0, segment=segment))
    decoded = decode(encoded.data)
    assert np.array_equal(decoded.X, encoded.decoded.X)
    assert measure(motion, decoded).max_mm <= 50.0 * (1 + 1e-6)


def test_encode_of_a_motion_that_stands_still_takes_hardly_more_than_its_pose():
    still = WALK.with_values(np.repeat(WALK.X[:1], 500, axis=0))
    encoded = encode(still, CompactSettings(mean_error_mm=0.1))
    assert encoded.payload_bytes < 500
    assert measure(still, decode(encoded.data)).mean_mm <= 0.1


def test_encode_of_a_flip_by_half_a_turn_keeps_to_its_bound():
    X = WALK.X.copy()
    X[70:, 30] += np.pi
    flipped = WALK.with_values(X)
    encoded = encode(flipped, CompactSettings(max_error_mm=2.0))
    assert measure(flipped, decode(encoded.data)).max_mm <= 2.0


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"mean_error_mm": 1.0, "max_error_mm": 1.0},
        {"mean_error_mm": 0.0},
        {"max_error_mm": np.nan},
        {"mean_error_mm": np.inf},
        {"mean_error_mm": 1.0, "segment": -1},
        {"mean_error_mm": 1.0, "block": 0},
        {"mean_error_mm": 1.0, "block": 61},
    ],
)
def test_encode_with_settings_out_of_range_is_refused(wrong):
    with pytest.raises(CodecError):
        encode(pendulum(), CompactSettings(**wrong))


def test_encode_to_an_error_that_cannot_be_kept_says_what_can():
    with pytest.raises(CodecError) as caught:
        encode(WALK, CompactSettings(mean_error_mm=1e-9))
    assert "at best" in caught.value.got


def test_encode_of_a_value_beyond_the_coarsest_step_names_its_column():
    X = pendulum().X.copy()
    X[2, 2] = 1e30
    with pytest.raises(CodecError) as caught:
        encode(pendulum().with_values(X), CompactSettings(mean_error_mm=1.0))
    assert "lamp" in caught.value.at


def test_open_file_of_a_compact_file_without_its_skeleton_wants_one(tmp_path):
    path = tmp_path / "bare.qmd"
    path.write_bytes(encode(pendulum(), CompactSettings(mean_error_mm=1.0), with_skeleton=False).data)
    with pytest.raises(FormatError, match="no skeleton"):
        open_file(path)
    assert decode(path.read_bytes(), pendulum_skeleton()).n_frames == 6


def test_open_file_and_describe_know_both_profiles(tmp_path):
    path = tmp_path / "swing.qmd"
    path.write_bytes(encode(pendulum(100), CompactSettings(mean_error_mm=1.0, segment=40, block=25)).data)
    opened = open_file(path).motion
    assert (opened.n_frames, opened.fps, opened.name) == (100, 30.0, "swing")
    about = describe(path.read_bytes())
    assert (about["profile"], about["segment"], about["segments"], about["block"]) == ("compact", 40, 3, 25)


def test_encode_to_a_bound_minds_the_frames_that_break_it_and_is_smaller_than_one_fineness_for_all():
    jerk = np.zeros((200, 1))
    jerk[90:94] = 0.4
    motion = WALK.with_values(WALK.X + jerk * (np.arange(WALK.X.shape[1]) > 5))
    encoded = encode(motion, CompactSettings(max_error_mm=1.0))
    assert measure(motion, decode(encoded.data)).max_mm <= 1.0
    encoder, meter, watch = CompactEncoder(motion, CompactSettings(max_error_mm=1.0)), Meter(motion), Watch()
    alike = [attempt(encoder, meter, fineness, watch) for fineness in np.geomspace(0.002, 0.1, 40)]
    assert encoded.payload_bytes < min(len(tried.payload) for tried in alike if tried.max_mm <= 1.0)


def test_encode_chooses_longer_blocks_where_less_happens():
    still = pendulum(300)
    swing = np.sin(np.arange(300)[:, np.newaxis] * np.array([0.3, 0.5, 0.2])) + 0.3 * still.X
    calm, rough = still.with_values(np.sin(np.arange(300)[:, np.newaxis] / 50) + 0 * still.X), still.with_values(swing)
    chosen = [unpack(parse(encode(m, CompactSettings(mean_error_mm=0.5)).data).payload).block for m in (calm, rough)]
    assert chosen[0] > chosen[1]


def test_encode_that_is_cancelled_stops_at_once_and_reports_progress_until_then():
    cancel, heard = threading.Event(), []

    def on_attempt(number, most):
        heard.append((number, most))
        cancel.set()

    with pytest.raises(EncodingCancelledError):
        encode(WALK, CompactSettings(max_error_mm=0.2), watch=Watch(cancel, on_attempt))
    assert heard[0][0] == 1 <= heard[0][1]
    assert len(heard) == 1


def test_encode_of_a_value_that_is_no_number_is_refused_with_the_reason():
    X = pendulum().X.copy()
    X[2, 2] = np.nan
    with pytest.raises(QmdStudioError, match=r"number|finite|NaN"):
        encode(pendulum().with_values(X), CompactSettings(mean_error_mm=1.0))
