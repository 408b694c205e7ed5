"""The bounded encoder keeps every joint within its distance, for no more bytes than a plain grid of settings."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.bounded import _below, _climbed, _Found, encode_bounded
from qmd_studio.codecs.qmd.bounded_fit import Fitter
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.errors import Cancelled, CodecError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.metrics import measure
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import open_file
from tests.codecs import foreign_decoder
from tests.codecs.tiny_motions import pendulum
from tests.corpus import corpus_file, corpus_files
from tests.generated_motion import walker


def within(bound_mm):
    return QmdSettings(encoder=Encoder.BOUNDED, max_error_mm=bound_mm)


def flipping(n_frames=90):
    """A walk on which a thumb turns over by half a turn now and then, as captured ones do."""
    motion = walker(n_frames)
    X = motion.X.copy()
    thumb = [column.name for column in motion.skeleton.columns].index("rthumb.rx")
    X[30:33, thumb] += np.pi
    X[60:, thumb] -= np.pi
    return motion.with_values(X)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 1000),
    n_frames=st.integers(1, 70),
    bound_mm=st.sampled_from((0.05, 0.3, 1.0, 5.0)),
    shake=st.sampled_from((0.0, 0.02, 0.3)),
)
def test_encode_within_a_bound_keeps_it(seed, n_frames, bound_mm, shake):
    motion = walker(n_frames, seed=seed)
    noise = np.random.default_rng(seed).normal(0, shake, motion.X.shape)
    motion = motion.with_values(motion.X + noise)
    data = encode(motion, within(bound_mm)).data
    assert measure(motion, decode(data)).max_mm <= bound_mm
    assert len(foreign_decoder.decode(data)[1]) == n_frames


def test_encode_within_a_bound_takes_flips_in_its_stride():
    motion = flipping()
    encoded = encode(motion, within(1.0))
    assert measure(motion, decode(encoded.data)).max_mm <= 1.0
    assert encoded.size.bytes < payload_size(motion.n_frames - 1, 62, 26, 8).bytes


def grid_best(motion, bound_mm, encoder):
    """Return the fewest bytes of a grid of plain settings that keep the bound."""
    n_rows = motion.n_frames - 1
    sizes = []
    for fdf in (0, 1, 2, 3, 5, 6, 8, 10, 15, 20, 25, 40, 62):
        for bits in (8, 9, 10, 12):
            for segment in (0, 30, 60):
                chosen = QmdSettings(fdf, bits, segment, encoder)
                if measure(motion, encode(motion, chosen).decoded).max_mm <= bound_mm:
                    sizes.append(payload_size(n_rows, 62, fdf, bits, segment).bytes)
    return min(sizes)


@pytest.mark.parametrize("encoder", [Encoder.PLAIN, Encoder.CLOSED])
@pytest.mark.parametrize("bound_mm", [0.1, 0.6])
def test_encode_within_a_bound_takes_no_more_than_a_plain_grid(encoder, bound_mm):
    motion = flipping()
    encoded = encode(motion, within(bound_mm))
    assert encoded.size.bytes <= grid_best(motion, bound_mm, encoder)


def test_what_the_ladder_misses_the_grid_finds():
    motion = walker(60)
    fitter = Fitter(codec_matrix(motion), motion.skeleton, 0.5)
    wasteful = _Found(fitter.size(62, 8, 1), ())
    found = _below(fitter, wasteful)
    assert _climbed(fitter).n_bytes <= found.n_bytes < wasteful.n_bytes
    assert sum(segment.n_rows for segment in found.segments) == 59


def test_encode_says_the_best_bound_where_none_can_be_kept_and_that_one_can():
    motion = walker(30)
    with pytest.raises(CodecError, match="no QMD file") as caught:
        encode(motion, within(1e-7))
    reachable = float(caught.value.got.split()[0])
    assert 1e-7 < reachable < 0.05
    assert measure(motion, encode(motion, within(reachable)).decoded).max_mm <= reachable


def test_encode_within_a_bound_needs_something_to_measure():
    skeleton = Skeleton(
        "unmeasured", SkeletonKind.BVH, (Joint("root", -1, (0.0, 0.0, 0.0)),), (),
        (Column("x", 0, ColumnKind.TRANSLATION, 0),), (),
    )  # fmt: skip
    with pytest.raises(CodecError, match="no points"):
        encode(Motion(skeleton, np.zeros((5, 1)), 30.0), within(1.0))


def test_encode_within_a_bound_of_a_few_columns_keeps_it():
    motion = pendulum(40)
    encoded = encode(motion, within(0.5))
    assert measure(motion, decode(encoded.data)).max_mm <= 0.5


def test_encode_within_a_bound_of_body_animation_parameters_keeps_it():
    skeleton = bap_skeleton()
    phase = np.arange(40)[:, np.newaxis] / 40 + np.random.default_rng(6).random(skeleton.n_columns)
    motion = Motion(skeleton, 0.2 * np.sin(2 * np.pi * phase), 25.0)
    assert measure(motion, decode(encode(motion, within(1.0)).data)).max_mm <= 1.0


@pytest.mark.corpus
@pytest.mark.parametrize(
    ("trial", "bound_mm", "share"), [("02_01", 1.0, 0.80), ("49_08", 2.0, 0.80), ("07_12", 0.5, 0.85)]
)
def test_encode_of_captured_motion_within_a_bound_is_smaller_than_the_paper_s_file(trial, bound_mm, share):
    motion = open_file(corpus_file(f"cmu_asfamc/{trial}.amc")).motion
    encoded = encode(motion, within(bound_mm))
    assert measure(motion, decode(encoded.data)).max_mm <= bound_mm
    assert encoded.size.bytes <= share * payload_size(motion.n_frames - 1, 62, 6, 8).bytes


@pytest.mark.parametrize(
    "path",
    corpus_files("bvh/mass_run.bvh") + corpus_files("bvh/bvhpython_freebvh.bvh") + corpus_files("bap/vreng_clap.bap"),
)
def test_encode_of_other_bodies_within_a_bound_keeps_it(path):
    motion = open_file(path).motion
    assert measure(motion, decode(encode(motion, within(1.0)).data)).max_mm <= 1.0


def test_it_is_stopped_wherever_it_is():
    motion = walker(120)
    for checks in range(4):
        with pytest.raises(Cancelled):
            encode_bounded(codec_matrix(motion), motion.skeleton, 0.02, CancelAfter(checks))


class CancelAfter(threading.Event):
    """Is set once it has been asked so many times."""

    def __init__(self, checks):
        super().__init__()
        self._left = checks

    def is_set(self):
        self._left -= 1
        return self._left < 0
