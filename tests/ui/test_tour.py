"""The tour takes the real window through its main job and leaves pictures and the file."""

from PySide6.QtGui import QImage

from qmd_studio.registry import open_file
from qmd_studio.ui.tour import Tour


def test_tour_opens_tunes_exports_and_reopens(window, bvh_file, tmp_path, qtbot):
    out = tmp_path / "out"
    tour = Tour(window, out, bvh_file)
    tour.start()
    qtbot.waitUntil(lambda: not window.isVisible(), timeout=60_000)
    assert tour.status == 0
    pictures = sorted(path.name for path in out.glob("*.png"))
    assert [name[0] for name in pictures] == ["1", "2", "3", "4", "5"]
    assert all(QImage(str(out / name)).width() > 900 for name in pictures)
    assert open_file(next(out.glob("*.qmd"))).motion.n_frames == 60
