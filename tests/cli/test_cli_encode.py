"""`qmd encode`: one file, its size and its error, as the person who opens it will find them."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import Qmd, write_motion, write_walk
from corpus import corpus_file
from generated_motion import walker

KEYS = {
    "bytes", "payload_bytes", "frames", "dofs", "def", "mean_mm", "p99_mm", "max_mm", "worst_joint", "worst_frame",
    "seconds", "encoder", "fdf", "bits", "segments",
}  # fmt: skip
INFO_KEYS = {
    "format", "profile", "frames", "fps", "dofs", "joints", "duration_s", "fdf", "bits", "segment", "segments",
    "encoder", "payload_bytes", "bytes", "ram_bytes", "instructions_per_frame",
}  # fmt: skip
SETTINGS = [
    ("", (6, 8, 0, "closed")),
    ("--fdf 0 --bits 10 --segment 20", (0, 10, 20, "closed")),
    ("--fdf 62", (62, 8, 0, "closed")),
    ("--encoder paper --k 2 --rqt 1000 --bits 9", (6, 9, 0, "paper")),
    ("--encoder paper --k inf --segment 7", (6, 8, 7, "paper")),
    ("--encoder paper --buckets width", (6, 8, 0, "paper")),
    ("--encoder plain", (6, 8, 0, "plain")),
]


@pytest.mark.parametrize(("options", "expected"), SETTINGS)
def test_encode_writes_what_info_and_size_say(
    qmd: Qmd, walk: Path, tmp_path: Path, options: str, expected: tuple[int, int, int, str]
) -> None:
    out = tmp_path / "walk.qmd"
    outcome = qmd("encode", walk, out, *options.split(), "--json")
    assert outcome.code == 0
    encoded, info = outcome.json, qmd("info", out, "--json").json
    fdf, bits, segment, _ = expected
    size = qmd.line(f"size --frames 59 --dofs 62 --fdf {fdf} --bits {bits} --segment {segment} --json").json
    assert set(encoded) == KEYS
    assert set(info) == INFO_KEYS
    assert (info["fdf"], info["bits"], info["segment"], info["encoder"]) == expected
    assert (encoded["frames"], encoded["dofs"]) == (info["frames"], info["dofs"]) == (60, 62)
    assert encoded["bytes"] == info["bytes"] == out.stat().st_size
    assert encoded["payload_bytes"] == info["payload_bytes"] == size["bytes"]


def test_error_told_is_the_error_found(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "walk.qmd"
    told = qmd("encode", walk, out, "--encoder", "paper", "--json").json
    found = qmd("measure", walk, out, "--json").json
    for key in ("def", "mean_mm", "p99_mm", "max_mm"):
        assert told[key] == pytest.approx(found[key], rel=1e-2), key
    assert (told["worst_joint"], told["worst_frame"]) == (found["worst_joint"], found["worst_frame"])


def test_closed_loop_is_the_default_and_closer(qmd: Qmd, tmp_path: Path) -> None:
    walk = write_walk(tmp_path, n_frames=343)
    closed = qmd("encode", walk, tmp_path / "closed.qmd", "--json").json
    paper = qmd("encode", walk, tmp_path / "paper.qmd", "--encoder", "paper", "--json").json
    assert closed["payload_bytes"] == paper["payload_bytes"]
    assert closed["def"] < paper["def"] / 10


@pytest.mark.corpus
@pytest.mark.parametrize(("take", "paper_def"), [("02_01", 0.480), ("02_02", 1.474), ("05_03", 27.39)])
def test_papers_error_and_thirty_times_less_on_real_motion(
    qmd: Qmd, tmp_path: Path, take: str, paper_def: float
) -> None:
    path = corpus_file(f"cmu_asfamc/{take}.amc")
    paper = qmd("encode", path, tmp_path / "paper.qmd", "--encoder", "paper", "--json").json
    closed = qmd("encode", path, tmp_path / "closed.qmd", "--json").json
    assert paper["def"] == pytest.approx(paper_def, rel=0.03)
    assert closed["def"] <= paper["def"] / 30
    assert closed["payload_bytes"] == paper["payload_bytes"]


def test_one_frame_is_a_pose_and_nothing_else(qmd: Qmd, tmp_path: Path) -> None:
    write_walk(tmp_path)
    pose = write_motion(tmp_path / "07_09.amc", walker(1))
    encoded = qmd("encode", pose, tmp_path / "pose.qmd", "--json").json
    size = qmd.line("size --frames 0 --dofs 62 --fdf 6 --bits 8 --segment 0 --json").json
    assert encoded["payload_bytes"] == size["bytes"]
    assert encoded["max_mm"] == pytest.approx(0, abs=1e-3)


def test_more_exact_columns_than_the_motion_has_is_an_input_error(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("encode", walk, tmp_path / "walk.qmd", "--fdf", "63", "--json")
    assert outcome.code == 1
    assert outcome.json["wanted"] == "0 to 62"
    assert outcome.json["file"] == str(walk)
    assert not (tmp_path / "walk.qmd").exists()


def test_other_suffix_is_a_mistake_of_usage(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    assert qmd("encode", walk, tmp_path / "walk.bvh").code == 2


def test_folder_that_is_not_there_is_an_input_error(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("encode", walk, tmp_path / "nowhere" / "walk.qmd", "--json")
    assert outcome.code == 1
    assert outcome.json["file"].endswith("walk.qmd")


def test_bounded_file_says_what_was_found_and_keeps_its_bound(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "walk.qmd"
    told = qmd("encode", walk, out, "--encoder", "bounded", "--max-error-mm", "0.5", "--json").json
    info = qmd("info", out, "--json").json
    assert told["max_mm"] <= 0.5
    assert qmd("measure", walk, out, "--json").json["max_mm"] <= 0.5
    assert (info["encoder"], info["fdf"], info["bits"]) == ("bounded", told["fdf"], told["bits"])
    assert told["bytes"] == info["bytes"] == out.stat().st_size
    assert "FDF" in qmd("encode", walk, out, "--encoder", "bounded", "--max-error-mm", "0.5").out
    assert "bounded encoder within 0.5 mm" in qmd("info", out).out


@pytest.mark.parametrize("options", ["--encoder bounded", "--max-error-mm 1", "--encoder bounded --max-error-mm 0"])
def test_bound_and_bounded_encoder_go_together(qmd: Qmd, walk: Path, tmp_path: Path, options: str) -> None:
    outcome = qmd("encode", walk, tmp_path / "walk.qmd", *options.split())
    assert outcome.code == 2
    assert not (tmp_path / "walk.qmd").exists()


def test_bound_that_cannot_be_kept_says_which_can(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    outcome = qmd("encode", walk, tmp_path / "walk.qmd", *["--encoder", "bounded", "--max-error-mm", "1e-9"], "--json")
    assert outcome.code != 0
    assert "best that can be reached" in outcome.json["got"]


@pytest.mark.parametrize(
    ("options", "key", "most"),
    [("", "mean_mm", 0.5), ("--mean-error-mm 1", "mean_mm", 1.0), ("--max-error-mm 4 --segment 20", "max_mm", 4.0)],
)
def test_compact_profile_keeps_to_the_error_and_info_says_so(
    qmd: Qmd, walk: Path, tmp_path: Path, options: str, key: str, most: float
) -> None:
    out = tmp_path / "walk.qmd"
    encoded = qmd("encode", walk, out, "--profile", "compact", *options.split(), "--json").json
    found = qmd("measure", walk, out, "--json").json
    info = qmd("info", out, "--json").json
    assert found[key] <= most
    assert encoded[key] == pytest.approx(found[key], rel=1e-3)
    assert (info["profile"], info["segments"]) == ("compact", 3 if "--segment" in options else 1)
    assert encoded["bytes"] == info["bytes"] == out.stat().st_size
    assert encoded["payload_bytes"] == info["payload_bytes"] < 60 * 62


@pytest.mark.parametrize(
    "options",
    ["--mean-error-mm 1", "--profile compact --mean-error-mm 1 --max-error-mm 2", "--profile compact --fdf 3",
     "--profile compact --mean-error-mm 0", "--profile compact --every 2",
     "--encoder bounded --max-level 3", "--profile compact --encoder paper"],
)  # fmt: skip
def test_compact_options_that_contradict_each_other_are_refused(
    qmd: Qmd, walk: Path, tmp_path: Path, options: str
) -> None:
    assert qmd("encode", walk, tmp_path / "walk.qmd", *options.split()).code == 2


def test_encode_of_every_fourth_frame_tells_the_error_of_all(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    full, less = tmp_path / "full.qmd", tmp_path / "less.qmd"
    whole = qmd("encode", walk, full, "--json").json
    reduced = qmd("encode", walk, less, "--every", 4, "--max-level", 3, "--json").json
    info = qmd("info", less, "--json").json
    assert set(reduced) == KEYS
    assert (reduced["frames"], reduced["dofs"]) == (info["frames"], info["dofs"])
    assert (info["frames"], info["fps"]) == (15, 30.0)
    assert info["dofs"] < 62
    assert reduced["payload_bytes"] < whole["payload_bytes"]
    assert reduced["mean_mm"] > whole["mean_mm"]
    assert "kept" in qmd("encode", walk, less, "--every", 4).out
    assert qmd("encode", walk, less, "--max-loa", 1).code == 1
