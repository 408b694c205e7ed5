"""Files that stand in the repository stay readable, and are still written the same."""

from pathlib import Path

import numpy as np
import pytest

from qmd_studio.codecs.qmd.container import parse
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from tests.codecs.foreign_decoder import decode as decode_elsewhere
from tests.codecs.tiny_motions import pendulum, pendulum_skeleton

GOLDEN = Path(__file__).with_name("golden")
SHOWN = {
    "closed_loop_fdf_1_b_8_one_segment": (pendulum(6), QmdSettings(fdf=1, encoder=Encoder.PLAIN), True),
    "paper_fdf_0_b_8_three_segments_the_last_short": (
        pendulum(6),
        QmdSettings(fdf=0, segment=2, encoder=Encoder.PAPER),
        True,
    ),
    "two_byte_indices_b_9": (pendulum(6), QmdSettings(fdf=2, bits=9, encoder=Encoder.PLAIN), True),
    "all_columns_fixed": (pendulum(6), QmdSettings(fdf=3, encoder=Encoder.PLAIN), True),
    "one_frame": (pendulum(1), QmdSettings(fdf=1, encoder=Encoder.PLAIN), True),
    "no_skeleton_block": (pendulum(6), QmdSettings(fdf=1, encoder=Encoder.PLAIN), False),
}


def golden(name):
    return (GOLDEN / f"{name}.qmd").read_bytes()


@pytest.mark.parametrize("name", SHOWN)
def test_decode_of_a_golden_file_gives_the_motion_it_was_made_from(name):
    motion, _, _ = SHOWN[name]
    decoded = decode(golden(name), pendulum_skeleton())
    assert decoded.skeleton == pendulum_skeleton()
    assert decoded.fps == 30.0
    np.testing.assert_allclose(decoded.X, motion.X, atol=0.005)


@pytest.mark.parametrize("name", SHOWN)
def test_decode_of_a_golden_file_elsewhere_gives_the_same(name):
    _, poses, _ = decode_elsewhere(golden(name))
    in_file_units = decode(golden(name), pendulum_skeleton()).X / [0.0254 / 0.45, 1, 1]
    assert np.array_equal(np.array(poses, np.float32), in_file_units.astype(np.float32))


@pytest.mark.parametrize("name", SHOWN)
def test_encode_still_writes_the_golden_payload(name):
    motion, settings, with_skeleton = SHOWN[name]
    written, kept = parse(encode(motion, settings, with_skeleton=with_skeleton).data), parse(golden(name))
    assert bytes(written.payload) == bytes(kept.payload)
    assert (written.encoder, written.k, written.rqt, written.segment) == (
        kept.encoder,
        kept.k,
        kept.rqt,
        kept.segment,
    )
