import pytest

from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.tuning.size_figures import size_figures
from tests.generated_motion import walker


@pytest.mark.parametrize(
    "settings", [QmdSettings(), QmdSettings(fdf=0, bits=12, segment=7), QmdSettings(fdf=62, bits=9)]
)
def test_the_size_shown_at_once_is_the_size_of_the_file(settings):
    motion = walker(50)
    encoded, figures = encode(motion, settings), size_figures(motion, settings)
    assert figures.file_bytes == len(encoded.data)
    assert figures.payload == encoded.size
    assert figures.skeleton_bytes == encoded.skeleton_bytes


def test_per_cent_and_rate_go_by_the_payload():
    motion = walker(343, fps=120.0)
    figures = size_figures(motion, QmdSettings())
    assert figures.raw_bytes == 343 * 62 * 4
    assert figures.percent_of_raw == pytest.approx(100 * figures.payload.bytes / 85064)
    assert figures.kbit_s == pytest.approx(figures.payload.bytes * 8 / 1000 / (343 / 120))


def test_a_single_frame_has_a_size_too():
    figures = size_figures(walker(1), QmdSettings().checked(62, 0))
    assert figures.payload.bytes == 13 + 1024 + 4 * 62
