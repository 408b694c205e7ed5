"""`qmd size` gives the size columns of the paper's two tables."""

import pytest
from command_line import Qmd
from paper_tables import PAPER_SIZES

KEYS = {"bytes", "header_bytes", "table_bytes", "exact_bytes", "index_bytes", "pose_bytes"}
TOLERANCE_KB = 0.15


@pytest.mark.parametrize(("name", "frames", "fdf", "bits", "segment", "kb"), PAPER_SIZES)
def test_size_is_the_papers(qmd: Qmd, name: str, frames: int, fdf: int, bits: int, segment: int, kb: float) -> None:
    words = f"size --frames {frames} --dofs 62 --fdf {fdf} --bits {bits} --segment {segment} --json"
    sizes = qmd(*words.split()).json
    assert set(sizes) == KEYS
    assert abs(sizes["bytes"] / 1024 - kb) <= TOLERANCE_KB
    assert sum(sizes[key] for key in KEYS - {"bytes"}) == sizes["bytes"]


def test_size_for_people_says_bytes_and_kb(qmd: Qmd) -> None:
    outcome = qmd.line("size --frames 343 --dofs 62 --fdf 6 --bits 8 --segment 0")
    assert outcome.code == 0
    assert "28,725 bytes (28.1 KB)" in outcome.out


def test_more_exact_columns_than_columns_is_a_mistake_of_usage(qmd: Qmd) -> None:
    outcome = qmd.line("size --frames 10 --dofs 5 --fdf 6 --bits 8 --segment 0 --json")
    assert outcome.code == 2
    assert outcome.json["wanted"] == "--fdf 0 to 5"
