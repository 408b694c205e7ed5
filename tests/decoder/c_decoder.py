"""The C decoder as the tests use it: compiled on the spot, and asked over a pipe."""

import os
import shutil
import struct
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "resources" / "decoder"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", f"-I{SOURCES}")
SANITISED = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
STATUSES = (
    "OK", "END", "NOT_QMD", "VERSION", "LENGTH", "CHECKSUM", "FRAME_RATE", "SEGMENT", "ENDS_EARLY", "NOT_A_NUMBER",
    "INDEX", "RANGE", "WORK",
)  # fmt: skip
_ANSWER = struct.Struct("=I7Qd")


def compiler():
    """Return the path of a C compiler, or None."""
    return next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)


def compile_c(target, *sources, flags=()):
    """Compile `sources` into the program `target`; return what the compiler said, "" where it had no complaint."""
    command = [compiler(), *STRICT, *flags, *map(str, sources), "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.stderr or ("" if done.returncode == 0 else f"exit code {done.returncode}")


@dataclass(frozen=True)
class Outcome:
    """What the decoder made of a file; `poses` (decoded, columns) float32."""

    status: str
    error_at: int
    frames: int
    skeleton: slice
    work_bytes: int
    fps: float
    poses: np.ndarray


class CDecoder:
    """A running decoder. One that a sanitiser stopped raises `AssertionError` with the report."""

    def __init__(self, program):
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  # closed with the process
        environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}  # finding leaks needs rights a container lacks
        self._process = subprocess.Popen(
            [program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, env=environment
        )

    def decode(self, data):
        """Return the outcome for the bytes of one file."""
        try:
            self._process.stdin.write(struct.pack("=I", len(data)) + data)
            self._process.stdin.flush()
        except BrokenPipeError:
            self._fail()
        status, error_at, columns, frames, skeleton_at, skeleton_bytes, work_bytes, decoded, fps = _ANSWER.unpack(
            self._read(_ANSWER.size)
        )
        poses = np.frombuffer(self._read(4 * decoded * columns), np.float32).reshape(decoded, columns)
        skeleton = slice(skeleton_at, skeleton_at + skeleton_bytes)
        return Outcome(STATUSES[status], error_at, frames, skeleton, work_bytes, fps, poses)

    def close(self):
        """End the process; raises `AssertionError` where it did not end well."""
        self._process.stdin.close()
        if self._process.wait(timeout=60):
            self._fail()
        self._process.stdout.close()
        self._errors.close()

    def _read(self, size):
        answer = self._process.stdout.read(size)
        if len(answer) < size:
            self._fail()
        return answer

    def _fail(self):
        code = self._process.wait(timeout=60)
        self._errors.seek(0)
        raise AssertionError(f"the decoder ended with {code}: {self._errors.read().decode(errors='replace')}")
