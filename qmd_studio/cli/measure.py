"""`qmd measure`: how far two motions of one skeleton are apart."""

from __future__ import annotations

import io
import os
from argparse import Namespace

import numpy as np

from qmd_studio import storage
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_motion
from qmd_studio.cli.report import Report, in_mm
from qmd_studio.errors import FormatError
from qmd_studio.motion.metrics import MotionError, measure


def run(arguments: Namespace) -> Report:
    """Compare ORIGINAL with DECODED. Raises `FormatError` where they differ in skeleton or in number of frames."""
    if arguments.csv:
        _check_spares(arguments.csv, (arguments.original, arguments.decoded))
    original = open_motion(arguments.original, skeleton=arguments.skeleton)
    decoded = open_motion(arguments.decoded, skeleton=arguments.skeleton)
    try:
        error = measure(original.motion, decoded.motion, align=arguments.align)
    except FormatError as problem:
        raise problem.located(arguments.decoded) from None
    lines = error_lines(error)
    if arguments.csv:
        storage.write_atomic(arguments.csv, distance_table(original.motion.skeleton.point_names, error))
        lines.append(("distances", arguments.csv))
    return Report(error.as_json(), lines, tuple(dict.fromkeys(original.warnings + decoded.warnings)))


def _check_spares(table: str, motions: tuple[str, str]) -> None:
    """Raise `UsageError` where the table would be written over one of the motions."""
    for motion in motions:
        if os.path.realpath(table) == os.path.realpath(motion):
            raise UsageError("--csv would write over a motion that is measured", wanted="another name", got=table)


def error_lines(error: MotionError) -> list[tuple[str, str]]:
    """Return what `MotionError.as_json` says, for people."""
    return [
        ("DEF", f"{error.def_:.4g}"),
        ("mean", in_mm(error.mean_mm)),
        ("99 % within", in_mm(error.p99_mm)),
        ("worst", f"{in_mm(error.max_mm)}, {error.worst_joint}, frame {error.worst_frame}"),
        ("velocity", f"{error.velocity_mm_s:,.1f} mm/s"),
        ("acceleration", f"{error.acceleration_mm_s2:,.0f} mm/s²"),
    ]


def distance_table(point_names: tuple[str, ...], error: MotionError) -> bytes:
    """Return CSV text: a line for each frame, a column for each measured point, distances in millimetres."""
    n_frames = len(error.distance_mm)
    text = io.StringIO()
    text.write(",".join(["frame", *(_quoted(name) for name in point_names)]) + "\n")
    rows = np.column_stack([np.arange(n_frames), error.distance_mm])
    np.savetxt(text, rows, fmt=["%d", *["%.6g"] * len(point_names)], delimiter=",")
    return text.getvalue().encode()


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"\n\r') else name
