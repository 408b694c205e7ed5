"""`qmd compare`: QMD beside other codecs, at equal error and at equal size."""

from __future__ import annotations

import csv
import io
import os
from argparse import Namespace
from pathlib import Path

from qmd_studio import storage
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_motion
from qmd_studio.cli.progress import ProgressLine
from qmd_studio.cli.report import Report, Value
from qmd_studio.errors import QmdStudioError
from qmd_studio.tuning.comparison import Comparison, Row, compare
from qmd_studio.tuning.plots import check_plots, comparison_plot
from qmd_studio.tuning.verdict import verdict

HEADING = (
    "payload  complete  B/frame  kbit/s       DEF   mean mm    99 %     max    mm/s  enc µs  dec µs   instr. | setting"
)


def run(arguments: Namespace) -> Report:
    """Compare on IN. Raises `FormatError`, and `CodecError` where there is nothing to measure or to draw with."""
    for output in filter(None, (arguments.csv, arguments.plot)):
        if os.path.realpath(output) == os.path.realpath(arguments.input):
            raise UsageError("the motion itself would be written over", wanted="another name", got=output)
    if arguments.plot:
        check_plots(Path(arguments.plot))
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    line = ProgressLine(quiet=arguments.json)
    try:
        comparison = compare(
            opened.motion, mean_error_mm=arguments.mean_error_mm, n_bytes=arguments.size, on_progress=line.tell
        )
    except QmdStudioError as problem:
        raise problem.located(arguments.input) from None
    finally:
        line.close()
    lines = table_lines(comparison)
    if arguments.csv:
        storage.write_atomic(arguments.csv, csv_table(comparison))
        lines.append(("table", arguments.csv))
    if arguments.plot:
        comparison_plot(Path(arguments.plot), comparison, Path(arguments.input).stem)
        lines.append(("plot", arguments.plot))
    notes = (*opened.notes, *(f"absent: {reason}" for reason in comparison.absent))
    return Report(_values(comparison), lines, opened.warnings, notes)


def table_lines(comparison: Comparison) -> list[tuple[str, str]]:
    """Return the table of a comparison, and after it what it comes to, for people."""
    lines = [(f"mean {comparison.mean_error_mm:g} mm", HEADING)]
    lines += [(row.name, _figures(row, "not met: ")) for row in comparison.at_error]
    lines += [("", ""), (f"{comparison.n_bytes:,} bytes", HEADING)]
    lines += [(row.name, _figures(row, "too large: ")) for row in comparison.at_size]
    return [*lines, ("", ""), *(("", sentence) for sentence in verdict(comparison))]


def csv_table(comparison: Comparison) -> bytes:
    """Return all figures as CSV text, a line for each contender at each question ("error", "size")."""
    text = io.StringIO()
    rows = [{"at": at, **row.as_json()} for at, row in _questions(comparison)]
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["at"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def _questions(comparison: Comparison) -> list[tuple[str, Row]]:
    return [("error", row) for row in comparison.at_error] + [("size", row) for row in comparison.at_size]


def _values(comparison: Comparison) -> dict[str, Value]:
    return {
        "mean_error_mm": comparison.mean_error_mm,
        "size": comparison.n_bytes,
        "at_error": [row.as_json() for row in comparison.at_error],
        "at_size": [row.as_json() for row in comparison.at_size],
        "absent": list(comparison.absent),
        "verdict": list(verdict(comparison)),
    }


def _figures(row: Row, missed: str) -> str:
    error = row.error
    work = f"{row.instructions:,.0f}" if row.instructions is not None else ""
    return (
        f"{len(row.data):>7}  {row.file_bytes:>8}  {row.bytes_per_frame:>7.1f}  {row.kbps:>6.1f}"
        f"  {error.def_:>8.3g}  {error.mean_mm:>8.3g}  {error.p99_mm:>6.2g}  {error.max_mm:>6.2g}"
        f"  {error.velocity_mm_s:>6.3g}  {row.encode_us:>6.1f}  {row.decode_us:>6.2f}  {work:>7}"
        f" | {'' if row.met else missed}{row.setting}"
    )
