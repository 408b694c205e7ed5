"""`qmd decode`: the motion of a QMD file in formats that other programs read."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import Qmd


@pytest.fixture
def packed(qmd: Qmd, walk: Path) -> Path:
    path = walk.with_suffix(".qmd")
    assert qmd("convert", walk, path).code == 0
    return path


@pytest.mark.parametrize("suffix", [".amc", ".bvh"])
def test_decoded_file_is_as_close_as_the_qmd_file(
    qmd: Qmd, walk: Path, packed: Path, tmp_path: Path, suffix: str
) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    out = folder / f"walk{suffix}"
    assert qmd("decode", packed, out).code == 0
    assert qmd("info", out, "--json").json["frames"] == 60
    if suffix == ".amc":  # measured on one skeleton; a BVH's root is another one
        assert (folder / "walk.asf").exists()
        before, after = (qmd("measure", walk, file, "--json").json for file in (packed, out))
        assert after["def"] == pytest.approx(before["def"], rel=1e-3)


def test_file_that_is_no_qmd_is_refused(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("decode", walk, tmp_path / "out.bvh", "--json")
    assert outcome.code == 1
    assert outcome.json["file"] == str(walk)
    assert "not a QMD file" in outcome.json["error"]
    assert not (tmp_path / "out.bvh").exists()


def test_damaged_file_is_refused_with_its_place(qmd: Qmd, packed: Path, tmp_path: Path) -> None:
    data = bytearray(packed.read_bytes())
    data[len(data) // 2] ^= 0x10
    packed.write_bytes(data)
    outcome = qmd("decode", packed, tmp_path / "out.bvh", "--json")
    assert outcome.code == 1
    assert "damaged" in outcome.json["error"]
    assert outcome.json["at"].startswith("byte ")
    assert outcome.json["file"] == str(packed)


def test_decoding_needs_no_retargeting_by_stealth(qmd: Qmd, packed: Path, tmp_path: Path) -> None:
    outcome = qmd("decode", packed, tmp_path / "out.bap", "--json")
    assert outcome.code == 1
    assert "retarget" in " ".join(str(value) for value in outcome.json.values())
