"""How long a user waits for `qmd --help` and for the window's first picture."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time

from screen import on_some_screen

N_RUNS = 15
N_WINDOWS = 5


def seconds(command: list[str]) -> float:
    """Return the wall time of one run of `command`."""
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start


def help_row() -> str:
    """Return the row of `qmd --help` against a Python that does nothing, runs alternating."""
    ours, bare = [], []
    for _ in range(N_RUNS):
        ours.append(seconds([sys.executable, "-m", "qmd_studio.cli", "--help"]))
        bare.append(seconds([sys.executable, "-c", "pass"]))
    mine, theirs = statistics.median(ours), statistics.median(bare)
    extra = mine - theirs
    return f"`qmd --help` | {mine:.3f} s | bare Python {theirs:.3f} s | + {extra:.3f} s | + 0.3 s"


def first_paint_row() -> str:
    """Return the row of the window's first picture, warm: the first run, which fills caches, does not count."""
    times = [_first_paint_s() for _ in range(N_WINDOWS + 1)][1:]
    name = "window's first painted frame, warm, from the start of the process"
    return f"{name} | {statistics.median(times):.2f} s | | | 1.5 s"


def _first_paint_s() -> float:
    environment = {**os.environ, "QMD_STUDIO_TIME_FIRST_PAINT": "1"}
    command = [sys.executable, "-m", "qmd_studio"]
    start = time.perf_counter()
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("first paint"):
                return time.perf_counter() - start
    raise SystemExit("the window did not say when it painted")


if __name__ == "__main__":
    on_some_screen()
    print(help_row())
    print(first_paint_row())
