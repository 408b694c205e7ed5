"""What the window gets after its first picture: the default body, the codec lab, and compiled kernels made ready."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.motion.skeleton import Skeleton
from qmd_studio.project.state import Side
from qmd_studio.ui.codec_lab import CodecLab
from qmd_studio.ui.codec_lab_export import ask_for_path
from qmd_studio.ui.comparison import Comparison
from qmd_studio.ui.error_strip import ErrorStrip
from qmd_studio.ui.libraries import load_libraries
from qmd_studio.ui.panels import LAB_MIN_WIDTH
from qmd_studio.ui.stage import Stage, Take

if TYPE_CHECKING:
    from qmd_studio.motion.metrics import MotionError
    from qmd_studio.tuning.lab_report import LabReport
    from qmd_studio.ui.main_window import MainWindow

Kinematics: TypeAlias = Callable[[Skeleton, FloatArray], FloatArray]


def furnish_window(window: MainWindow) -> None:
    """Bring in what the first picture could do without."""
    window.stage.show_default_body()
    _bring_lab(window)
    if not window.document.state.clips:
        window.viewport.frame_all()
    _warm_up(window.stage)


def _warm_up(stage: Stage) -> None:
    """Pose with compiled kernels from when they are ready on.

    The thread that readies them holds nothing of the window: were it the last to let go, widgets would be destroyed on
    it, which Qt does not survive.
    """
    ready: list[Kinematics] = []
    stage.kinematics = lambda skeleton, values: (ready[0] if ready else world_from_joint)(skeleton, values)
    threading.Thread(target=_warm_kinematics, args=(ready,), name="warm-up", daemon=True).start()


def _warm_kinematics(ready: list[Kinematics]) -> None:
    load_libraries()
    from qmd_studio.motion.bap import bap_skeleton
    from qmd_studio.motion.fast_kinematics import world_from_joint_fast
    from qmd_studio.motion.retarget import retargeting

    skeleton = bap_skeleton()
    world = world_from_joint_fast(skeleton, rest_values(skeleton)[None])
    ready.append(world_from_joint_fast)
    retargeting(skeleton, skeleton.scaled(0.7)).pose(world)


def _bring_lab(window: MainWindow) -> None:
    lab = CodecLab(
        window.document,
        window.playhead,
        window,
        ask_path=lambda parent, suggested: (window.ask_export_path or ask_for_path)(parent, suggested),
    )
    strip = ErrorStrip(window.playhead)
    window.lab, window.strip = lab, strip
    lab.setMinimumWidth(LAB_MIN_WIDTH)  # it scrolls up and down only
    window.lab_dock.setWidget(lab)
    window.timeline.set_strip(strip)

    comparison = window.views.comparison = Comparison(window.viewport, window.stage, window)
    comparison.set_dark(window.themes.dark)

    def show_side(side: Side, report: LabReport) -> None:
        window.stage.show_side(side, Take(lambda: report.played, report.error.distance_mm))
        if side is Side.B:
            window.status.show_figures(report.file_bytes, report.error.def_)
        window.views.follow()

    def clear_side(side: Side) -> None:
        window.stage.show_side(side, None)
        if side is Side.B:
            window.status.clear_figures()
        window.views.follow()

    def show_difference(error: MotionError) -> None:
        window.stage.show_difference(error.distance_mm)
        strip.show_error(error)

    def clear_difference() -> None:
        window.stage.show_difference(None)
        strip.clear()

    lab.side_measured.connect(show_side)
    lab.side_cleared.connect(clear_side)
    lab.difference_measured.connect(show_difference)
    lab.difference_cleared.connect(clear_difference)
    lab.sides_named.connect(comparison.name_sides)
    lab.view_chosen.connect(window.views.show_view)
    lab.heat_toggled.connect(window.views.show_heat)
    lab.reopen_wanted.connect(lambda path: window.open_paths([path]))
    lab.budget.device_chosen.connect(lambda name: setattr(window.settings, "device", name))
    lab.budget.show_device(window.settings.device)
    lab.name_sides()
    window.views.show_view(window.stage.view)
