"""Kernels run where nothing can be kept on disk, as in a read-only installation of a user without a home."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

MODULE = """
from qmd_studio.compiled import compiled

@compiled()
def twice(x):
    return 2 * x

print(twice(21), twice.stats.cache_path)
"""


def run_in(folder, **environment):
    (folder / "kernel.py").write_text(MODULE)
    paths = {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": "1"}
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    run = subprocess.run(
        [sys.executable, "-c", "import kernel"], env=kept | paths | environment, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


def test_without_a_folder_for_it_a_kernel_runs_all_the_same(tmp_path):
    (tmp_path / "__pycache__").write_text("a file, so that not even root can make a folder of this name")
    nowhere = str(tmp_path / "__pycache__" / "home")
    assert run_in(tmp_path, HOME=nowhere, XDG_CACHE_HOME=nowhere) == ["42", "None"]


def test_with_a_folder_for_it_the_machine_code_is_kept(tmp_path):
    answer, kept = run_in(tmp_path)
    assert answer == "42"
    assert list(Path(kept).glob("kernel.twice-*.nbc"))
