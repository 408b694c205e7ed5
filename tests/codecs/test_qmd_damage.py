"""What is not a whole QMD file is refused at once, with the byte and the way out."""

import json
import math
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.container import HEADER, build, parse
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import FormatError
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_file
from tests.codecs.tiny_motions import pendulum, pendulum_skeleton
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged

GOLDEN = encode(pendulum(), QmdSettings(fdf=1, segment=3)).data
PAYLOAD = bytes(parse(GOLDEN).payload)
BLOCK = bytes(parse(GOLDEN).skeleton_block)
TEXT = zlib.decompress(BLOCK[4:])
POSE_AT, TABLE_AT = 13, 13 + 12


def sealed(payload=PAYLOAD, block=BLOCK, fps=30.0):
    """A file with these parts whose checksum is right."""
    return build(payload, block, fps, QmdSettings())


def block_of(text, declared=None):
    return struct.pack("<I", len(text) if declared is None else declared) + zlib.compress(text)


def refused(data):
    with pytest.raises(FormatError) as caught:
        decode(data)
    return caught.value


def test_decode_of_every_prefix_ends_well():
    assert_every_prefix_ends_well(decode, GOLDEN)


@settings(max_examples=150, deadline=None)
@given(damaged(GOLDEN))
def test_decode_of_a_damaged_file_ends_well(data):
    assert data == GOLDEN or isinstance(assert_ends_well(decode, data), FormatError)


@settings(max_examples=200, deadline=None)
@given(damaged(PAYLOAD))
def test_decode_of_a_damaged_payload_under_a_right_checksum_ends_well(payload):
    result = assert_ends_well(decode, sealed(payload))
    assert isinstance(result, FormatError) or (isinstance(result, Motion) and np.isfinite(result.X).all())


@settings(max_examples=100, deadline=None)
@given(damaged(PAYLOAD[:TABLE_AT]), st.binary(max_size=200))
def test_decode_of_absurd_headers_ends_well(header, rest):
    assert_ends_well(decode, sealed(header + rest))
    assert_ends_well(describe, sealed(header + rest))


@settings(max_examples=200, deadline=None)
@given(damaged(TEXT))
def test_decode_of_a_damaged_skeleton_under_a_right_checksum_ends_well(text):
    assert_ends_well(decode, sealed(block=block_of(text)))


@settings(max_examples=60, deadline=None)
@given(damaged(BLOCK))
def test_decode_of_a_damaged_block_under_a_right_checksum_ends_well(block):
    assert_ends_well(decode, sealed(block=block))


@pytest.mark.parametrize(
    ("n_d", "m", "fdf", "b"),
    [(2**31 - 1, 62, 6, 8), (2**31 - 1, 1, 0, 8), (1, 2**31 - 1, 0, 8), (2**31 - 1, 2**31 - 1, 2**31 - 1, 16)],
)
def test_decode_of_counts_that_the_bytes_do_not_bear_out_is_refused(n_d, m, fdf, b):
    data = sealed(struct.pack("<iiiB", n_d, m, fdf, b) + bytes(100))
    assert isinstance(assert_ends_well(decode, data), FormatError)
    assert "ends early" in refused(data).message


@pytest.mark.parametrize(
    ("n_d", "m", "fdf", "b"), [(-1, 3, 1, 8), (3, 0, 0, 8), (3, 3, 4, 8), (3, 3, -1, 8), (3, 3, 1, 7), (3, 3, 1, 17)]
)
def test_decode_of_counts_out_of_range_is_refused(n_d, m, fdf, b):
    problem = refused(sealed(struct.pack("<iiiB", n_d, m, fdf, b) + PAYLOAD[13:]))
    assert problem.at == "byte 64"
    assert "out of range" in problem.message


def test_decode_of_one_flipped_bit_says_that_the_checksum_fails():
    for at in (9, 70, len(GOLDEN) - 1):
        data = bytearray(GOLDEN)
        data[at] ^= 4
        problem = refused(bytes(data))
        assert "checksum" in problem.message
        assert problem.hint


def test_decode_of_a_later_version_says_so():
    data = bytearray(GOLDEN)
    data[4] = 3
    assert "version" in refused(bytes(data)).message


def test_decode_of_something_longer_than_its_header_says_is_refused():
    assert "long" in refused(GOLDEN + b"\0").message


def test_open_file_of_a_damaged_file_names_it(tmp_path):
    path = tmp_path / "cut.qmd"
    path.write_bytes(GOLDEN[:-5])
    with pytest.raises(FormatError) as caught:
        open_file(path)
    assert caught.value.path == path


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("at", [POSE_AT, TABLE_AT, TABLE_AT + 1024])
def test_decode_of_a_value_that_is_not_a_number_names_its_byte(at, value):
    payload = bytearray(PAYLOAD)
    struct.pack_into("<f", payload, at, value)
    problem = refused(sealed(bytes(payload)))
    assert "not a number" in problem.message
    assert problem.at == f"byte {64 + at}"


def test_decode_of_sums_that_leave_float32_is_refused():
    payload = bytearray(PAYLOAD)
    payload[TABLE_AT : TABLE_AT + 1024] = struct.pack("<f", 3e38) * 256
    assert "range" in refused(sealed(bytes(payload))).message


@pytest.mark.parametrize("fps", [0.0, -30.0, math.nan, math.inf])
def test_decode_of_an_impossible_frame_rate_is_refused(fps):
    assert "frame rate" in refused(sealed(fps=fps)).message


def test_decode_of_an_index_past_its_table_is_refused():
    payload = bytes(parse(encode(pendulum(), QmdSettings(fdf=1, bits=9)).data).payload)
    problem = refused(sealed(payload[:-2] + struct.pack("<H", 512)))
    assert "past its table" in problem.message
    assert problem.at == f"byte {64 + len(payload) - 2}"


def test_decode_of_an_empty_segment_among_others_is_refused():
    empty = struct.pack("<iiiB", 0, 3, 1, 8) + bytes(1024)
    assert "does not fit" in refused(sealed(PAYLOAD + empty)).message
    first = struct.pack("<iiiB", 0, 3, 1, 8) + bytes(12 + 1024)
    rest = PAYLOAD[:13] + PAYLOAD[25:]
    assert "empty" in refused(sealed(first + rest)).message


def test_decode_of_a_payload_without_a_segment_is_refused():
    assert "ends early" in refused(sealed(b"")).message


def test_decode_of_a_block_that_inflates_beyond_measure_is_refused_unread():
    bomb = struct.pack("<I", 2**32 - 1) + zlib.compress(bytes(1 << 20))
    assert "too large" in refused(sealed(block=bomb)).message
    liar = block_of(bytes(50 << 20), declared=1000)
    problem = assert_ends_well(decode, sealed(block=liar))
    assert "not as long" in problem.message
    deep = block_of(b"[" * (1 << 20))
    assert isinstance(assert_ends_well(decode, sealed(block=deep)), FormatError)
    wide = block_of(b"[" + b"[]," * ((1 << 20) // 3 - 10) + b"[]]")
    assert isinstance(assert_ends_well(decode, sealed(block=wide)), FormatError)


@pytest.mark.parametrize("mask", [[], [[0], [1]], [[0], [1], [6]], [[0], [1], [-1]], [[0], [1], [True]], [[0], 1, []]])
def test_decode_of_a_mask_that_does_not_fit_is_refused(mask):
    values = json.loads(TEXT) | {"mask": mask}
    assert "mask" in refused(sealed(block=block_of(json.dumps(values).encode()))).message


def test_decode_of_a_skeleton_with_other_columns_is_refused():
    values = json.loads(TEXT)
    values["skeleton"]["columns"].pop()
    problem = refused(sealed(block=block_of(json.dumps(values).encode())))
    assert problem.wanted == "3 columns"


def test_header_and_all_around_the_payload_is_within_96_bytes():
    bare = encode(pendulum(), with_skeleton=False)
    assert len(bare.data) - bare.size.bytes == HEADER.size <= 96
    assert decode(bare.data, pendulum_skeleton()).n_frames == 6


@pytest.mark.parametrize(
    ("key", "part"),
    [
        ("joints", {"name": "", "parent": -1, "offset": [0, 0, 0]}),
        ("end_sites", {"name": "", "joint": 0, "offset": [0, 0, 0]}),
        ("columns", {"name": "", "joint": 0, "kind": "opaque", "axis": 0, "level": 1}),
        ("points", 0),
    ],
)
def test_decode_of_a_figure_of_absurdly_many_parts_is_refused(key, part):
    contents = json.loads(TEXT)
    contents["skeleton"][key] += [part] * 17_000
    data = sealed(block=block_of(json.dumps(contents, separators=(",", ":")).encode()))
    assert isinstance(assert_ends_well(decode, data), FormatError)
    assert "too many" in refused(data).message


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e400"])
def test_decode_of_a_skeleton_with_a_number_that_is_none_is_refused(number):
    text = TEXT.replace(b'"metres_per_unit":1.0', f'"metres_per_unit":{number}'.encode())
    assert text != TEXT
    refused(sealed(block=block_of(text)))


def test_decode_with_a_skeleton_seen_before_still_holds_the_block_to_its_file():
    contents = json.loads(TEXT) | {"mask": [[0], [], [2, 4]]}
    block = block_of(json.dumps(contents).encode())
    assert decode(sealed(block=block)).mask is not None
    short = encode(pendulum(3), QmdSettings(fdf=1, segment=3)).data
    assert "mask" in refused(sealed(bytes(parse(short).payload), block)).message
