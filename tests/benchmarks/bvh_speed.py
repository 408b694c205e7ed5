"""Opening a BVH of 20,000 frames and 96 channels, file to motion, against pybvh and bvhio.

Each reader runs in processes of its own, taking turns; the least time of each counts. A peer that is not installed is
said so; `--with-peers` installs both into a virtual environment that lasts as long as the measurement.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

import numpy as np

N_FRAMES = 20_000
N_JOINTS = 31
OURS = {
    "from the command line": ("from qmd_studio.registry import open_file as read", "small.bvh"),
    "in the studio, kernels loaded": ("import numba; from qmd_studio.registry import open_file as read", "large.bvh"),
}
PEERS = {
    "pybvh": ("from pybvh import read_bvh_file as read", 5, "at least 1"),
    "bvhio": ("from bvhio import readAsBvh as read", 1, "at least 10"),
}
ONE_READING = """
import sys, time
{imports}
read({warm!r})  # what a first call imports and makes is not reading
start = time.perf_counter()
read({path!r})
print(time.perf_counter() - start)
"""


def bvh_text(n_frames: int) -> str:
    """Return a chain of 31 joints with 96 channels, values with four decimals as exporters print them."""
    lines = ["HIERARCHY"]
    for joint in range(N_JOINTS):
        positions = "" if joint else " Xposition Yposition Zposition"
        lines += [f"{'JOINT' if joint else 'ROOT'} joint{joint}", "{", "OFFSET 0.0 5.5 0.0"]
        lines.append(f"CHANNELS {3 if joint else 6}{positions} Zrotation Xrotation Yrotation")
    lines += ["End Site", "{", "OFFSET 0.0 5.5 0.0", "}", *"}" * N_JOINTS]
    lines += ["MOTION", f"Frames: {n_frames}", "Frame Time: 0.00833333"]
    values = np.random.default_rng(1).uniform(-180, 180, (n_frames, 3 * N_JOINTS + 3))
    lines += [" ".join(["%.4f"] * values.shape[1]) % tuple(row) for row in values.tolist()]
    return "\n".join(lines) + "\n"


def seconds(python: str, imports: str, folder: Path, warm: str = "small.bvh") -> float:
    """Return how long one reading took in a process of its own, after a reading of `warm`."""
    code = ONE_READING.format(imports=imports, warm=str(folder / warm), path=str(folder / "large.bvh"))
    done = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    return float(done.stdout.split()[-1])


def compare(python: str, peer: str, folder: Path) -> str:
    """Return the rows of one peer, whose `python` has it."""
    imports, rounds, bar = PEERS[peer]
    times: dict[str, list[float]] = {place: [] for place in OURS}
    theirs = []
    for _ in range(rounds):
        theirs.append(seconds(python, imports, folder))
        for place, (ours, warm) in OURS.items():
            times[place].append(seconds(sys.executable, ours, folder, warm))
    other = min(theirs)
    theirs_text = f"{peer}: {other:.3f} s"
    return "\n".join(
        f"{title(peer)}, {place} | {min(mine):.3f} s | {theirs_text} | {other / min(mine):.1f} x faster | {bar} x"
        for place, mine in times.items()
    )


def title(peer: str) -> str:
    """Return what a row of this benchmark is called."""
    return f"opening BVH, {N_FRAMES} frames x {3 * N_JOINTS + 3} channels, against {peer}"


def main() -> None:
    """Print a row for each peer."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "large.bvh").write_text(bvh_text(N_FRAMES))
        (folder / "small.bvh").write_text(bvh_text(2))
        python = sys.executable
        if "--with-peers" in sys.argv[1:]:
            venv.create(folder / "peers", with_pip=True)
            python = str(folder / "peers" / ("Scripts" if sys.platform == "win32" else "bin") / "python")
            subprocess.run([python, "-m", "pip", "install", "-q", *PEERS], check=True)
        for peer in PEERS:
            if python == sys.executable and importlib.util.find_spec(peer) is None:
                print(f"{title(peer)} | not measured: {peer} is not installed (--with-peers) | | | {PEERS[peer][2]} x")
            else:
                print(compare(python, peer, folder))


if __name__ == "__main__":
    main()
