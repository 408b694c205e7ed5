"""`qmd render`: its files are read back by another reader than their writer, and hold what was asked for."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import av
import numpy as np
import pytest
from command_line import ROOT, Qmd

from qmd_studio.cli.parser_render import read_frames


def pictures(path: Path, form: str = "rgb24") -> list[np.ndarray]:
    with av.open(str(path)) as container:
        return [frame.to_ndarray(format=form) for frame in container.decode(video=0)]


def test_one_frame_gives_a_picture_of_the_size_asked_for(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "walk.png"
    told = qmd("render", walk, "--size", "96x64", "--theme", "dark", "-o", out, "--json").json
    assert told.keys() == {"written", "frames", "width", "height", "seconds"}
    assert (told["written"], told["frames"], told["width"], told["height"]) == (str(out), 1, 96, 64)
    (picture,) = pictures(out)
    assert picture.shape == (64, 96, 3)
    assert picture[:4].mean() < 70
    assert picture.max() > 120  # the body, which is light


def test_several_frames_give_a_contact_sheet(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "sheet.png"
    told = qmd("render", walk, "--size", "64x64", "--frames", "0,20,40", "-o", out, "--json").json
    (sheet,) = pictures(out)
    assert told["frames"] == 3
    assert sheet.shape == (told["height"], told["width"], 3)
    assert told["width"] > 2 * 64
    ink = (sheet.astype(int).sum(axis=2) < 250)[: told["height"] // 4]
    assert ink.sum() > 30  # the title


def test_a_name_with_number_signs_gives_a_file_each(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    words = ("--size", "32x32", "--frames", "5:15:5", "-o", tmp_path / "walk-####.png")
    told = qmd("render", walk, *words, "--json").json
    assert [Path(name).name for name in told["written"]] == ["walk-0005.png", "walk-0010.png", "walk-0015.png"]
    assert all(pictures(Path(name))[0].shape == (32, 32, 3) for name in told["written"])


def test_transparent_picture_has_alpha_only_where_something_stands(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    out = tmp_path / "cut.png"
    assert qmd("render", walk, "--size", "64x64", "--transparent", "--view", "front", "-o", out).code == 0
    (picture,) = pictures(out, "rgba")
    assert not picture[:, :4, 3].any()
    assert 0.03 < (picture[:, :, 3] == 255).mean() < 0.6


@pytest.mark.parametrize(("suffix", "fps"), [(".mp4", "30"), (".gif", "12.5")])
def test_film_has_the_frames_and_their_rate_and_moves(
    qmd: Qmd, walk: Path, tmp_path: Path, suffix: str, fps: str
) -> None:
    out = tmp_path / f"walk{suffix}"
    told = qmd("render", walk, "--size", "48x64", "--fps", fps, "-o", out, "--json").json
    shown = pictures(out)
    assert len(shown) == told["frames"] == round(60 / 120 * float(fps))
    assert shown[0].shape == (64, 48, 3)
    with av.open(str(out)) as container:
        assert float(container.streams.video[0].average_rate) == pytest.approx(float(fps), rel=0.03)
    assert np.abs(shown[0].astype(int) - shown[-1].astype(int)).max() > 60


@pytest.mark.parametrize("look", ["segments", "xray", "wire"])
def test_each_look_differs_from_the_plain_one(qmd: Qmd, walk: Path, tmp_path: Path, look: str) -> None:
    plain, other = tmp_path / "plain.png", tmp_path / "other.png"
    qmd("render", walk, "--size", "64x64", "-o", plain)
    qmd("render", walk, "--size", "64x64", "--look", look, "-o", other)
    assert np.abs(pictures(plain)[0].astype(int) - pictures(other)[0]).sum(axis=2).max() > 60


def test_body_of_another_build_is_worn_without_a_word_about_bones(qmd: Qmd, walk: Path, tmp_path: Path) -> None:
    from corpus import corpus_file

    box = corpus_file("hanim/xite_BoxManC.x3d")
    out = tmp_path / "walk.png"
    outcome = qmd("render", walk, "--body", box, "--size", "32x32", "-o", out)
    assert outcome.code == 0
    assert "bones" not in outcome.err
    assert qmd("render", box, "--size", "32x32", "-o", out).code == 0


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ("-o out.jpg", 2, ".png .mp4 .gif"),
        ("-o out.png --frames 60", 2, "frames from 0 to 59"),
        ("-o out.png --frames 3:1", 2, "a range a:b:step"),
        ("-o out.png --frames one", 2, "--frames"),
        ("-o out.png --size 5x5", 2, "--size"),
        ("-o out.png --fps 5", 2, "a picture has no frame rate"),
        ("-o out.mp4 --transparent", 2, "only a picture can be transparent"),
        ("-o out.mp4 --size 33x32", 2, "even"),
        ("-o out.gif --fps 60", 2, "at most 50"),
        ("-o out.png --body nobody", 1, "no avatar of this name ships"),
        ("-o out.png --frames 0:59 --size 8000x8000", 2, "too large"),
    ],
)
def test_mistakes_are_told_and_write_nothing(
    qmd: Qmd, walk: Path, monkeypatch: pytest.MonkeyPatch, words: str, code: int, said: str
) -> None:
    monkeypatch.chdir(walk.parent)
    before = sorted(walk.parent.iterdir())
    outcome = qmd("render", walk, *words.split())
    assert outcome.code == code
    assert said in outcome.err
    assert sorted(walk.parent.iterdir()) == before


@pytest.mark.parametrize(
    ("text", "frames"),
    [("0,4,2", [0, 4, 2]), ("0:9:3", [0, 3, 6, 9]), (":", list(range(10))), ("7:", [7, 8, 9]), (":2,9", [0, 1, 2, 9])],
)
def test_frames_are_read(text: str, frames: list[int]) -> None:
    assert read_frames(text)(10) == frames


def test_help_of_render_needs_neither_qt_nor_opengl() -> None:
    program = (
        "import sys\nfrom qmd_studio.cli.parser import build_parser\n"
        "build_parser().parse_args(['render', 'a', '-o', 'b.png'])\n"
        "print(sorted({name.split('.')[0] for name in sys.modules} & {'OpenGL', 'PySide6', 'numpy', 'av'}))"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert run.stdout.strip() == "[]", run.stderr
