"""The coders that QMD is compared with give back what they should: all bits, or all but half a step."""

import numpy as np
import pytest
from generated_motion import walker
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.codecs.rivals import lossless, range_delta
from qmd_studio.codecs.rivals.pcodec_matrix import pack_matrix, unpack_matrix

LOSSLESS = {
    "raw": (lossless.raw_bytes_of, lossless.raw_matrix),
    "zip": (lossless.zip_bytes_of, lossless.zip_matrix),
    "zstd": (lossless.zstd_bytes_of, lossless.zstd_matrix),
    "pcodec": (lossless.pcodec_bytes_of, lossless.pcodec_matrix),
}
MATRICES = st.tuples(st.integers(1, 600), st.integers(1, 4)).flatmap(
    lambda shape: arrays(np.float32, shape, elements=st.floats(-1e6, 1e6, width=32))
)


@pytest.mark.parametrize("name", LOSSLESS)
def test_lossless_keeps_every_bit(name):
    encode, decode = LOSSLESS[name]
    matrix = codec_matrix(walker(300))
    decoded = decode(encode(matrix), matrix.shape[1])
    assert decoded.dtype == np.float32
    assert decoded.tobytes() == matrix.tobytes()


def test_general_compressors_are_smaller_than_raw():
    matrix = codec_matrix(walker(300))
    assert len(lossless.pcodec_bytes_of(matrix)) < len(lossless.raw_bytes_of(matrix)) == matrix.size * 4
    assert len(lossless.zip_bytes_of(matrix)) < matrix.size * 4


@settings(max_examples=30, deadline=None)
@given(MATRICES)
def test_pcodec_keeps_any_numbers(matrix):
    assert unpack_matrix(pack_matrix(matrix), matrix.shape[1]).tobytes() == matrix.tobytes()
    whole = np.rint(matrix).astype(np.int32)
    assert np.array_equal(unpack_matrix(pack_matrix(whole), whole.shape[1]), whole)


@pytest.mark.parametrize("n_frames", [1, 255, 256, 257, 40_000])
def test_pcodec_keeps_noise_of_any_length(n_frames):
    random = np.random.default_rng(n_frames)
    bits = random.integers(-(2**31), 2**31, (n_frames, 3)).astype(np.int32)
    floats = random.standard_t(1, (n_frames, 3)).astype(np.float32)
    few = random.choice(bits.ravel()[:5], (n_frames, 3))
    for matrix in (bits, floats, few, bits % 60_000 - 30_000):
        assert np.array_equal(unpack_matrix(pack_matrix(matrix), 3), matrix)


@settings(max_examples=30, deadline=None)
@given(MATRICES, st.floats(1, 16))
def test_range_steps_stay_within_half_a_step(matrix, bits):
    decoded = range_delta.decode(range_delta.encode(matrix, bits), matrix.shape[1])
    reach = matrix.max(axis=0).astype(np.float64) - matrix.min(axis=0)
    rounding = 4e-7 * np.abs(matrix).max(axis=0) + 1e-30
    assert (np.abs(decoded - matrix.astype(np.float64)) <= 0.501 * reach / (2**bits - 1) + rounding).all()
    assert np.array_equal(decoded, range_delta.rounded(matrix, bits))
