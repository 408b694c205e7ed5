"""Make the avatars that ship: python -m avatars.make [NAME …], into avatars/NAME."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

from avatars.make.figure import FIGURES
from avatars.make.model import make_model
from avatars.make.provenance import provenance
from avatars.make.write import document

ROOT = Path(__file__).resolve().parents[2]


def main(names: list[str]) -> None:
    """Make the named figures, or all, and say what came out."""
    for figure in FIGURES:
        if names and figure.name not in names:
            continue
        folder = ROOT / "avatars" / figure.name
        folder.mkdir(exist_ok=True)
        model = make_model(figure)
        sums = {}
        for name, segmented in (("avatar.x3d", False), ("segmented.x3d", True)):
            data = document(model, segmented=segmented).encode()
            (folder / name).write_bytes(data)
            sums[name] = hashlib.sha256(data).hexdigest()
            print(f"{figure.name}/{name}: {len(data) / 1e6:.2f} MB")
        (folder / "PROVENANCE.md").write_text(provenance(figure, sums), encoding="utf-8")
        (folder / "LICENSE").write_text((ROOT / "LICENSE").read_text(encoding="utf-8"), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
