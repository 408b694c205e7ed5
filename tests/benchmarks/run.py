"""Runs every benchmark beside this file and writes what they say to RESULTS.md: `make bench`, `make bench-codecs`.

A benchmark is a script named `*_speed.py` that prints rows of five columns, `name | ours | reference | ratio | bar`;
whatever else it prints is for the reader at the terminal. Each runs in a process of its own, so that none warms
another's caches. With `--codecs` the long measurements of the encoders over the corpus are made instead, whose words
stand below the speeds as they are. Either part is renewed without the other.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from screen import on_some_screen

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "RESULTS.md"
N_COLUMNS = 5
TIMEOUT_S = 900

HEADING = """# Speed

Made by `make bench` on 2 shared cores, no GPU. Times wander there by up to 2x; ratios, taken between runs that
alternate, hold better. The bars are those the project has set itself.

"""
CODECS_TITLE = "# Codecs over the corpus\n\n"
CODECS = ("encoders.py", "compact_sizes.py", "contenders.py")
TABLE = "| what | ours | reference | ratio | bar |\n|---|---|---|---|---|\n"


def rows_of(output: str) -> list[list[str]]:
    """Return the rows of five columns in what a benchmark printed."""
    split = [[cell.strip() for cell in line.split("|")] for line in output.splitlines()]
    return [cells for cells in split if len(cells) == N_COLUMNS]


def run(script: Path) -> list[list[str]]:
    """Run one benchmark and return its rows, or one row that says why there are none."""
    print(f"-- {script.name}", flush=True)
    command = [sys.executable, str(script)]
    try:
        done = subprocess.run(command, cwd=HERE.parents[1], capture_output=True, text=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return [[script.stem, "did not end", "", "", f"within {TIMEOUT_S} s"]]
    print(done.stdout, end="")
    if done.returncode:
        print(done.stderr, file=sys.stderr)
        reason = (done.stderr.strip().splitlines() or ["no word"])[-1].replace("|", "/")
        return [*rows_of(done.stdout), [script.stem, f"failed: {reason}", "", "", ""]]
    return rows_of(done.stdout)


def speeds() -> tuple[str, bool]:
    """Run the speed benchmarks; return their part of the page and whether all of them ran."""
    rows = [row for script in sorted(HERE.glob("*_speed.py")) for row in run(script)]
    table = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    return HEADING + TABLE + table, not any(row[1].startswith(("failed", "did not end")) for row in rows)


def codecs() -> tuple[str, bool]:
    """Run the measurements over the corpus; return their part of the page and whether all of them ran."""
    page, fine = CODECS_TITLE, True
    for name in CODECS:
        print(f"-- {name}", flush=True)
        done = subprocess.run([sys.executable, str(HERE / name)], cwd=HERE.parents[1], capture_output=True, text=True)
        print(done.stdout, done.stderr, sep="")
        page += f"`{name}`:\n\n```\n{done.stdout.strip()}\n```\n\n"
        fine &= done.returncode == 0
    return page.rstrip("\n") + "\n", fine


def main() -> int:
    """Renew one part of RESULTS.md, and return 1 where a benchmark failed."""
    before = RESULTS.read_text(encoding="utf-8") if RESULTS.exists() else ""
    first, title, second = before.partition(CODECS_TITLE)
    if "--codecs" in sys.argv[1:]:
        part, fine = codecs()
        page = first.rstrip("\n") + "\n\n" + part
    else:
        part, fine = speeds()
        page = part + ("\n" + title + second if title else "")
    RESULTS.write_text(page, encoding="utf-8")
    print(f"written: {RESULTS.relative_to(HERE.parents[1])}")
    return int(not fine)


if __name__ == "__main__":
    on_some_screen()
    raise SystemExit(main())
