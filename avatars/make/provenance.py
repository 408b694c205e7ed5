"""What stands beside an avatar: where it comes from, and how to make the same file again."""

from __future__ import annotations

import hashlib
from pathlib import Path

from avatars.make.figure import Figure

ROOT = Path(__file__).resolve().parents[2]
TABLES = ("resources/tables/hanim_joints.csv", "resources/tables/hanim_sites.csv")


def recipe_sum() -> str:
    """Return the SHA-256 of everything that an avatar is made from: the program and its tables."""
    total = hashlib.sha256()
    files = [*sorted((ROOT / "avatars" / "make").glob("*.py")), *sorted((ROOT / "avatars" / "make").glob("*.csv"))]
    for path in (*files, *(ROOT / table for table in TABLES)):
        total.update(path.name.encode() + b"\0" + path.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return total.hexdigest()


def provenance(figure: Figure, sums: dict[str, str]) -> str:
    """Return the text of PROVENANCE.md."""
    lines = [
        f"# {figure.title}",
        "",
        "Our own work: no scan, photograph, motion or mesh of anybody else is in it. The program `avatars/make`",
        "makes it from H-Anim's default joint centres and feature points (`resources/tables/hanim_joints.csv`,",
        "`hanim_sites.csv`, `avatars/make/sites.csv`; the figures come from ISO/IEC 19774's example body) and from the",
        f"proportions and colours of the figure `{figure.name}` in `avatars/make/figure.py`: smooth unions of lofts,",
        "ellipsoids and cones, marching cubes, even triangles, weights by heat along the skin.",
        "",
        "`make avatars` makes the same files again, bit for bit with the packages of `requirements-avatars.txt`.",
        "",
        "| file | SHA-256 |",
        "|---|---|",
        *(f"| {name} | {value} |" for name, value in sums.items()),
        f"| the program and its tables | {recipe_sum()} |",
    ]
    return "\n".join(lines) + "\n"
