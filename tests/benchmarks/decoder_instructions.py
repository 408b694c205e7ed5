"""Counts what the C decoder does, with callgrind, and fits the model that `tuning/budget.py` reads.

    python tests/benchmarks/decoder_instructions.py            counts, fits, and compares on settings held out
    python tests/benchmarks/decoder_instructions.py --write    the same, and renews resources/tables/decoder_cost.csv

Needs a C compiler and valgrind. The decoder is compiled as for a processor without vector units; what version 1 does
depends on the counts in a file alone and not on the motion, so its files are noise; those of version 2 are walks.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from qmd_studio.codecs.compact import file as compact  # noqa: E402
from qmd_studio.codecs.compact.settings import CompactSettings  # noqa: E402
from qmd_studio.codecs.qmd import container, payload  # noqa: E402
from qmd_studio.codecs.qmd.payload import Payload, Segment  # noqa: E402
from qmd_studio.codecs.qmd.settings import QmdSettings  # noqa: E402
from qmd_studio.tuning import budget  # noqa: E402
from qmd_studio.tuning.decoder_work import work_of_file  # noqa: E402
from tests.codecs.tiny_motions import pendulum  # noqa: E402
from tests.generated_motion import walker  # noqa: E402

TABLE = ROOT / "resources/tables/decoder_cost.csv"
SOURCES = [ROOT / "tests/benchmarks/count_instructions.c", ROOT / "resources/decoder/qmd_decoder.c"]
FLAGS = ["-std=c99", "-O2", "-fno-tree-vectorize", "-ffp-contract=off", "-g", f"-I{ROOT / 'resources/decoder'}"]


@dataclass(frozen=True)
class Setting:
    """A file to count on: `columns` m, FDF, b, the rows of d and of a segment."""

    columns: int
    fdf: int
    bits: int
    rows: int
    segment: int

    def file(self) -> bytes:
        """Return a file of noise with these counts."""
        random = np.random.default_rng(self.rows)
        segments = []
        for start in range(0, self.rows, self.segment):
            rows = min(self.segment, self.rows - start)
            table = random.normal(size=2**self.bits).astype(np.float32)
            exact = random.normal(size=(rows, self.fdf)).astype(np.float32)
            indices = random.integers(0, 2**self.bits, (rows, self.columns - self.fdf))
            segments.append(Segment(self.bits, table, exact, indices.astype(payload.index_type(self.bits))))
        contents = Payload(random.normal(size=self.columns).astype(np.float32), tuple(segments))
        return container.build(payload.pack(contents), b"", 30.0, QmdSettings())


@dataclass(frozen=True)
class CompactSetting:
    """A file of version 2 to count on: a walk of so many frames, `columns` of it moving; with 3, a pendulum."""

    frames: int
    columns: int
    mean_mm: float
    segment: int
    seed: int = 1

    @property
    def rows(self) -> int:
        """The frames but one, as of the other version."""
        return self.frames - 1

    def file(self) -> bytes:
        """Return the file; columns beyond `columns` stand still, and the noise of a capture is on the others."""
        motion = walker(self.frames, seed=self.seed) if self.columns > 3 else pendulum(self.frames)
        X = motion.X.copy()
        X[:, self.columns :] = X[0, self.columns :]
        X[:, : self.columns] += np.random.default_rng(self.seed).normal(0, 2e-4, (self.frames, self.columns))
        chosen = CompactSettings(mean_error_mm=self.mean_mm, segment=min(self.segment, self.frames))
        return compact.encode(motion.with_values(X), chosen, with_skeleton=False).data


FITTED_COMPACT = [
    CompactSetting(frames, columns, mean_mm, segment)
    for frames, columns in ((60, 20), (200, 62), (143, 40), (100, 3))
    for mean_mm in (0.05, 0.2, 0.5, 2.0)
    for segment in (0, 30, 120)
]
HELD_OUT_COMPACT = [
    CompactSetting(300, 62, 0.1, 120, seed=2),
    CompactSetting(250, 62, 1.0, 0, seed=3),
    CompactSetting(90, 50, 0.3, 45, seed=4),
    CompactSetting(121, 10, 0.5, 20, seed=5),
    CompactSetting(77, 3, 0.3, 40, seed=6),
]
FITTED = [
    Setting(columns, fdf, bits, rows, segment)
    for columns, rows in ((6, 300), (20, 60), (62, 200))
    for fdf in (0, 6, 20)
    for bits in (8, 9, 12, 16)
    for segment in (30, 1000)
    if fdf <= columns
]
HELD_OUT = [
    Setting(62, 6, 8, 342, 1000),
    Setting(62, 1, 8, 433, 150),
    Setting(62, 26, 10, 300, 60),
    Setting(62, 61, 8, 250, 1000),
    Setting(62, 0, 11, 141, 1000),
    Setting(96, 3, 8, 120, 40),
    Setting(186, 6, 13, 90, 1000),
    Setting(33, 33, 8, 77, 20),
    Setting(8, 3, 14, 500, 120),
    Setting(4, 0, 8, 900, 10),
]


def main() -> int:
    """Count, fit, print; return 1 where a setting held out is more than a tenth off."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    wishes = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        counter = Counter(Path(folder))
        costs = fit(FITTED, counter)
        compact_costs = fit(FITTED_COMPACT, counter)
        costs = compact_costs | costs  # the checksum is the same in both
        if wishes.write:
            write(costs)
            budget.decoder_costs.cache_clear()
        worst = max(compare(setting, counter) for setting in [*HELD_OUT, *HELD_OUT_COMPACT])
    print(f"worst of {len(HELD_OUT) + len(HELD_OUT_COMPACT)} settings held out: {worst:.1%}")
    return int(worst > 0.1)


class Counter:
    """The decoder, compiled, and what callgrind counts in it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._program = folder / "count"
        subprocess.run(["cc", *FLAGS, *map(str, SOURCES), "-o", str(self._program)], check=True)

    def instructions(self, data: bytes, function: str) -> int:
        """Return the instructions spent in all calls of `function` while `data` is opened and played."""
        path = self._folder / "file.qmd"
        path.write_bytes(data)
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={function}"]
        done = subprocess.run([*command, self._program, path], capture_output=True, text=True, check=True)
        found = re.search(r"Collected : (\d+)", done.stderr)
        if found is None:
            raise SystemExit(f"callgrind gave no count: {done.stderr}")
        return int(found[1])

    def state_bytes(self, data: bytes) -> int:
        """Return the bytes of a decoder on this machine."""
        path = self._folder / "file.qmd"
        path.write_bytes(data)
        return int(subprocess.run([self._program, path], capture_output=True, text=True, check=True).stdout)


def fit(settings: Iterable[Setting | CompactSetting], counter: Counter) -> dict[str, float]:
    """Return the model's coefficients, those of least relative error."""
    files = [setting.file() for setting in settings]
    costs: dict[str, float] = {"state_bytes": counter.state_bytes(files[0])}
    work = [work_of_file(data) for data in files]
    for function, amounts in (("qmd_next", [w.playing for w in work]), ("qmd_open", [w.opening for w in work])):
        counted = np.array([counter.instructions(data, function) for data in files], dtype=np.float64)
        names = list(amounts[0])
        A = np.array([[a[name] for name in names] for a in amounts])
        found = nnls(A / counted[:, np.newaxis], np.ones(len(counted)))[0]
        costs |= dict(zip(names, found.tolist(), strict=True))
    return costs


def write(costs: dict[str, float]) -> None:
    """Write the coefficients to the table that ships."""
    lines = [
        "version,what,instructions",
        *(f"{2 if 'compact' in name else 1},{name},{value:.4g}" for name, value in costs.items()),
    ]
    TABLE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(TABLE.read_text(encoding="utf-8"))


def compare(setting: Setting | CompactSetting, counter: Counter) -> float:
    """Print what the model says of a setting beside what is counted; return the larger relative error."""
    data = setting.file()
    told = budget.budget_of_file(data)
    playing, opening = counter.instructions(data, "qmd_next"), counter.instructions(data, "qmd_open")
    frames = setting.rows + 1
    off = told.instructions_per_frame * frames / playing - 1, told.instructions_to_open / opening - 1
    print(
        f"{setting}: {told.instructions_per_frame:.0f} a frame, counted {playing / frames:.0f} ({off[0]:+.1%}); "
        f"{told.instructions_to_open:,.0f} to open, counted {opening:,} ({off[1]:+.1%})"
    )
    return max(map(abs, off))


if __name__ == "__main__":
    raise SystemExit(main())
