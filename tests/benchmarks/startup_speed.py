"""How long a user waits for `qmd --help` and for the window's first picture."""

from __future__ import annotations

import os
import re
import shutil
import statistics
import subprocess
import sys
import time

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
    """Return the row of the window's first painted frame, warm: the first run, which fills caches, does not count."""
    command = [sys.executable, "-m", "qmd_studio"]
    if not os.environ.get("DISPLAY") and not os.environ.get("WAYLAND_DISPLAY"):
        xvfb = shutil.which("xvfb-run")
        if xvfb is None:
            return "window's first painted frame, warm | not measured: no screen | | | 1.5 s"
        command = [xvfb, "-a", "-s", "-screen 0 1920x1080x24", *command]
    times = [_first_paint_s(command) for _ in range(N_WINDOWS + 1)][1:]
    return f"window's first painted frame, warm | {statistics.median(times):.2f} s | | | 1.5 s"


def _first_paint_s(command: list[str]) -> float:
    environment = {**os.environ, "QMD_STUDIO_TIME_FIRST_PAINT": "1"}
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
    found = re.search(r"first paint: ([\d.]+) ms", run.stdout + run.stderr)
    if found is None:
        raise SystemExit(f"the window did not say when it painted: {run.stderr[-300:]}")
    return float(found[1]) / 1000


if __name__ == "__main__":
    print(help_row())
    print(first_paint_row())
