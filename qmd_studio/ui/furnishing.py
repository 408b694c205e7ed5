"""What the window gets after its first picture: the default body, the codec lab, and compiled kernels made ready."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from qmd_studio.motion.kinematics import rest_values
from qmd_studio.ui.codec_lab import CodecLab
from qmd_studio.ui.codec_lab_export import ask_for_path
from qmd_studio.ui.error_strip import ErrorStrip
from qmd_studio.ui.panels import LAB_MIN_WIDTH
from qmd_studio.ui.stage import Overlay, Stage

if TYPE_CHECKING:
    from qmd_studio.tuning.report import EncodeReport
    from qmd_studio.ui.main_window import MainWindow


def furnish_window(window: MainWindow) -> None:
    """Bring in what the first picture could do without."""
    window.stage.show_default_body()
    _bring_lab(window)
    if not window.document.state.clips:
        window.viewport.frame_all()
    threading.Thread(target=_warm_kinematics, args=(window.stage,), name="warm-up", daemon=True).start()


def _warm_kinematics(stage: Stage) -> None:
    from qmd_studio.motion.bap import bap_skeleton
    from qmd_studio.motion.fast_kinematics import world_from_joint_fast

    skeleton = bap_skeleton()
    world_from_joint_fast(skeleton, rest_values(skeleton)[None])
    stage.kinematics = world_from_joint_fast


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

    def show_report(report: EncodeReport) -> None:
        window.stage.show_decoded(lambda: report.decoded)
        window.status.show_figures(report.file_bytes, report.error.def_)
        strip.show_error(report.error)
        window.enable_verbs()

    def clear_report() -> None:
        window.stage.show_decoded(None)
        window.status.clear_figures()
        strip.clear()
        window.enable_verbs()

    lab.report_ready.connect(show_report)
    lab.report_cleared.connect(clear_report)
    lab.view_mode_changed.connect(lambda mode: window.show_overlay(Overlay(mode)))
    lab.reopen_wanted.connect(lambda path: window.open_paths([path]))
    window.show_overlay(Overlay(lab.view_mode))
