"""The README's example is what `qmd` says: its commands run, and their answers have its lines."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import ROOT, Qmd

README = (ROOT / "README.md").read_text(encoding="utf-8")


def example() -> list[tuple[str, list[str]]]:
    """Every command of the README with the lines it is said to print."""
    (block,) = re.findall(r"```\n(\$ qmd .*?)```", README, re.DOTALL)
    return [(head, body.splitlines()) for head, body in re.findall(r"\$ qmd (.*)\n((?:[^$\n].*\n)*)", block)]


def labels(lines: list[str]) -> list[str]:
    return [re.split(r"  +", line)[0] for line in lines]


def test_example_runs_and_prints_its_lines(qmd: Qmd, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "resources").symlink_to(ROOT / "resources")
    monkeypatch.chdir(tmp_path)
    commands = example()
    assert [command.split()[0] for command, _ in commands] == ["encode", "info", "decode"]
    for command, printed in commands:
        outcome = qmd.line(command)
        assert outcome.code == 0, outcome.err
        assert labels(outcome.out.splitlines()) == labels(printed)


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#:]+)\)", README))
def test_link_leads_somewhere(target: str) -> None:
    assert (ROOT / target).exists()
