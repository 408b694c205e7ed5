"""`qmd convert`: a motion in another format."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from qmd_studio.cli.load import open_motion
from qmd_studio.cli.report import Report
from qmd_studio.cli.save import save_motion


def run(arguments: Namespace) -> Report:
    """Write IN as OUT. Raises `FormatError` where OUT's format cannot hold this skeleton without retargeting."""
    opened = open_motion(arguments.input, skeleton=arguments.skeleton, fps=arguments.fps)
    report = save_motion(Path(arguments.output), opened.motion)
    return replace(report, warnings=opened.warnings + report.warnings, notes=opened.notes)
