"""The C decoder gives Python's poses to the last bit, refuses what Python refuses, and never reads past the file."""

import math
import struct
import subprocess
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.container import build, parse
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import FormatError
from qmd_studio.registry import open_file
from tests.codecs.tiny_motions import pendulum
from tests.corpus import corpus_file, corpus_files
from tests.decoder.c_decoder import ROOT, SANITISED, SOURCES, compile_c
from tests.decoder.python_decoder import assert_same, poses_of
from tests.formats.damage import damaged
from tests.generated_motion import walker

GOLDEN_FILES = sorted((ROOT / "tests/codecs/golden").glob("*.qmd"))
TINY = encode(pendulum(), QmdSettings(fdf=1, segment=3)).data
WIDE = encode(pendulum(), QmdSettings(fdf=1, bits=9, segment=2)).data
PAYLOADS = [bytes(parse(data).payload) for data in (TINY, WIDE)]
NASTY_COUNTS = (-(2**31), -1, 0, 1, 3, 5, 2**16, 2**31 - 1)
GRID = [(6, 8, 0), (0, 9, 60), (1, 8, 150), (20, 12, 0), (61, 16, 0)]


def sealed(payload, fps=30.0):
    """A file around a payload, its checksum right."""
    return build(payload, b"block", fps, QmdSettings())


def test_decoder_compiles_without_a_warning_where_there_is_no_library(c_compiler, tmp_path):
    flags = ("-O2", "-Wconversion", "-Wshadow", "-ffreestanding", "-nostdlib", "-shared", "-fPIC")
    assert compile_c(tmp_path / "decoder.so", SOURCES / "qmd_decoder.c", flags=flags) == ""


def test_example_compiles_and_prints_the_poses(c_compiler, tmp_path):
    program = tmp_path / "qmd_print"
    complaint = compile_c(program, SOURCES / "example.c", SOURCES / "qmd_decoder.c", flags=SANITISED)
    assert complaint == ""
    path = tmp_path / "walk.qmd"
    path.write_bytes(encode(walker(20)).data)
    printed = subprocess.run([program, path], capture_output=True, text=True, check=True, timeout=60).stdout
    head, *rows = printed.splitlines()
    assert head == "20 frames, 120 a second"
    poses = poses_of(parse(path.read_bytes()))
    assert np.array_equal(np.array([row.split() for row in rows], np.float32), poses)
    path.write_bytes(path.read_bytes()[:-1])
    damaged_run = subprocess.run([program, path], capture_output=True, text=True, timeout=60)
    assert damaged_run.returncode == 1
    assert "not as long as its header says, at byte 12" in damaged_run.stderr


@pytest.mark.parametrize("path", GOLDEN_FILES, ids=lambda path: path.stem)
def test_golden_file_gives_python_s_poses(sanitised, optimised, path):
    for decoder in (sanitised, optimised):
        assert assert_same(decoder, path.read_bytes()).status == "END"


@pytest.mark.corpus
@pytest.mark.parametrize("path", corpus_files("cmu_*/*.amc") + corpus_files("bap/*.bap") + corpus_files("bvh/*.bvh"))
def test_corpus_clip_gives_python_s_poses_at_every_setting_and_encoder(sanitised, optimised, path):
    try:
        motion = open_file(path).motion
    except FormatError:
        motion = None
    if motion is None or not motion.skeleton.n_columns:
        pytest.skip("no motion in this file")
    motion = motion.with_values(motion.X[:400])
    for encoder in Encoder:
        for fdf, bits, segment in GRID[: 1 if encoder is Encoder.BOUNDED else None]:  # which chooses these by itself
            chosen = QmdSettings(fdf, bits, segment, encoder, max_error_mm=20.0).fitted(motion.skeleton.n_columns)
            data = encode(motion, chosen).data
            assert assert_same(sanitised, data).status == "END"
            assert assert_same(optimised, data).status == "END"


@pytest.mark.corpus
def test_corpus_clip_cut_anywhere_and_sealed_anew_ends_as_in_python(sanitised):
    motion = open_file(corpus_file("cmu_asfamc/09_06.amc")).motion
    payload = bytes(parse(encode(motion, QmdSettings(segment=40)).data).payload)
    for length in range(0, len(payload), 61):
        assert_same(sanitised, sealed(payload[:length]))


@pytest.mark.parametrize("data", [TINY, WIDE], ids=["one byte an index", "two bytes an index"])
def test_every_prefix_ends_as_in_python(sanitised, data):
    for length in range(len(data) + 1):
        assert_same(sanitised, data[:length])


@pytest.mark.parametrize("payload", PAYLOADS, ids=["one byte an index", "two bytes an index"])
def test_every_prefix_sealed_anew_ends_as_in_python(sanitised, payload):
    for length in range(len(payload) + 1):
        assert_same(sanitised, sealed(payload[:length]))


@settings(max_examples=300, deadline=None)
@given(data=damaged(TINY))
def test_damaged_file_ends_as_in_python(sanitised, data):
    assert_same(sanitised, data)


@settings(max_examples=600, deadline=None)
@given(payload=st.sampled_from(PAYLOADS).flatmap(damaged))
def test_damaged_payload_under_a_right_checksum_ends_as_in_python(sanitised, payload):
    assert_same(sanitised, sealed(payload))


@settings(max_examples=300, deadline=None)
@given(
    header=st.tuples(*[st.sampled_from(NASTY_COUNTS)] * 3, st.sampled_from((7, 8, 9, 16, 17, 255))),
    rest=st.binary(max_size=3000),
)
def test_absurd_segment_header_ends_as_in_python(sanitised, header, rest):
    assert_same(sanitised, sealed(struct.pack("<iiiB", *header) + rest))
    assert_same(sanitised, sealed(PAYLOADS[0] + struct.pack("<iiiB", *header) + rest))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("at", [13, 13 + 12, 13 + 12 + 4 * 255, 13 + 12 + 1024])
def test_value_that_is_not_a_number_names_its_byte(sanitised, at, value):
    payload = bytearray(PAYLOADS[0])
    struct.pack_into("<f", payload, at, value)
    outcome = assert_same(sanitised, sealed(bytes(payload)))
    assert (outcome.status, outcome.error_at) == ("NOT_A_NUMBER", 64 + at)


@pytest.mark.parametrize("sign", [1, -1])
def test_sums_that_leave_the_range_of_float_are_refused_when_they_do(sanitised, sign):
    payload = bytearray(PAYLOADS[0])
    payload[25 : 25 + 1024] = struct.pack("<f", sign * 2e38) * 256
    outcome = assert_same(sanitised, sealed(bytes(payload)))
    assert outcome.status == "RANGE"
    assert np.isfinite(outcome.poses).all()
    payload[25 : 25 + 1024] = struct.pack("<f", sign * 1e37) * 256  # watched, but in range
    payload[25 + 1024 + 12 + 6 :] = b""
    assert assert_same(sanitised, sealed(bytes(payload))).status == "END"


@pytest.mark.parametrize("fps", [0.0, -30.0, 1e-3, 9e-4, 1e5, 1.1e5, math.nan, math.inf])
def test_frame_rate_is_taken_where_python_takes_it(sanitised, fps):
    assert_same(sanitised, sealed(PAYLOADS[0], fps))


def test_empty_first_segment_among_others_is_refused(sanitised):
    empty = struct.pack("<iiiB", 0, 3, 1, 8) + bytes(12 + 1024)
    assert assert_same(sanitised, sealed(empty)).status == "END"
    later = PAYLOADS[0][:13] + PAYLOADS[0][25:]
    assert assert_same(sanitised, sealed(empty + later)).status == "SEGMENT"
    assert assert_same(sanitised, sealed(empty + later + b"x")).error_at == 64 + len(empty + later)


@pytest.mark.parametrize("version", [0, 3, 65535])
def test_other_version_is_refused_before_anything_is_read_by_it(sanitised, version):
    data = bytearray(TINY)
    struct.pack_into("<H", data, 4, version)
    struct.pack_into("<I", data, 8, zlib.crc32(data[12:], zlib.crc32(data[:8])))
    assert sanitised.decode(bytes(data)).status == "VERSION"
