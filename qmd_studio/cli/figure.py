"""`qmd figure`: Figures 5 and 6 of the paper, for its own numbers or for any motion."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import OpenedMotion, open_motion
from qmd_studio.cli.report import Report, Value
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.plots import check_plots, figure_5, figure_6

_PUBLISHED = (100, 62)
"""The paper's n and m of Figure 5."""


def run(arguments: Namespace) -> Report:
    """Draw a figure into OUT. Raises `CodecError` where matplotlib is absent or OUT is of no format it draws."""
    path = Path(arguments.output)
    if arguments.number == "6" and not arguments.input:
        raise UsageError("Figure 6 is drawn for a motion", wanted="qmd figure 6 IN -o OUT")
    check_plots(path)
    opened = open_motion(arguments.input, skeleton=arguments.skeleton) if arguments.input else None
    values: dict[str, Value] = {"figure": int(arguments.number), "written": str(path)}
    if arguments.number == "5" or opened is None:
        n, m = (opened.motion.n_frames - 1, opened.motion.skeleton.n_columns) if opened else _PUBLISHED
        figure_5(path, n, m)
        values |= {"n": n, "m": m}
    else:
        values["def"] = _figure_6(arguments, opened, path)
    warnings, notes = (opened.warnings, opened.notes) if opened else ((), ())
    return Report(values, [("written", str(path))], warnings, notes)


def _figure_6(arguments: Namespace, opened: OpenedMotion, path: Path) -> dict[str, Value]:
    base = QmdSettings(encoder=Encoder(arguments.encoder), k=arguments.k, rqt=arguments.rqt)
    curves = figure_6(path, evaluator_for(opened.motion, base), Path(arguments.input).stem)
    return {str(bits): values for bits, values in curves.items()}
