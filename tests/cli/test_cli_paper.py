"""`qmd table`, `qmd figure` and `qmd batch`: the paper's results beside ours, and many files at once."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from command_line import Qmd, write_motion
from corpus import CORPUS, corpus_file
from generated_motion import walker

from qmd_studio.tuning.paper_tables import TABLE_1, TABLE_2


def test_the_formula_gives_the_papers_sizes() -> None:
    for row in (*TABLE_1, *TABLE_2):
        assert row.formula_kb == pytest.approx(row.qmd_kb, abs=0.11), row.take.name
        assert (row.take.n_frames + 1) * 62 * 4 / 1024 == pytest.approx(row.raw_kb, abs=0.1), row.take.name


@pytest.mark.corpus
def test_table_1_stands_beside_ours_and_says_what_is_what(qmd: Qmd) -> None:
    corpus_file("cmu_asfamc/02_01.amc")
    rows = {row["name"]: row for row in qmd("table", 1, "--corpus", CORPUS, "--json").json["rows"]}
    assert len(rows) == 12
    assert rows["walk"]["def"] == pytest.approx(0.480, rel=0.03)
    assert rows["dance"]["def"] == pytest.approx(27.39, rel=0.03)
    assert rows["walk"]["closed_def"] < rows["walk"]["def"] / 30
    assert rows["walk"]["mark"] == ""
    assert "rebuilt" in rows["jump"]["mark"]
    assert "02_02" in rows["stride"]["mark"]
    assert "def" not in rows["jog"]
    assert "not in the corpus" in rows["jog"]["mark"]
    assert rows["jog"]["kb"] == pytest.approx(11.9, abs=0.1)


@pytest.mark.corpus
def test_table_2_has_our_optimum_and_dance_is_the_papers(qmd: Qmd) -> None:
    corpus_file("cmu_asfamc/05_03.amc")
    rows = {row["name"]: row for row in qmd("table", 2, "--corpus", CORPUS, "--json").json["rows"]}
    optimum = rows["dance"]["optimum"]
    assert (optimum["fdf"], optimum["bits"], optimum["segment"]) == (1, 8, 150)
    assert rows["walk"]["optimum"]["merit"] <= rows["walk"]["def"] * rows["walk"]["kb"] * 1024


def test_a_corpus_that_lacks_everything_shows_sizes_only(qmd: Qmd, tmp_path: Path) -> None:
    rows = qmd("table", 2, "--corpus", tmp_path, "--json").json["rows"]
    assert all("def" not in row and row["kb"] > 0 for row in rows)
    assert qmd("table", 2, "--corpus", tmp_path / "gone").code == 1


def test_figures_are_drawn(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    told = qmd("figure", 5, "-o", tmp_path / "5.svg", "--json").json
    assert (told["n"], told["m"]) == (100, 62)
    assert (tmp_path / "5.svg").read_text().startswith("<?xml")
    told = qmd("figure", 5, walk, "-o", tmp_path / "walk.png", "--json").json
    assert (told["n"], told["m"]) == (59, 62)
    assert (tmp_path / "walk.png").read_bytes().startswith(b"\x89PNG")
    told = qmd("figure", 6, walk, "-o", tmp_path / "6.svg", "--json").json
    assert set(told["def"]) == {"8", "9", "10", "11"}
    assert all(len(values) == 63 and values[0] > values[-1] for values in told["def"].values())
    assert told["def"]["11"][0] < told["def"]["8"][0]


def test_figures_of_no_motion_or_no_format_are_refused(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    assert qmd("figure", 6, "-o", tmp_path / "6.svg").code == 2
    outcome = qmd("figure", 6, walk, "-o", tmp_path / "6.gif", "--json")
    assert outcome.code == 1
    assert ".svg" in outcome.json["wanted"]


def test_without_matplotlib_the_way_to_it_is_told(qmd: Qmd, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    outcome = qmd("figure", 5, "-o", tmp_path / "5.svg", "--json")
    assert outcome.code == 1
    assert "plots" in outcome.json["hint"]


def test_a_batch_does_a_folder_and_goes_on(qmd: Qmd, tmp_path: Path) -> None:
    folder, out = tmp_path / "in", tmp_path / "out"
    folder.mkdir()
    for seed in range(2):
        write_motion(folder / f"walk{seed}.npz", walker(60, seed=seed))
    (folder / "broken.bvh").write_text("HIERARCHY")
    (folder / "notes.txt").write_text("not a motion")
    words = ("batch", folder, "-o", out, "--encoder", "paper,closed", "--fdf", "0,6", "--jobs", 1, "--json")
    outcome = qmd(*words)
    told = outcome.json
    assert outcome.code == 1  # one file could not be read; the others are done
    assert (told["files"], told["failed"], told["rows"], told["done_before"]) == (3, 1, 8, 0)
    assert "broken.bvh" in told["warnings"][0]
    with (out / "batch.csv").open(newline="") as stream:
        assert len(list(csv.DictReader(stream))) == 8
    assert len(list((out / "logs").iterdir())) == 3
    again = qmd(*words).json
    assert (again["done_before"], again["rows"]) == (2, 8)
    (folder / "broken.bvh").unlink()
    assert qmd(*words).code == 0


def test_a_batch_of_nothing_is_a_mistake_of_usage(qmd: Qmd, tmp_path: Path) -> None:
    assert qmd("batch", tmp_path, "-o", tmp_path / "out").code == 2
    assert qmd("batch", tmp_path, "-o", tmp_path / "out", "--encoder", "magic").code == 2
