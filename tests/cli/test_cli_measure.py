"""`qmd measure`: how far two motions are apart, in one figure and joint by joint."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import Qmd, write_motion

from qmd_studio import registry
from qmd_studio.motion.motion import ASF_UNIT_M, Motion
from qmd_studio.motion.skeleton import ColumnKind

KEYS = {"def", "mean_mm", "p99_mm", "max_mm", "worst_joint", "worst_frame", "velocity_mm_s", "acceleration_mm_s2"}
ASIDE_M = 0.01


def motion_of(path: Path) -> Motion:
    motion = registry.open_file(path).motion
    assert motion is not None
    return motion


@pytest.fixture
def shifted(walk: Path) -> Path:
    """The walk one centimetre aside."""
    motion = motion_of(walk)
    X = motion.X.copy()
    column = next(i for i, c in enumerate(motion.skeleton.columns) if c.kind is ColumnKind.TRANSLATION)
    X[:, column] += ASIDE_M
    return write_motion(walk.with_name("07_02.amc"), replace(motion, X=X))


def test_motion_is_no_distance_from_itself(qmd: Qmd, walk: Path) -> None:
    outcome = qmd("measure", walk, walk, "--json")
    assert outcome.code == 0
    assert set(outcome.json) == KEYS
    assert outcome.json["def"] == 0
    assert outcome.json["max_mm"] == 0


def test_walk_aside_is_that_far_from_the_walk(qmd: Qmd, walk: Path, shifted: Path) -> None:
    error = qmd("measure", walk, shifted, "--json").json
    n_points = len(motion_of(walk).skeleton.points)
    assert error["mean_mm"] == pytest.approx(10, rel=1e-6)
    assert error["max_mm"] == pytest.approx(10, rel=1e-6)
    assert error["def"] == pytest.approx(math.sqrt(n_points) * ASIDE_M / ASF_UNIT_M, rel=1e-6)
    assert error["velocity_mm_s"] == pytest.approx(0, abs=1e-3)


def test_aligned_at_the_first_frame_nothing_remains(qmd: Qmd, walk: Path, shifted: Path) -> None:
    error = qmd("measure", walk, shifted, "--align", "first", "--json").json
    assert error["max_mm"] == pytest.approx(0, abs=1e-6)


def test_table_holds_every_joint_in_every_frame(qmd: Qmd, walk: Path, shifted: Path, tmp_path: Path) -> None:
    table = tmp_path / "distances.csv"
    assert qmd("measure", walk, shifted, "--csv", table).code == 0
    with table.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    motion = motion_of(walk)
    assert header == ["frame", *motion.skeleton.point_names]
    assert [int(row[0]) for row in rows] == list(range(motion.n_frames))
    np.testing.assert_allclose([[float(cell) for cell in row[1:]] for row in rows], 10, rtol=1e-4)


def test_people_read_millimetres_joint_and_frame(qmd: Qmd, walk: Path, shifted: Path) -> None:
    outcome = qmd("measure", walk, shifted)
    assert "10 mm, " in outcome.out
    assert "frame " in outcome.out


def test_motions_of_other_lengths_are_refused(qmd: Qmd, walk: Path) -> None:
    motion = motion_of(walk)
    shorter = write_motion(walk.with_name("07_03.amc"), replace(motion, X=motion.X[:-1]))
    outcome = qmd("measure", walk, shorter, "--json")
    assert outcome.code == 1
    assert "60" in f"{outcome.json['wanted']} {outcome.json['got']}"
    assert "59" in f"{outcome.json['wanted']} {outcome.json['got']}"
    assert outcome.json["file"] == str(shorter)


def test_table_is_not_written_over_a_motion(qmd: Qmd, walk: Path, shifted: Path) -> None:
    for motion in (walk, shifted):
        before = motion.read_bytes()
        outcome = qmd("measure", walk, shifted, "--csv", motion.parent / "." / motion.name, "--json")
        assert outcome.code == 2
        assert outcome.json["got"] == str(motion)
        assert motion.read_bytes() == before
