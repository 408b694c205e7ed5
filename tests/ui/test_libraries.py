"""What threads beside the window import: one of them brings the large libraries in, the others wait for it."""

import subprocess
import sys
from pathlib import Path

from tests.ui.conftest import bvh_text

OPEN_AND_MEASURE = """
import sys
import threading
from pathlib import Path

from qmd_studio.ui import background, codec_lab_work, furnishing, opener, tuning_worker

seen = set()

class Witness:
    def find_spec(self, name, path=None, target=None):
        if name in ("numba", "scipy", "scipy.fft", "scipy.linalg"):
            seen.add(threading.current_thread().name)

sys.meta_path.insert(0, Witness())
ready, start = [], threading.Barrier(4)
jobs = [
    lambda: ready.append(opener.read_clip(Path(sys.argv[1]))),
    lambda: furnishing._warm_kinematics(ready),
    lambda: ready.append(background._outcome(codec_lab_work.import_plots, threading.Event(), print)[0] == "ended"),
    tuning_worker.load_libraries,
]
threads = [threading.Thread(target=lambda job=job: (start.wait(), job())) for job in jobs]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert len(ready) == 3 and all(ready), ready
print(len(seen))
"""


def test_one_thread_brings_in_the_large_libraries_while_the_others_wait(tmp_path):
    path = tmp_path / "nod.bvh"
    path.write_text(bvh_text())
    run = subprocess.run(
        [sys.executable, "-c", OPEN_AND_MEASURE, str(path)],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (run.returncode, run.stdout.split()) == (0, ["1"]), run.stderr
