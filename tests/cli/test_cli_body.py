"""`qmd body` looks at bodies and converts them."""

from pathlib import Path

import numpy as np
import pytest

from qmd_studio.registry import open_file

GOLDEN = Path(__file__).parents[1] / "formats" / "golden"


def test_info_says_what_a_body_has_and_what_its_file_breaks(qmd):
    outcome = qmd("body", "info", str(GOLDEN / "hanim11.wrl"), "--json")
    values = outcome.json
    assert outcome.code == 0
    assert {name: values[name] for name in ("joints", "segments", "sites", "triangles", "influences", "loa")} == {
        "joints": 2,
        "segments": 1,
        "sites": 0,
        "triangles": 3,
        "influences": 3,
        "loa": 0,
    }
    assert "less than 1" in values["warnings"][0]
    assert "at most 3 joints a vertex" in qmd("body", "info", str(GOLDEN / "hanim11.wrl")).out


@pytest.mark.parametrize("suffix", [".x3d", ".x3dv", ".wrl", ".x3dz", ".wrz"])
@pytest.mark.parametrize("motion", ["frames", "interpolators", "none"])
def test_convert_keeps_body_and_motion(qmd, tmp_path, suffix, motion):
    out = tmp_path / f"ten{suffix}"
    outcome = qmd("body", "convert", str(GOLDEN / "hanim10.wrl"), str(out), "--motion", motion, "--json")
    assert outcome.code == 0
    assert outcome.json["bytes"] == out.stat().st_size
    one, other = open_file(GOLDEN / "hanim10.wrl"), open_file(out)
    assert np.array_equal(one.body.surface.vertices, other.body.surface.vertices)
    assert other.motion.n_frames == (1 if motion == "none" else 61)


def test_convert_refuses_what_would_be_lost(qmd, tmp_path):
    outcome = qmd("body", "convert", str(GOLDEN / "hanim10.wrl"), str(tmp_path / "a.bvh"))
    assert outcome.code == 1
    assert "no body" in outcome.err
    assert not list(tmp_path.iterdir())


def test_a_unit_can_be_set(qmd):
    outcome = qmd("body", "info", str(GOLDEN / "hanim10.wrl"), "--metres-per-unit", "2", "--json")
    assert outcome.json["height_m"] == pytest.approx(1.9, abs=0.01)
    assert qmd("body", "info", str(GOLDEN / "hanim10.wrl"), "--metres-per-unit", "0").code == 2
