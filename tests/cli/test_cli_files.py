"""`qmd info` and `qmd convert`: what files hold, and the same motion in other formats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command_line import Qmd
from corpus import corpus_file

from qmd_studio import registry
from qmd_studio.codecs.qmd.encode import encode

INFO_KEYS = {"format", "frames", "fps", "dofs", "joints", "duration_s"}


def test_info_of_a_generated_walk(qmd: Qmd, walk: Path) -> None:
    assert qmd("info", walk, "--json").json == {
        "format": "amc",
        "frames": 60,
        "fps": 120.0,
        "dofs": 62,
        "joints": 31,
        "duration_s": 0.5,
    }


def test_info_for_people_notes_what_was_assumed(qmd: Qmd, walk: Path) -> None:
    outcome = qmd("info", walk)
    assert outcome.code == 0
    assert "60 at 120 fps, 0.50 s" in outcome.out
    assert "120 fps" in outcome.err


@pytest.mark.corpus
@pytest.mark.parametrize(
    ("file", "frames", "dofs", "joints"),
    [
        ("cmu_asfamc/02_01.amc", 343, 62, 31),
        ("cmu_asfamc/05_03.amc", 434, 62, 31),
        ("other_asfamc/endorphin_walking.amc", 1741, 87, 34),
        ("bvh/fairmotion_01_01.bvh", 2752, 96, 31),
        ("bvh/possumwood_49_06.bvh", 482, 132, 43),
    ],
)
def test_info_of_real_motions(qmd: Qmd, file: str, frames: int, dofs: int, joints: int) -> None:
    info = qmd("info", corpus_file(file), "--json").json
    assert set(info) == INFO_KEYS
    assert (info["format"], info["frames"], info["dofs"], info["joints"]) == (file[-3:], frames, dofs, joints)
    assert info["fps"] == pytest.approx(120, rel=1e-3)
    assert info["duration_s"] == pytest.approx(info["frames"] / info["fps"])


@pytest.mark.corpus
def test_incomplete_last_frame_is_a_warning(qmd: Qmd) -> None:
    outcome = qmd("info", corpus_file("cmu_asfamc/07_12.amc"), "--json")
    assert outcome.code == 0
    assert outcome.json["frames"] == 244
    (warning,) = outcome.json["warnings"]
    assert "7352" in warning
    assert "61 of 62" in warning
    assert outcome.err == f"warning: {warning}\n"


def test_skeleton_is_taken_from_the_option(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    lonely = tmp_path / "elsewhere"
    lonely.mkdir()
    moved = walk.rename(lonely / "dance.amc")
    assert qmd("info", moved).code == 1
    assert qmd("info", moved, "--skeleton", tmp_path / "07.asf").code == 0


def test_converted_amc_opens_by_itself(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    folder = tmp_path / "new"
    folder.mkdir()
    outcome = qmd("convert", walk, folder / "copy.amc", "--json")
    assert outcome.code == 0
    assert sorted(path.name for path in folder.iterdir()) == ["copy.amc", "copy.asf"]
    before, after = registry.open_file(walk).motion, registry.open_file(folder / "copy.amc").motion
    assert before is not None
    assert after is not None
    np.testing.assert_allclose(after.X, before.X, atol=1e-9)


def test_skeleton_that_is_there_is_not_written_again(qmd: Qmd, walk: Path) -> None:
    assert qmd("convert", walk, walk.with_name("07_02.amc")).code == 0
    assert sorted(path.name for path in walk.parent.glob("*.asf")) == ["07.asf"]


def test_skeleton_of_another_figure_is_left_alone_with_a_warning(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    other = tmp_path / "07.asf"
    shrunk = other.read_text().replace("length 0.", "length 1.")
    folder = tmp_path / "new"
    folder.mkdir()
    (folder / "copy.asf").write_text(shrunk)
    outcome = qmd("convert", walk, folder / "copy.amc", "--json")
    assert outcome.code == 0
    assert "another skeleton" in outcome.json["warnings"][0]
    assert (folder / "copy.asf").read_text() == shrunk


def test_frame_rate_is_overridden(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    assert qmd("convert", walk, tmp_path / "slow.bvh", "--fps", "60").code == 0
    assert qmd("info", tmp_path / "slow.bvh", "--json").json["fps"] == 60


@pytest.mark.corpus
def test_pair_that_needs_retargeting_is_refused_with_that_reason(qmd: Qmd, tmp_path: Path) -> None:
    out = tmp_path / "walk.bap"
    outcome = qmd("convert", corpus_file("cmu_asfamc/02_01.amc"), out, "--json")
    assert outcome.code == 1
    assert "retarget" in " ".join(str(value) for value in outcome.json.values())
    assert outcome.json["file"] == str(out)
    assert not out.exists()


def test_unknown_suffix_leaves_nothing_behind(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("convert", walk, tmp_path / "walk.mp3", "--json")
    assert outcome.code == 1
    assert ".mp3" in outcome.json["got"]
    assert outcome.json["file"] == str(tmp_path / "walk.mp3")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["07.asf", "07_01.amc"]


def test_motion_is_not_lost_in_a_skeleton_file(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("convert", walk, tmp_path / "copy.asf", "--json")
    assert outcome.code == 1
    assert ".amc" in outcome.json["hint"]
    assert not (tmp_path / "copy.asf").exists()
    assert qmd("convert", walk.with_name("07.asf"), tmp_path / "copy.asf").code == 0


def test_file_without_skeleton_plays_on_its_motion_but_not_on_an_asf_of_unknown_order(
    qmd: Qmd, walk: Path, tmp_path: Path
) -> None:
    motion = registry.open_file(walk).motion
    assert motion is not None
    bare, out = tmp_path / "bare.qmd", tmp_path / "out.npz"
    bare.write_bytes(encode(motion, with_skeleton=False).data)
    asf = walk.with_name("07.asf")

    alone = qmd("decode", bare, out, "--json")
    assert (alone.code, alone.json["file"]) == (1, str(bare))
    assert "--skeleton" in alone.json["hint"]
    refused = qmd("convert", bare, out, "--skeleton", asf, "--json")
    assert (refused.code, refused.json["file"]) == (1, str(asf))
    assert qmd("convert", bare, out, "--skeleton", walk).code == 0
    assert qmd("measure", walk, out, "--json").json["max_mm"] < 20

    whole = tmp_path / "whole.qmd"
    whole.write_bytes(encode(motion).data)
    assert qmd("measure", walk, whole, "--skeleton", asf).code == 0  # it has its own: the ASF is the AMC's


def test_info_of_a_qmd_says_what_playing_takes(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "walk.qmd"
    qmd("encode", walk, out)
    anywhere = qmd("info", out, "--json").json
    assert anywhere["ram_bytes"] > out.stat().st_size
    assert 400 < anywhere["instructions_per_frame"] < 600
    on_device = qmd("info", out, "--device", "cortex-m4", "--json").json
    assert set(on_device) == set(anywhere) | {"device", "cpu_percent", "ram_percent"}
    assert on_device["instructions_per_frame"] == anywhere["instructions_per_frame"]
    assert on_device["ram_bytes"] < 1000
    assert 0 < on_device["cpu_percent"] < 1
    assert "Cortex-M4F" in qmd("info", out, "--device", "cortex-m4").out


def test_info_of_a_device_that_is_not_known_names_those_that_are(qmd: Qmd, walk: Path) -> None:
    outcome = qmd("info", walk, "--device", "toaster", "--json")
    assert outcome.code == 2
    assert "esp32" in outcome.json["wanted"]
    outcome = qmd("info", walk, "--device", "esp32", "--json")
    assert outcome.code == 2
    assert "QMD" in outcome.json["error"]
