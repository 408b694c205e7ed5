"""How the tests of the command line call it, and the motions they give it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from generated_motion import walker

from qmd_studio import registry
from qmd_studio.cli.main import main
from qmd_studio.formats.asf_write import write_asf
from qmd_studio.motion.motion import Motion

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Outcome:
    """What one call of `qmd` left: its exit code and what it wrote to either stream."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        (line,) = self.out.splitlines()
        return json.loads(line)


class Qmd:
    """Calls `qmd` in this process; `capsys` holds what it printed."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *words: object) -> Outcome:
        self._capsys.readouterr()
        code = main([str(word) for word in words])
        out, err = self._capsys.readouterr()
        return Outcome(code, out, err)

    def line(self, words: str) -> Outcome:
        """Call with the words of one line, none of which holds a space."""
        return self(*words.split())


def write_walk(folder: Path, *, n_frames: int = 60) -> Path:
    """Write a generated walk as `07_01.amc` with its `07.asf` beside it, and return the path of the motion."""
    motion = walker(n_frames)
    (folder / "07.asf").write_bytes(write_asf(motion.skeleton))
    return write_motion(folder / "07_01.amc", motion)


def write_motion(path: Path, motion: Motion) -> Path:
    """Write one file in the format of its suffix, nothing beside it, and return its path."""
    path.write_bytes(registry.encode_motion(path.suffix, motion))
    return path
