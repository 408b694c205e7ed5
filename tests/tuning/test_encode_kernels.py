"""The kernels of the search hold to what the codec itself does, to the last bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from qmd_studio.codecs.qmd import tables
from qmd_studio.codecs.qmd.encode import encode_matrix
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.tuning import encode_kernels
from qmd_studio.tuning.encoders import FAST_ENCODERS
from qmd_studio.tuning.evaluator import FastEvaluator
from tests.generated_motion import walker

VALUES = st.one_of(
    st.floats(-4, 4, width=32, allow_subnormal=False).map(lambda v: round(v, 3)), st.sampled_from([0.0, 0.001, 3.1])
)


@settings(max_examples=60, deadline=None)
@given(arrays(np.float32, st.integers(0, 400), elements=VALUES), st.sampled_from([8, 9, 12]))
def test_levels_are_those_of_the_codec(values, bits):
    table = np.empty(2**bits, np.float32)
    encode_kernels.companded(np.sort(values), table, tables.MOST_INTERVALS, tables.UNIFORM_SHARE)
    np.testing.assert_array_equal(table, tables.companded_table(values, bits=bits))


@pytest.mark.parametrize("encoder", FAST_ENCODERS)
@pytest.mark.parametrize(("fdf", "bits", "segment"), [(0, 8, 0), (7, 9, 40), (61, 8, 30), (62, 12, 0), (3, 16, 100)])
def test_decoded_values_are_those_of_the_codec(encoder, fdf, bits, segment):
    motion = walker(150)
    chosen = QmdSettings(fdf, bits, segment, encoder)
    evaluator = FastEvaluator(motion, chosen)
    (ours,) = evaluator._paths(fdf, segment or motion.n_frames - 1, np.array([bits]))
    matrix = codec_matrix(motion)
    origin, scale = (unit[:, np.newaxis] for unit in evaluator._units)
    theirs = (encode_matrix(matrix, motion.skeleton, chosen).decoded - origin) * scale
    np.testing.assert_array_equal(ours, theirs)
