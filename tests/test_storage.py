"""Whoever saves a file has the old bytes or the new ones afterwards, whatever happens in between."""

from __future__ import annotations

import errno
import os
import random
import signal
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from qmd_studio import storage
from qmd_studio.errors import StorageError

ROOT = Path(__file__).resolve().parents[1]
OLD = b"old " * 1000
NEW = b"new " * 2000

N_KILLS = 100
WRITER = """
import itertools, sys
from pathlib import Path
from qmd_studio.storage import write_atomic
target = Path(sys.argv[1])
for generation in itertools.count():
    write_atomic(target, b"%08d" % generation * 50_000)
    print(flush=True)
"""


def leftovers(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name.endswith(".tmp")]


def test_new_file_holds_the_bytes(tmp_path: Path) -> None:
    storage.write_atomic(tmp_path / "a.qmd", NEW)
    assert storage.read_bytes(tmp_path / "a.qmd") == NEW
    assert os.listdir(tmp_path) == ["a.qmd"]


@pytest.mark.parametrize("mode", [0o600, 0o644, 0o666, 0o755])
def test_existing_file_keeps_its_permissions(tmp_path: Path, mode: int) -> None:
    target = tmp_path / "a.qmd"
    target.write_bytes(OLD)
    target.chmod(mode)
    storage.write_atomic(target, NEW)
    assert target.read_bytes() == NEW
    assert stat.S_IMODE(target.stat().st_mode) == mode


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes here")
@pytest.mark.parametrize("through_link", [False, True])
def test_pipe_is_refused_and_still_a_pipe(tmp_path: Path, *, through_link: bool) -> None:
    pipe = target = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    if through_link:
        target = tmp_path / "link.csv"
        target.symlink_to(pipe)
    with pytest.raises(StorageError, match="pipe"):
        storage.write_atomic(target, NEW)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert not leftovers(tmp_path)


def test_link_stays_a_link_and_its_target_changes(tmp_path: Path) -> None:
    (tmp_path / "shelf").mkdir()
    target = tmp_path / "shelf" / "a.qmd"
    target.write_bytes(OLD)
    link = tmp_path / "link.qmd"
    link.symlink_to(target)
    storage.write_atomic(link, NEW)
    assert link.is_symlink()
    assert target.read_bytes() == NEW


@pytest.mark.parametrize("call", ["open", "fsync", "replace", "write"])
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EIO])
def test_disk_error_leaves_the_old_file_and_no_litter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str, code: int
) -> None:
    target = tmp_path / "a.qmd"
    target.write_bytes(OLD)
    fail = _failing(code)
    if call == "write":
        monkeypatch.setattr(storage.os, "fdopen", lambda *_: _FullDisk(fail))
    else:
        monkeypatch.setattr(storage.os, call, fail)
    with pytest.raises(StorageError) as caught:
        storage.write_atomic(target, NEW)
    monkeypatch.undo()
    assert os.strerror(code).lower() in str(caught.value)
    assert caught.value.path == target
    assert target.read_bytes() == OLD
    assert leftovers(tmp_path) == []


def _failing(code: int) -> Callable[..., None]:
    def fail(*_: object, **__: object) -> None:
        raise OSError(code, os.strerror(code))

    return fail


class _FullDisk:
    """A stream whose disk gives out at the first write."""

    def __init__(self, fail: Callable[..., None]) -> None:
        self.write = fail

    def __enter__(self) -> _FullDisk:
        return self

    def __exit__(self, *_: object) -> None:
        return None


def test_folder_that_cannot_be_synced_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rename has happened by then: the name holds the new bytes whole, but nobody promised they survive a crash."""
    target = tmp_path / "a.qmd"
    target.write_bytes(OLD)
    monkeypatch.setattr(storage, "_sync_folder", _failing(errno.EIO))
    with pytest.raises(StorageError):
        storage.write_atomic(target, NEW)
    assert target.read_bytes() == NEW
    assert leftovers(tmp_path) == []


def test_missing_folder_is_an_error_of_the_studio(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="no such file"):
        storage.write_atomic(tmp_path / "nowhere" / "a.qmd", NEW)


def test_writer_killed_at_any_instant_leaves_a_whole_file(tmp_path: Path) -> None:
    target = tmp_path / "a.qmd"
    chance = random.Random(20051109)
    seen = set()
    for _ in range(N_KILLS):
        with subprocess.Popen([sys.executable, "-c", WRITER, target], cwd=ROOT, stdout=subprocess.PIPE) as child:
            assert child.stdout is not None
            child.stdout.readline()  # the first generation stands
            for _ in range(chance.randrange(4)):
                child.stdout.readline()
            _spin(chance.randrange(20_000))
            child.send_signal(signal.SIGKILL)
        data = target.read_bytes()
        assert len(data) == 400_000
        assert data == data[:8] * 50_000
        seen.add(int(data[:8]))
    assert len(seen) > 1, "the kills all fell on one generation: they are not spread over the write"


def _spin(turns: int) -> None:
    """Let a little time pass, from nothing to about a millisecond, without asking the clock."""
    for _ in range(turns):
        pass


def test_reading_says_why_it_cannot(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="no such file"):
        storage.read_bytes(tmp_path / "absent.bvh")
    with pytest.raises(StorageError, match="is a folder"):
        storage.read_bytes(tmp_path)


def test_file_over_the_limit_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_bytes(b"12345")
    assert storage.read_bytes(tmp_path / "a.bvh", limit=5) == b"12345"
    with pytest.raises(StorageError, match="too large"):
        storage.read_bytes(tmp_path / "a.bvh", limit=4)


def test_a_name_that_no_file_can_have_is_refused(tmp_path: Path) -> None:
    for act in (storage.read_bytes, lambda path: storage.write_atomic(path, b"")):
        with pytest.raises(StorageError, match="null"):
            act(tmp_path / "a\0b")


def test_writing_into_a_folder_that_is_not_there_says_so(tmp_path: Path) -> None:
    with pytest.raises(StorageError) as caught:
        storage.write_atomic(tmp_path / "none" / "walk.bvh", b"x")
    assert "There is no folder" in (caught.value.hint or "")
    assert not list(tmp_path.iterdir())
