"""What a verb answers, and how it is printed: tidy lines for people, one JSON object for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from qmd_studio.errors import QmdStudioError

Value: TypeAlias = "str | int | float | Mapping[str, Value] | Sequence[Value] | None"


@dataclass(frozen=True, slots=True)
class Report:
    """A verb's answer: `values` are the keys of `--json`, `lines` the same for people, as (what, value) pairs.

    Where `failed`, a part of the input was at fault and the rest was done: the exit code says so.
    """

    values: Mapping[str, Value]
    lines: Sequence[tuple[str, str]]
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    failed: bool = False


def print_report(report: Report, *, as_json: bool) -> None:
    """Print the answer to stdout, warnings and notes to stderr.

    With `as_json` stdout holds exactly one object; warnings join it under "warnings" where there are any.
    """
    for warning in report.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if as_json:
        extra = {"warnings": list(report.warnings)} if report.warnings else {}
        print(json.dumps({**report.values, **extra}, allow_nan=False))
        return
    for note in report.notes:
        print(f"note: {note}", file=sys.stderr)
    width = max((len(what) for what, _ in report.lines), default=0)
    for what, value in report.lines:
        print(f"{what:<{width}}  {value}".rstrip())


def print_error(error: QmdStudioError, *, as_json: bool) -> None:
    """Print the error: one message to stderr, or one object to stdout with `as_json`."""
    if as_json:
        print(json.dumps(error.as_json()))
    else:
        print(f"qmd: {error}", file=sys.stderr)


def in_bytes(count: int) -> str:
    """Return a size for people: `28,725 bytes (28.1 KB)`; a KB is 1,024 bytes, as in the paper."""
    return f"{count:,} bytes ({count / 1024:.1f} KB)"


def in_mm(length_mm: float) -> str:
    """Return a length in millimetres with three significant digits."""
    return f"{length_mm:.3g} mm" if length_mm < 1000 else f"{length_mm:,.0f} mm"
