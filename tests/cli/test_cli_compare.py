"""`qmd compare`: codecs side by side, as a person, a program, a table and a picture have them."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from command_line import Qmd

ROW_KEYS = {
    "name", "setting", "met", "payload_bytes", "file_bytes", "bytes_per_frame", "kbps", "def", "mean_mm", "p99_mm",
    "max_mm", "worst_joint", "worst_frame", "velocity_mm_s", "acceleration_mm_s2", "encode_us", "decode_us",
    "instructions",
}  # fmt: skip


def test_json_has_both_tables(qmd: Qmd, walk: Path) -> None:
    told = qmd("compare", walk, "--mean-error-mm", 1, "--size", 9000, "--json").json
    assert set(told) == {"mean_error_mm", "size", "at_error", "at_size", "absent", "verdict"} | (
        set(told) & {"warnings"}
    )
    assert (told["mean_error_mm"], told["size"]) == (1, 9000)
    for rows in (told["at_error"], told["at_size"]):
        assert {row["name"] for row in rows} >= {"QMD paper", "QMD compact, whole clip", "float32 raw"}
        assert all(set(row) == ROW_KEYS for row in rows)
    assert all(row["mean_mm"] <= 1.001 for row in told["at_error"] if row["met"])
    assert told["verdict"][0].startswith("Smallest at 1 mm")


def test_closed_row_is_what_encode_makes(qmd: Qmd, walk: Path) -> None:
    rows = qmd("compare", walk, "--json").json["at_size"]
    (row,) = (row for row in rows if row["name"] == "QMD closed")
    words = row["setting"].split(", ")
    segment = 0 if words[2] == "one segment" else words[2].split()[1]
    options = ["--fdf", words[0].split()[1], "--bits", words[1].split()[1], "--segment", segment]
    made = qmd("encode", walk, walk.with_suffix(".qmd"), *options, "--json").json
    assert (made["payload_bytes"], made["bytes"]) == (row["payload_bytes"], row["file_bytes"])
    assert made["def"] == pytest.approx(row["def"], rel=1e-3)


def test_text_table_and_plot_are_written(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    table, plot = tmp_path / "c.csv", tmp_path / "c.svg"
    outcome = qmd("compare", walk, "--csv", table, "--plot", plot)
    assert outcome.code == 0
    assert "range + delta + pcodec" in outcome.out
    assert "Smallest at 0.5 mm" in outcome.out
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert {row["at"] for row in rows} == {"error", "size"}
    assert set(rows[0]) == ROW_KEYS | {"at"}
    assert b"<svg" in plot.read_bytes()


@pytest.mark.parametrize("options", ["--mean-error-mm 0", "--size 0", "--size x"])
def test_mistakes_of_usage_are_told(qmd: Qmd, walk: Path, options: str) -> None:
    assert qmd("compare", walk, *options.split()).code == 2


def test_motion_is_not_written_over(qmd: Qmd, walk: Path) -> None:
    before = walk.read_bytes()
    assert qmd("compare", walk, "--csv", walk).code == 2
    assert walk.read_bytes() == before


def test_plot_of_no_known_format_is_refused_before_the_work(qmd: Qmd, walk: Path) -> None:
    assert qmd("compare", walk, "--plot", walk.with_suffix(".gif"), "--json").code == 1
