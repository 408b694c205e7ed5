"""`qmd retarget`: a motion on another body from the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from qmd_studio import registry
from qmd_studio.formats.loaded import ReadOptions
from tests.cli.command_line import write_motion, write_walk
from tests.motion.retarget_figures import figure, swinging


def test_walk_becomes_parameters_and_says_how_well(qmd, tmp_path):
    walk, out = write_walk(tmp_path), tmp_path / "walk.bap"
    done = qmd("retarget", walk, out, "--json")
    assert done.code == 0
    answer = done.json
    assert answer["mapped"] > 60
    assert answer["unmapped_joints"] == ["rhipjoint", "lhipjoint"] or answer["unmapped"] <= 4
    assert 0 <= answer["clamped_share"] <= 1
    assert 0 <= answer["mean_angle_error_deg"] < 5
    motion = registry.open_file(out).motion
    assert (motion.n_frames, motion.fps) == (60, 120.0)
    assert np.ptp(motion.X, axis=0).max() > 0.1


def test_map_is_written_edited_and_taken(qmd, tmp_path):
    walk, out, saved = write_walk(tmp_path), tmp_path / "walk.bap", tmp_path / "map.json"
    assert qmd("retarget", walk, out, "--save-map", saved).code == 0
    content = json.loads(saved.read_text())
    content["joints"] = [row for row in content["joints"] if "elbow" not in " ".join(row["targets"])]
    saved.write_text(json.dumps(content))
    done = qmd("retarget", walk, out, "--map", saved, "--json")
    assert done.code == 0
    assert "lradius" in done.json["unmapped_joints"]


def test_damaged_map_is_refused_with_its_name(qmd, tmp_path):
    walk, saved = write_walk(tmp_path), tmp_path / "map.json"
    saved.write_text('{"joint map": 1, "joints": [{"source": "nobody", "targets": ["l_knee"]}]}')
    done = qmd("retarget", walk, tmp_path / "walk.bap", "--map", saved)
    assert done.code == 1
    assert "map.json" in done.err
    assert "nobody" in done.err
    assert not (tmp_path / "walk.bap").exists()


@pytest.mark.parametrize("words", [("rest",), ("zero",), ("frame", "3")])
def test_alignment_is_the_users_choice(qmd, tmp_path, words):
    assert qmd("retarget", write_walk(tmp_path), tmp_path / "walk.bap", "--align", *words).code == 0


@pytest.mark.parametrize(("words", "code"), [(("frame",), 2), (("frame", "x"), 2), (("up",), 2), (("frame", "60"), 1)])
def test_alignment_that_is_none_is_refused(qmd, tmp_path, words, code):
    done = qmd("retarget", write_walk(tmp_path), tmp_path / "walk.bap", "--align", *words, "--json")
    assert done.code == code
    assert done.json["error"]


def test_body_is_any_files_skeleton(qmd, tmp_path):
    body = write_motion(tmp_path / "body.bvh", swinging(figure("xsens"), 2))
    out = tmp_path / "walk.bvh"
    options = ("--limits", "keep", "--pin-feet", "--fps", "30")
    done = qmd("retarget", write_walk(tmp_path), out, "--body", body, *options, "--json")
    assert done.code == 0
    loaded = registry.open_file(out, ReadOptions())
    assert loaded.motion.fps == 30
    assert "LeftKnee" in loaded.skeleton.node_names


def test_parameters_want_an_hanim_body(qmd, tmp_path):
    body = write_motion(tmp_path / "body.bvh", swinging(figure("mixamo"), 2))
    done = qmd("retarget", write_walk(tmp_path), tmp_path / "walk.bap", "--body", body)
    assert done.code == 1
    assert "H-Anim" in done.err
    hanim = write_motion(tmp_path / "hanim.bvh", swinging(figure("H-Anim 1", arms_down=1.5), 2))
    assert qmd("retarget", write_walk(tmp_path), tmp_path / "walk.bap", "--body", hanim).code == 0


def test_avatar_that_does_not_ship_is_refused(qmd, tmp_path):
    done = qmd("retarget", write_walk(tmp_path), tmp_path / "walk.bap", "--body", "nobody-at-all")
    assert done.code == 1
    assert "no avatar" in done.err
