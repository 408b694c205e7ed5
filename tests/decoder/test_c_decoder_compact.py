"""Version 2, the compact profile, in C: Python's poses to the last bit, and what Python refuses refused."""

import struct
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.compact import file as compact
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd import container
from qmd_studio.errors import FormatError
from qmd_studio.registry import open_file
from qmd_studio.tuning.decoder_work import work_of_file
from tests.codecs.tiny_motions import pendulum
from tests.corpus import corpus_files
from tests.decoder.python_decoder import assert_same
from tests.formats.damage import damaged
from tests.generated_motion import walker

GOLDEN_FILES = sorted((Path(__file__).parent / "golden").glob("*.qmd"))


@cache
def payload_of(n_frames, segment):
    """A tiny payload with several key poses."""
    motion = pendulum(n_frames)
    chosen = CompactSettings(mean_error_mm=2.0, segment=segment)
    return bytes(container.parse(compact.encode(motion, chosen).data).payload)


def sealed(payload):
    return container.build_compact(payload, b"block", 30.0, 0)


@pytest.mark.parametrize("path", GOLDEN_FILES, ids=lambda path: path.stem)
def test_golden_file_gives_python_s_poses(sanitised, optimised, path):
    for decoder in (sanitised, optimised):
        ours = assert_same(decoder, path.read_bytes())
        assert ours.status == "END"
        assert ours.work_bytes == work_of_file(path.read_bytes()).work_bytes > 0


@pytest.mark.parametrize("n_frames", [1, 2, 3, 21, 22, 40, 343])
@pytest.mark.parametrize("segment", [0, 1, 2, 21, 120])
def test_generated_walk_gives_python_s_poses(sanitised, optimised, n_frames, segment):
    chosen = CompactSettings(mean_error_mm=0.5, segment=min(segment, n_frames))
    data = compact.encode(walker(n_frames), chosen).data
    for decoder in (sanitised, optimised):
        assert assert_same(decoder, data).frames == n_frames


@pytest.mark.corpus
@pytest.mark.parametrize("path", corpus_files("cmu_*/*.amc") + corpus_files("bap/*.bap") + corpus_files("bvh/*.bvh"))
def test_corpus_clip_gives_python_s_poses(sanitised, path):
    try:
        motion = open_file(path).motion
    except FormatError:
        motion = None
    if motion is None or not motion.skeleton.n_columns:
        pytest.skip("no motion in this file")
    motion = motion.with_values(motion.X[:400])
    for mean_mm, segment in ((0.2, 120), (1.0, 0)):
        chosen = CompactSettings(mean_error_mm=mean_mm, segment=min(segment, motion.n_frames))
        assert assert_same(sanitised, compact.encode(motion, chosen).data).status == "END"


@pytest.mark.parametrize(("n_frames", "segment"), [(30, 0), (30, 8)])
def test_every_prefix_ends_as_in_python(sanitised, n_frames, segment):
    payload = payload_of(n_frames, segment)
    for length in range(len(payload) + 1):
        assert_same(sanitised, sealed(payload[:length]))
    data = sealed(payload)
    for length in range(len(data) + 1):
        assert_same(sanitised, data[:length])


@settings(max_examples=600, deadline=None)
@given(payload=st.sampled_from([(30, 0), (30, 8), (4, 1)]).flatmap(lambda which: damaged(payload_of(*which))))
def test_damaged_payload_under_a_right_checksum_ends_as_in_python(sanitised, payload):
    assert_same(sanitised, sealed(payload))


@settings(max_examples=300, deadline=None)
@given(
    counts=st.tuples(*[st.sampled_from((0, 1, 2, 7, 60, 89, 90, 2**31, 2**32 - 1))] * 3),
    between=st.sampled_from((0, 1, 2, 20, 59, 60, 61, 255)),
    rest=st.binary(max_size=400),
)
def test_absurd_counts_end_as_in_python(sanitised, counts, between, rest):
    assert_same(sanitised, sealed(struct.pack("<IIIB", *counts, between) + rest))


@settings(max_examples=300, deadline=None)
@given(
    n_frames=st.integers(1, 200),
    n_columns=st.integers(1, 5),
    between=st.integers(1, 60),
    prelude=st.binary(max_size=30),
    stream=st.binary(max_size=127),
)
def test_stream_of_noise_ends_as_in_python(sanitised, n_frames, n_columns, between, prelude, stream):
    packed = struct.pack("<IIIB", n_frames, n_columns, 0, between) + bytes((len(prelude), len(stream)))
    assert_same(sanitised, sealed(packed + prelude + stream))


def test_noise_now_and_then_plays(sanitised):
    random = np.random.default_rng(3)
    played = 0
    for _ in range(200):
        stream = b"\xff" * 2 + random.bytes(90)  # decisions against "larger" to begin with: small numbers
        packed = struct.pack("<IIIB", 40, 2, 0, 20) + bytes((20, len(stream)))
        played += assert_same(sanitised, sealed(packed + b"\xff" * 20 + stream)).status == "END"
    assert played > 0
