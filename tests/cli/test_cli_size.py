"""`qmd size` gives the size columns of the paper's two tables."""

import pytest
from command_line import Qmd

KEYS = {"bytes", "header_bytes", "table_bytes", "exact_bytes", "index_bytes", "pose_bytes"}
TOLERANCE_KB = 0.15

TABLE_1 = [
    ("jog", 136, 11.9),
    ("run_Leap", 251, 20.9),
    ("stride", 298, 24.6),
    ("walk", 343, 28.1),
    ("jump", 351, 28.7),
    ("basketball", 396, 32.3),
    ("forward jump", 415, 33.7),
    ("dance", 434, 35.2),
    ("play piano", 691, 55.3),
    ("play drums", 804, 64.1),
    ("play violin", 804, 64.1),
    ("sword play", 2251, 177.2),
]
TABLE_2 = [
    ("jog", 136, 11, 9, 30, 29.7),
    ("run_Leap", 251, 11, 10, 120, 48.1),
    ("stride", 298, 1, 8, 120, 22.2),
    ("walk", 343, 1, 10, 330, 50.5),
    ("jump", 351, 26, 10, 300, 68.6),
    ("basketball", 396, 11, 10, 210, 64.7),
    ("forward jump", 415, 6, 10, 90, 75.4),
    ("dance", 434, 1, 8, 150, 30.8),
    ("play piano", 691, 26, 10, 60, 167.2),
]
ROWS = [(f"{name}, whole", frames, 6, 8, 0, kb) for name, frames, kb in TABLE_1] + TABLE_2


@pytest.mark.parametrize(("name", "frames", "fdf", "bits", "segment", "kb"), ROWS, ids=[row[0] for row in ROWS])
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
