"""The table of benchmarks keeps every row and says when one failed."""

import importlib.util
from pathlib import Path

import pytest

SPEC = importlib.util.spec_from_file_location("benchmark_run", Path(__file__).with_name("run.py"))


@pytest.fixture
def bench():
    module = importlib.util.module_from_spec(SPEC)
    SPEC.loader.exec_module(module)
    return module


def test_rows_have_five_columns_and_may_lack_a_bar(bench):
    output = "warming up | twice\nopen | 1 ms | other: 2 ms | 0.5 | at most 1\nfree | 1 s | | | \n"
    assert bench.rows_of(output) == [
        ["open", "1 ms", "other: 2 ms", "0.5", "at most 1"],
        ["free", "1 s", "", "", ""],
    ]


def test_benchmark_that_fails_keeps_its_rows_and_its_reason(bench, tmp_path):
    script = tmp_path / "broken_speed.py"
    script.write_text("print('open | 1 | 2 | 3 | 4', flush=True)\nraise SystemExit('no such | file')\n")
    assert bench.run(script) == [["open", "1", "2", "3", "4"], ["broken_speed", "failed: no such / file", "", "", ""]]
