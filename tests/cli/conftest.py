from pathlib import Path

import pytest
from command_line import Qmd, write_walk


@pytest.fixture
def qmd(capsys: pytest.CaptureFixture[str]) -> Qmd:
    return Qmd(capsys)


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    return write_walk(tmp_path)
