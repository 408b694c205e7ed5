"""Mistakes on the command line and in files: one clear message, the right exit code, never a traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT, Qmd

from qmd_studio.motion.motion import FRAME_RATES

ERROR_KEYS = {"error", "file", "at", "wanted", "got", "hint"}
SIZE = "size --frames 10 --dofs 5 --fdf 1 --segment 0"
USAGE_MISTAKES = [
    "",
    "dance",
    "info",
    "info a b",
    "info a --bits 8",
    f"{SIZE} --bits 7",
    f"{SIZE} --bits 17",
    f"{SIZE} --bits eight",
    f"{SIZE}",
    "convert a.bvh b.bvh --fps 0",
    "convert a.bvh b.bvh --fps nan",
    "encode a.bvh b.qmd --encoder open",
    "encode a.bvh b.qmd --k -1",
    "encode a.bvh b.qmd --fdf -1",
    "encode a.bvh b.qmd --rqt 0",
    "measure a.bvh b.bvh --align last",
]


@pytest.mark.parametrize("words", USAGE_MISTAKES)
def test_usage_mistake_is_told_on_stderr(qmd: Qmd, words: str) -> None:
    outcome = qmd(*words.split())
    assert outcome.code == 2
    assert outcome.out == ""
    assert outcome.err.splitlines()[-1].startswith("qmd: ")
    assert "Traceback" not in outcome.err


@pytest.mark.parametrize("words", [words for words in USAGE_MISTAKES if words])
def test_usage_mistake_is_told_as_json(qmd: Qmd, words: str) -> None:
    outcome = qmd(*words.split(), "--json")
    assert outcome.code == 2
    assert set(outcome.json) == ERROR_KEYS
    assert outcome.json["error"]
    assert outcome.err == ""


def test_value_out_of_range_says_wanted_and_got(qmd: Qmd) -> None:
    error = qmd(*f"{SIZE} --bits 99 --json".split()).json
    assert (error["wanted"], error["got"]) == ("a whole number from 8 to 16", "'99'")


def test_missing_file_is_an_input_error(qmd: Qmd, tmp_path: Path) -> None:
    path = tmp_path / "absent.bvh"
    plain, told = qmd("info", path), qmd("info", path, "--json")
    assert (plain.code, told.code) == (1, 1)
    assert plain.out == ""
    assert plain.err == f"qmd: {path}: no such file or directory. Check the name and that you may read the file\n"
    assert set(told.json) == ERROR_KEYS
    assert told.json["file"] == str(path)


def test_file_of_no_known_kind_is_an_input_error(qmd: Qmd, tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("nothing moves here\n")
    outcome = qmd("info", path, "--json")
    assert outcome.code == 1
    assert outcome.json["file"] == str(path)


@pytest.mark.parametrize("suffix", [".bvh", ".qmd", ".amc", ".npz", ""])
def test_empty_file_is_called_so(qmd: Qmd, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"motion{suffix}"
    path.touch()
    outcome = qmd("info", path, "--json")
    assert (outcome.code, outcome.json["error"], outcome.json["file"]) == (1, "the file is empty", str(path))


def test_folder_in_place_of_a_file_is_called_so(qmd: Qmd, tmp_path: Path) -> None:
    outcome = qmd("info", tmp_path, "--json")
    assert (outcome.code, outcome.json["error"], outcome.json["wanted"]) == (1, "is a folder", "a file")


@pytest.mark.parametrize("rate", ["0", "-1", "nan", "inf", "1e300", "1e-300", "1e6", "fast", ""])
def test_rate_that_nothing_plays_at_is_a_mistake_of_usage(qmd: Qmd, tmp_path: Path, rate: str) -> None:
    outcome = qmd("convert", tmp_path / "in.bvh", tmp_path / "out.bvh", f"--fps={rate}", "--json")
    assert (outcome.code, outcome.json["wanted"]) == (2, "0.001 to 100000 frames a second")
    assert FRAME_RATES == (0.001, 100000)


def test_count_beyond_all_bounds_says_the_bound(qmd: Qmd) -> None:
    outcome = qmd(*f"{SIZE} --bits 8 --json".replace("10", "99999999999999", 1).split())
    assert outcome.code == 2
    assert outcome.json["wanted"] == "a whole number from 0 to 2147483648"


def test_version_is_printed(qmd: Qmd, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        qmd("--version")
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("qmd ")


def test_reader_that_goes_away_is_no_error() -> None:
    command = [sys.executable, "-m", "qmd_studio.cli", *f"{SIZE} --bits 8".split()]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        errors = process.stderr.read()
        assert process.wait(timeout=60) == 0
    assert errors == b""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_full_disk_behind_the_output_is_told() -> None:
    command = [sys.executable, "-m", "qmd_studio.cli", *f"{SIZE} --bits 8".split()]
    with open("/dev/full", "w") as full:
        run = subprocess.run(command, cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True)
    assert run.returncode == 1
    assert run.stderr == "qmd: the output could not be written: No space left on device\n"


@pytest.mark.parametrize("json", [[], ["--json"]])
def test_name_that_is_no_text_is_shown_all_the_same(json: list[str]) -> None:
    command = [
        sys.executable.encode(),
        b"-m",
        b"qmd_studio.cli",
        b"info",
        b"\xff.bvh",
        *(word.encode() for word in json),
    ]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, env={"PYTHONIOENCODING": "ascii"})
    assert run.returncode == 1
    assert b"Traceback" not in run.stderr
    assert b"dcff" in (run.stdout if json else run.stderr)


def test_module_runs_as_a_program() -> None:
    command = [sys.executable, "-m", "qmd_studio.cli.main", *f"{SIZE} --bits 8 --json".split()]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.startswith('{"bytes": ')


@pytest.mark.skipif(sys.platform == "win32", reason="a shell closes the stream")
@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-"])
def test_closed_stream_is_no_crash(closed: str) -> None:
    script = f'exec "$@" {closed}'
    command = ["sh", "-c", script, "sh", sys.executable, "-m", "qmd_studio.cli", *f"{SIZE} --bits 8".split()]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
