"""What is not a whole compact file is refused at once, and a lying one costs neither time nor memory."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.compact.file import encode
from qmd_studio.codecs.compact.payload import Payload, pack, unpack
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.container import build_compact, parse
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.errors import FormatError
from qmd_studio.motion.motion import Motion
from tests.codecs.tiny_motions import pendulum
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged

GOLDEN = encode(pendulum(90), CompactSettings(mean_error_mm=0.5, segment=40)).data
PAYLOAD = bytes(parse(GOLDEN).payload)
BLOCK = bytes(parse(GOLDEN).skeleton_block)
COUNTS = struct.Struct("<IIIB")


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Compile the decoder before its time is watched."""
    decode(GOLDEN)


def sealed(payload):
    """A file with this payload whose checksum is right."""
    return build_compact(payload, BLOCK, 30.0, 40)


def refused(payload):
    with pytest.raises(FormatError) as caught:
        decode(sealed(payload))
    return caught.value


def test_decode_of_every_prefix_ends_well():
    assert_every_prefix_ends_well(decode, GOLDEN)


@settings(max_examples=100, deadline=None)
@given(damaged(GOLDEN))
def test_decode_of_a_damaged_file_ends_well(data):
    assert data == GOLDEN or isinstance(assert_ends_well(decode, data), FormatError)


@settings(max_examples=300, deadline=None)
@given(damaged(PAYLOAD))
def test_decode_of_a_damaged_payload_under_a_right_checksum_ends_well(payload):
    result = assert_ends_well(decode, sealed(payload))
    assert isinstance(result, FormatError) or (isinstance(result, Motion) and np.isfinite(result.X).all())


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=120), st.integers(0, 3), st.integers(1, 60))
def test_decode_of_streams_of_noise_ends_well(noise, segment, block):
    streams = tuple(noise[i::4] for i in range(-(-9 // segment) if segment else 1))
    payload = pack(Payload(n_frames=9, n_columns=3, segment=segment, block=block, prelude=noise, streams=streams))
    result = assert_ends_well(decode, sealed(payload))
    assert isinstance(result, (FormatError, Motion))


@pytest.mark.parametrize("n_bytes", range(len(PAYLOAD)))
def test_decode_of_every_shorter_payload_under_a_right_checksum_is_refused_or_finite(n_bytes):
    result = assert_ends_well(decode, sealed(PAYLOAD[:n_bytes]))
    assert isinstance(result, FormatError)


@pytest.mark.parametrize(
    "counts",
    [(0, 3, 0, 20), (90, 0, 40, 20), (90, 3, 91, 20), (90, 3, 40, 0), (90, 3, 40, 61), (2**32 - 1, 2**32 - 1, 0, 60),
     (2**32 - 1, 1, 1, 1), (1, 2**32 - 1, 0, 1), (2**31, 3, 2**31, 20)],
)  # fmt: skip
def test_decode_of_counts_out_of_range_is_refused(counts):
    payload = COUNTS.pack(*counts) + PAYLOAD[COUNTS.size :]
    assert isinstance(assert_ends_well(decode, sealed(payload)), FormatError)
    assert refused(payload).at == "byte 64"
    with pytest.raises(FormatError):
        describe(sealed(payload))


def test_decode_of_the_largest_motion_that_64_kilobytes_may_claim_stays_small():
    payload = COUNTS.pack(65000 * 128 // 3, 3, 0, 20) + bytes([0, 0])
    assert_ends_well(decode, sealed(payload + bytes(65000 - len(payload))))
    payload = COUNTS.pack(60000, 3, 1, 1) + bytes(60001)
    assert_ends_well(decode, sealed(payload))


def test_unpack_of_a_length_that_does_not_end_is_refused():
    assert "length" in refused(COUNTS.pack(9, 3, 0, 20) + b"\xff" * 40).message
    assert "length" in refused(COUNTS.pack(9, 3, 0, 20) + b"\xff").message


def test_unpack_of_something_after_the_last_stream_is_refused():
    assert "follows" in refused(PAYLOAD + b"\0\1").message
    assert decode(sealed(PAYLOAD + b"\0\0")).n_frames == 90


def test_decode_of_a_stream_cut_short_says_which():
    contents = unpack(memoryview(PAYLOAD))
    cut = Payload(90, 3, 40, 20, contents.prelude, (contents.streams[0], b"\x5a", contents.streams[2]))
    assert "segment 1" in refused(pack(cut)).message
