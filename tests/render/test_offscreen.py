"""Pictures without a window: drawn by EGL alone, in a process that knows neither a screen nor Qt."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from qmd_studio.render.camera import Camera
from qmd_studio.render.gl import GraphicsError
from qmd_studio.render.offscreen import OffscreenRenderer, straight
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Scene

ROOT = Path(__file__).parents[2]
SMALL = (96, 64)


@pytest.fixture(scope="module")
def renderer():
    with OffscreenRenderer() as offscreen:
        yield offscreen


def test_picture_has_the_size_asked_for_and_the_sky_above(renderer):
    picture = renderer.picture(Scene(dark=True, show_axes=False), Camera(pitch=0.3), SMALL)
    assert (picture.shape, picture.dtype) == ((64, 96, 3), np.uint8)
    below = renderer.picture(Scene(dark=True, show_axes=False, show_ground=False), Camera(), SMALL)
    assert below[-1].mean() > below[0].mean() + 5  # the gradient is darker at its top


def test_picture_without_a_backdrop_is_transparent(renderer):
    picture = renderer.picture(Scene(backdrop=False, show_ground=False, show_axes=False), Camera(), SMALL)
    assert picture.shape == (64, 96, 4)
    assert not picture.any()


def test_straight_colours_are_those_before_the_multiplication():
    pixels = np.array([[[100, 50, 0, 128], [0, 0, 0, 0], [9, 8, 7, 255]]], np.uint8)
    np.testing.assert_array_equal(straight(pixels)[0], [[199, 100, 0, 128], [0, 0, 0, 0], [9, 8, 7, 255]])


@pytest.mark.parametrize("size", [(0, 10), (10, -1), (10_000_000, 10)])
def test_a_size_that_cannot_be_drawn_is_refused(renderer, size):
    with pytest.raises(GraphicsError, match="size"):
        renderer.picture(Scene(), Camera(), size, quality=LADDER[3])


def test_a_process_without_screen_and_qt_draws(tmp_path):
    program = (
        "import sys\n"
        "from qmd_studio.render.offscreen import render_picture\n"
        "from qmd_studio.render.scene import Scene\n"
        "from qmd_studio.render.camera import Camera\n"
        "print(render_picture(Scene(), Camera(), (32, 24)).shape, 'PySide6' in sys.modules)\n"
    )
    bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, env=bare, capture_output=True, text=True, timeout=60
    )
    assert run.stdout.strip() == "(24, 32, 3) False", run.stderr


def test_a_machine_without_egl_is_told_what_to_install(monkeypatch):
    from qmd_studio.render import egl

    def absent(_name):
        raise OSError("cannot open shared object file")

    monkeypatch.setattr(egl.ctypes, "CDLL", absent)
    with pytest.raises(GraphicsError, match="libegl1"):
        egl.EglContext()
