"""`qmd tune`: the best settings, as a person and a program read them."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT, Qmd, write_walk
from corpus import corpus_file

BEST_KEYS = {
    "encoder", "fdf", "bits", "segment", "every", "max_level", "max_loa", "bytes", "file_bytes", "merit",
    "def", "mean_mm", "p99_mm", "max_mm", "worst_joint", "worst_frame", "velocity_mm_s", "acceleration_mm_s2",
}  # fmt: skip


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    return write_walk(tmp_path, n_frames=150)


def encoded(qmd: Qmd, walk: Path, best: dict) -> dict:
    options = f"--fdf {best['fdf']} --bits {best['bits']} --segment {best['segment']} --encoder {best['encoder']}"
    return qmd("encode", walk, walk.with_suffix(".qmd"), *options.split(), "--json").json


@pytest.mark.parametrize("encoder", ["paper", "closed"])
def test_the_best_is_what_encode_then_makes(qmd: Qmd, walk: Path, encoder: str) -> None:
    outcome = qmd("tune", walk, "--encoder", encoder, "--grid", "wide", "--json")
    assert outcome.code == 0
    told = outcome.json
    assert set(told) == {"evaluations", "seconds", "settings", "best"}
    assert set(told["best"]) == BEST_KEYS
    assert told["evaluations"] <= 120 < told["settings"]
    made = encoded(qmd, walk, told["best"])
    assert (made["payload_bytes"], made["bytes"]) == (told["best"]["bytes"], told["best"]["file_bytes"])
    assert made["def"] == pytest.approx(told["best"]["def"])


@pytest.mark.corpus
def test_dance_gives_the_papers_row(qmd: Qmd) -> None:
    dance = corpus_file("cmu_asfamc/05_03.amc")
    told = qmd("tune", dance, "--encoder", "paper", "--exhaustive", "--json").json
    assert (told["best"]["fdf"], told["best"]["bits"], told["best"]["segment"]) == (1, 8, 150)
    assert told["evaluations"] == told["settings"]


def test_bounds_can_be_set(qmd: Qmd, walk: Path) -> None:
    bounds = ["--fdf", "2-8:3,10", "--bits", "9", "--segments", "40,0", "--exhaustive", "--any-size"]
    told = qmd("tune", walk, *bounds, "--json").json
    assert told["evaluations"] == 8
    assert told["best"]["fdf"] in (2, 5, 8, 10)
    assert told["best"]["bits"] == 9
    text = qmd("tune", walk, *bounds).out
    assert "FDF 2 … 10; b 9; n_d 40, 149 (one segment)" in text.replace(" … 149", ", 149")


@pytest.mark.parametrize(
    ("option", "value", "key"),
    [("def", 0.05, "def"), ("mean-mm", 0.2, "mean_mm"), ("max-mm", 5, "max_mm"), ("bytes", 14_000, "bytes")],
)
def test_a_target_is_kept(qmd: Qmd, walk: Path, option: str, value: float, key: str) -> None:
    told = qmd("tune", walk, f"--target-{option}", value, "--json").json
    assert told["target"] == {"kind": option, "value": value, "met": True}
    assert told["best"][key] <= value
    assert encoded(qmd, walk, told["best"])["payload_bytes"] == told["best"]["bytes"]


def test_a_target_that_cannot_be_met_is_answered_with_the_best(qmd: Qmd, walk: Path) -> None:
    outcome = qmd("tune", walk, "--target-bytes", 10, "--json")
    assert outcome.code == 0
    assert outcome.json["target"]["met"] is False
    assert (
        outcome.json["best"]["bytes"]
        == qmd.line("size --frames 149 --dofs 62 --fdf 0 --bits 8 --segment 0 --json").json["bytes"]
    )
    assert "cannot be met; the best is" in qmd("tune", walk, "--target-kbps", "0.1").out


def test_state_is_kept_and_gone_on_with(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    state = tmp_path / "state.json"
    first = qmd("tune", walk, "--exhaustive", "--state", state, "--json").json
    second = qmd("tune", walk, "--exhaustive", "--state", state, "--json").json
    assert first["evaluations"] == first["settings"]
    assert (second["evaluations"], second["best"]) == (0, first["best"])


@pytest.mark.parametrize(
    "options",
    ["--target-def 0", "--target-def x", "--fdf 5-2", "--bits 7", "--fdf 1-9:0", "--target-def 1 --target-kbps 1"],
)
def test_mistakes_of_usage_are_told(qmd: Qmd, walk: Path, options: str) -> None:
    assert qmd("tune", walk, *options.split()).code == 2


def test_a_grid_without_any_setting_is_told(qmd: Qmd, walk: Path) -> None:
    outcome = qmd("tune", walk, "--bits", "16", "--segments", "30", "--json")
    assert outcome.code == 1
    assert "--any-size" in outcome.json["hint"]


@pytest.mark.skipif(sys.platform == "win32", reason="there are no terminals of this kind")
def test_a_long_search_shows_how_far_it_is_and_ends_by_ctrl_c(tmp_path: Path) -> None:
    try:
        ours, theirs = os.openpty()
    except OSError as problem:
        pytest.skip(f"this system gives no terminal: {problem}")
    path = write_walk(tmp_path, n_frames=3000)
    command = [
        sys.executable,
        "-m",
        "qmd_studio.cli",
        "tune",
        str(path),
        "--encoder",
        "plain",
        "--exhaustive",
        "--grid",
        "wide",
    ]
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a child of a job in the background ignores it
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=theirs) as process:
        signal.signal(signal.SIGINT, before)
        os.close(theirs)
        shown = b""
        while not re.search(rb"[1-9]\d* of \d", shown):  # what comes first is "0 of 1"
            shown += os.read(ours, 4096)
        assert b"getting ready" in shown
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
        assert process.stdout is not None
        assert process.stdout.read() == b""
    os.close(ours)


def test_fewer_frames_and_joints_are_dimensions_of_the_search(qmd: Qmd, walk: Path) -> None:
    bounds = ["--fdf", "0,6", "--bits", "8", "--segments", "0", "--exhaustive", "--encoder", "paper"]
    alone = qmd("tune", walk, *bounds, "--json").json
    outcome = qmd("tune", walk, *bounds, "--every", "1-3", "--max-level", "5,6", "--json")
    told = outcome.json
    assert told["evaluations"] == told["settings"] == 6 * alone["settings"]
    assert told["best"]["merit"] <= alone["best"]["merit"]
    assert (alone["best"]["every"], alone["best"]["max_level"], alone["best"]["max_loa"]) == (1, 6, None)
    small = qmd("tune", walk, "--every", "1-4", "--target-bytes", 4000, "--encoder", "paper", "--json").json
    assert small["target"]["met"]
    assert small["best"]["every"] > 1
    assert small["best"]["bytes"] <= 4000
    made = encoded_reduced(qmd, walk, small["best"])
    assert made["payload_bytes"] == small["best"]["bytes"]
    assert made["def"] == pytest.approx(small["best"]["def"])
    assert "every" in qmd("tune", walk, *bounds, "--every", "1-4").out


def encoded_reduced(qmd: Qmd, walk: Path, best: dict) -> dict:
    options = f"--fdf {best['fdf']} --bits {best['bits']} --segment {best['segment']} --encoder {best['encoder']}"
    options += f" --every {best['every']} --max-level {best['max_level']}"
    return qmd("encode", walk, walk.with_suffix(".qmd"), *options.split(), "--json").json


def test_the_state_of_each_reduction_is_kept(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    options = ["--exhaustive", "--every", "1,2", "--fdf", "0,6", "--state", tmp_path / "state.json", "--json"]
    first, second = (qmd("tune", walk, *options).json for _ in range(2))
    assert (first["evaluations"], second["evaluations"]) == (first["settings"], 0)
    assert first["best"] == second["best"]
    assert sorted(path.name for path in tmp_path.glob("state*")) == ["state-every2-level6.json", "state.json"]


@pytest.mark.parametrize("options", ["--every 0", "--max-level 7", "--max-loa 4", "--every x"])
def test_reductions_out_of_range_are_told(qmd: Qmd, walk: Path, options: str) -> None:
    assert qmd("tune", walk, *options.split()).code == 2
