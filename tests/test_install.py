"""What `pip install .` gives: a wheel with everything in it, two commands, and help that costs next to nothing."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
import tomllib
import zipfile
from email.parser import Parser
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from qmd_studio import __version__

ROOT = Path(__file__).resolve().parents[1]
HEAVY = {"PySide6", "shiboken6", "OpenGL", "scipy", "numba", "pyqtgraph", "trimesh", "av"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    if not importlib.util.find_spec("hatchling"):
        pytest.skip("hatchling is not installed: requirements-dev.txt has it")
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder]
    build = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert build.returncode == 0, build.stdout + build.stderr
    (built,) = folder.glob("*.whl")
    return zipfile.ZipFile(built)


def metadata(wheel: zipfile.ZipFile, name: str) -> str:
    (path,) = [path for path in wheel.namelist() if path.endswith(f".dist-info/{name}")]
    return wheel.read(path).decode()


def tracked(*folders: str) -> list[str]:
    listing = subprocess.run(["git", "ls-files", *folders], cwd=ROOT, capture_output=True, text=True)
    if listing.returncode:
        pytest.skip("not a git checkout: nothing says which files belong to the project")
    return [path for path in listing.stdout.splitlines() if not Path(path).name.startswith(".")]


def test_wheel_carries_package_resources_and_avatars(wheel: zipfile.ZipFile) -> None:
    inside = set(wheel.namelist())
    assert set(tracked("qmd_studio")) <= inside
    assert {f"qmd_studio/{path}" for path in tracked("resources", "avatars")} <= inside


def test_wheel_carries_nothing_else(wheel: zipfile.ZipFile) -> None:
    tops = {name.split("/")[0] for name in wheel.namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"qmd_studio"}
    assert not [name for name in wheel.namelist() if "__pycache__" in name]


def test_wheel_gives_both_commands(wheel: zipfile.ZipFile) -> None:
    text = metadata(wheel, "entry_points.txt")
    assert "[console_scripts]\nqmd = qmd_studio.cli.main:main" in text
    assert "[gui_scripts]\nqmd-studio = qmd_studio.ui.app:main" in text


def test_wheel_says_version_licence_and_python(wheel: zipfile.ZipFile) -> None:
    fields = Parser().parsestr(metadata(wheel, "METADATA"))
    assert fields["Version"] == __version__
    assert fields["License-Expression"] == "MIT"
    assert fields["Requires-Python"] == ">=3.11"


def test_installed_package_finds_its_resources(wheel: zipfile.ZipFile, tmp_path: Path) -> None:
    wheel.extractall(tmp_path)
    code = "from qmd_studio.assets import resource; print(resource('tables').is_dir(), resource())"
    run = subprocess.run(
        [sys.executable, "-P", "-c", code], cwd="/", env=_path(tmp_path), capture_output=True, text=True
    )
    assert run.stdout.split() == ["True", str(tmp_path / "qmd_studio" / "resources")], run.stderr


@pytest.mark.parametrize("path", sorted(ROOT.glob("requirements*.txt")), ids=lambda path: path.name)
def test_pins_are_names_versions_and_markers_only(path: Path) -> None:
    pin = re.compile(r"[a-z0-9-]+==[0-9][0-9a-z.]*( ; [a-z_]+ (<|>=|==|!=) '[^']+')?")
    assert [line for line in path.read_text().splitlines() if not pin.fullmatch(line)] == []


def test_every_dependency_is_pinned_within_its_range() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    pins = [Requirement(line) for line in (ROOT / "requirements.txt").read_text().splitlines()]
    for wanted in map(Requirement, project["dependencies"]):
        versions = [str(pin.specifier).removeprefix("==") for pin in pins if _same_name(pin.name, wanted.name)]
        assert versions, f"{wanted} is not pinned: make pins"
        assert all(version in wanted.specifier for version in versions), f"{wanted} is pinned to {versions}"


def _same_name(one: str, other: str) -> bool:
    return re.sub("[-_.]+", "-", one).lower() == re.sub("[-_.]+", "-", other).lower()


@pytest.mark.parametrize("words", [["--help"], ["encode", "--help"], ["--version"], ["encode", "--nonsense"]])
def test_help_and_usage_load_nothing_heavy(words: list[str]) -> None:
    code = (
        "import sys, json; from qmd_studio.cli.main import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        "print(); print(json.dumps(sorted({name.split('.')[0] for name in sys.modules})))"
    )
    run = subprocess.run([sys.executable, "-c", code, *words], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(json.loads(run.stdout.splitlines()[-1]))
    assert "qmd_studio" in loaded
    assert loaded & (HEAVY | {"numpy"}) == set()


def test_size_of_a_file_to_be_loads_no_compiler() -> None:
    code = (
        "import sys; from qmd_studio.cli.main import main\n"
        "main('size --frames 343 --dofs 62 --fdf 6 --bits 8 --segment 0'.split())\n"
        "print(sorted(set(sys.argv[1:]) & {name.split('.')[0] for name in sys.modules}))"
    )
    run = subprocess.run([sys.executable, "-c", code, *HEAVY], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "[]"


def _path(folder: Path) -> dict[str, str]:
    return {"PYTHONPATH": str(folder)}
