"""The set-up before `make run` and `make test`: what it asks of the system, on systems made of stand-in programs."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LIBRARIES = [
    "libgl1",
    "libegl1",
    "libglib2.0-0",
    "libdbus-1-3",
    "libfontconfig1",
    "fonts-dejavu-core",
    "libxkbcommon0",
    "libxkbcommon-x11-0",
    "libxcb-cursor0",
    "libxcb-icccm4",
    "libxcb-keysyms1",
    "libxcb-shape0",
    "libgssapi-krb5-2",
]
SCREEN = ["xvfb", "xauth"]

PYTHON = """case "$*" in
    --version) echo "Python 3.{minor}.1" ;;
    *version_info*) exit {too_old} ;;
    *ensurepip*) exit {no_venv} ;;
    "-m venv .venv") mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
    *) echo "python $*" >>calls ;;
esac"""


@dataclass
class Machine:
    """A checkout of the set-up with programs of its own before the real ones."""

    folder: Path

    def program(self, name: str, script: str) -> None:
        path = self.folder / "bin" / name
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)

    def python(self, *, minor: int = 11, venv: bool = True) -> None:
        for name in ("python3", "python3.11", "python3.12", "python3.13", "python3.14"):
            self.program(name, PYTHON.format(minor=minor, too_old=int(minor < 11), no_venv=int(not venv)))

    def packages(self, *lines: str) -> None:
        listing = "\n".join(lines)
        self.program("dpkg-query", f"cat <<'END'\n{listing}\nEND")

    def user(self, number: int) -> None:
        self.program("id", f"echo {number}")

    def setup(self, purpose: str = "run", **environment: str) -> subprocess.CompletedProcess[str]:
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        command = [str(self.folder / ".ci" / "setup"), purpose]
        return subprocess.run(command, env={"PATH": path, **environment}, capture_output=True, text=True, timeout=60)

    @property
    def calls(self) -> str:
        log = self.folder / "calls"
        return log.read_text() if log.exists() else ""


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    """Debian with everything installed and a common user."""
    if shutil.which("sh") is None:
        pytest.skip("there is no sh here")
    (tmp_path / "bin").mkdir()
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "setup", tmp_path / ".ci")
    for requirements in ROOT.glob("requirements*.txt"):
        shutil.copy(requirements, tmp_path)
    result = Machine(tmp_path)
    result.python()
    result.user(1000)
    result.packages(*(f"installed {name}, " for name in LIBRARIES + SCREEN))
    result.program("apt-get", 'echo "apt-get $*" >>calls')
    return result


def test_all_there_installs_the_pinned_requirements_once(machine: Machine) -> None:
    first, second = machine.setup("test"), machine.setup("test")
    assert (first.returncode, second.returncode) == (0, 0), first.stderr
    assert machine.calls.count("pip install") == 1
    assert "-r requirements.txt -r requirements-dev.txt" in machine.calls
    assert second.stdout == ""


def test_other_requirements_are_installed_again(machine: Machine) -> None:
    machine.setup("run")
    with (machine.folder / "requirements.txt").open("a") as stream:
        stream.write("one-more==1.0\n")
    machine.setup("run")
    assert machine.calls.count("pip install") == 2


def test_missing_packages_are_named_in_one_line_to_a_user(machine: Machine) -> None:
    machine.packages(*(f"installed {name}, " for name in LIBRARIES if name != "libegl1"))
    done = machine.setup("test")
    assert done.returncode == 1
    assert "    sudo apt-get install -y libegl1 xvfb xauth" in [line.rstrip() for line in done.stderr.splitlines()]
    assert machine.calls == ""


def test_missing_packages_are_installed_by_root(machine: Machine) -> None:
    machine.user(0)
    machine.packages(*(f"installed {name}, " for name in LIBRARIES))
    done = machine.setup("run")
    assert done.returncode == 0, done.stderr
    assert "apt-get install -y -q --no-install-recommends xvfb xauth" in machine.calls


def test_package_list_is_refreshed_where_an_install_fails(machine: Machine) -> None:
    machine.user(0)
    machine.packages(*(f"installed {name}, " for name in LIBRARIES))
    machine.program("apt-get", 'echo "apt-get $*" >>calls; [ "$1" = update ] || grep -q update calls')
    assert machine.setup("run").returncode == 0
    assert [line.split()[1] for line in machine.calls.splitlines()[:3]] == ["install", "update", "install"]


def test_renamed_package_counts_under_its_old_name(machine: Machine) -> None:
    listing = [f"installed {name}, " for name in LIBRARIES + SCREEN if name != "libglib2.0-0"]
    machine.packages(*listing, "installed libglib2.0-0t64, libglib2.0-0 (= 2.80.0-6ubuntu3.4)")
    assert machine.setup("test").returncode == 0


def test_removed_package_whose_settings_remain_is_missing(machine: Machine) -> None:
    machine.packages(*(f"installed {name}, " for name in LIBRARIES), "config-files xvfb, ", "installed xauth, ")
    assert "install -y xvfb" in machine.setup("test").stderr


@pytest.mark.parametrize("screen", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_virtual_screen_is_not_asked_for_where_there_is_a_real_one(machine: Machine, screen: str) -> None:
    machine.packages(*(f"installed {name}, " for name in LIBRARIES))
    assert machine.setup("run", **{screen: ":0"}).returncode == 0
    assert machine.setup("run").returncode == 1


def test_missing_venv_is_a_package_too(machine: Machine) -> None:
    machine.python(venv=False)
    assert "install -y python3-venv" in machine.setup("run").stderr


def test_old_python_is_named(machine: Machine) -> None:
    machine.python(minor=9)
    done = machine.setup("run")
    assert done.returncode == 1
    assert "Python 3.11 or newer is needed; python3 here is: Python 3.9.1" in done.stderr


def test_elsewhere_than_debian_it_goes_on_with_a_hint(machine: Machine) -> None:
    basics = machine.folder / "basics"
    basics.mkdir()
    for name in ("sh", "cat", "cksum", "awk", "dirname", "basename", "mkdir", "cp", "rm"):
        (basics / name).symlink_to(shutil.which(name) or name)
    for name in ("dpkg-query", "apt-get"):
        (machine.folder / "bin" / name).unlink()
    done = machine.setup("run", PATH=f"{machine.folder / 'bin'}:{basics}")
    assert done.returncode == 0, done.stderr
    assert "not a Debian or Ubuntu" in done.stdout
