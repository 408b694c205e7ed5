"""The words of the command line: verbs, the options that several of them have, and readers of values with ranges."""

from __future__ import annotations

import math
import re
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from importlib import import_module
from typing import Any, NoReturn

from qmd_studio.cli.report import Report
from qmd_studio.errors import QmdStudioError

MAX_COUNT = 1 << 31
"""Counts on the command line stay below this: no file could hold more rows."""


class UsageError(QmdStudioError):
    """The command line itself is wrong. `usage` is the short form of what would be right."""

    usage: str = ""


class Parser(ArgumentParser):
    """An `ArgumentParser` whose mistakes can be told as JSON too, so it raises instead of exiting."""

    def error(self, message: str) -> NoReturn:
        """Raise `UsageError` for `message`, what argparse calls the mistake."""
        problem = UsageError(message, hint=f"See {self.prog} --help")
        problem.usage = self.format_usage()
        raise problem


def add_verb(verbs: Any, name: str, summary: str, module: str | None = None) -> ArgumentParser:
    """Add the verb `name`; what runs it is `run` of the module `qmd_studio.cli.<module>`, by default its own name's."""
    parser: ArgumentParser = verbs.add_parser(
        name, help=summary, description=summary[0].upper() + summary[1:] + ".", allow_abbrev=False
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    parser.set_defaults(run=_late(module or name))
    return parser


def _late(verb: str) -> Callable[[Namespace], Report]:
    """Return the verb's function without importing its module yet: help and mistakes cost no NumPy."""

    def run(arguments: Namespace) -> Report:
        report: Report = import_module(f"qmd_studio.cli.{verb}").run(arguments)
        return report

    return run


def add_skeleton(parser: ArgumentParser) -> None:
    """Add the option that names the skeleton of an AMC."""
    parser.add_argument("--skeleton", metavar="ASF", help="the skeleton of an AMC, where it is not found beside it")


def add_whole(
    parser: ArgumentParser, option: str, metavar: str, *, low: int, high: int = MAX_COUNT, **more: Any
) -> None:
    """Add an option that takes a whole number from `low` to `high`."""
    parser.add_argument(option, metavar=metavar, type=whole(option, low, high), **more)


def whole(option: str, low: int, high: int) -> Callable[[str], int]:
    """Return the reader of a whole number from `low` to `high`."""
    wanted = f"a whole number from {low} " + (f"to {high}" if high < MAX_COUNT else "up")

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise bad_value(option, wanted, text) from None
        if value > high:
            raise bad_value(option, f"a whole number from {low} to {high}", text)
        if value < low:
            raise bad_value(option, wanted, text)
        return value

    return read


_MOST_IN_LIST = 100_000


def wholes(option: str, low: int, high: int) -> Callable[[str], tuple[int, ...]]:
    """Return the reader of whole numbers and ranges, "0,6,10-20:5", both ends of a range included."""
    wanted = f"whole numbers from {low} " + (f"to {high}" if high < MAX_COUNT else "up") + ", such as 8,10-16:2"

    def read(text: str) -> tuple[int, ...]:
        found: list[int] = []
        for part in text.split(","):
            match = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9})(?::(\d{1,9}))?)?", part.strip(), re.ASCII)
            first, last, step = (int(group) if group else None for group in match.groups()) if match else (None,) * 3
            if first is None or step == 0:
                raise bad_value(option, wanted, text)
            values = range(first, (first if last is None else last) + 1, step or 1)
            if not values or len(values) > _MOST_IN_LIST or values[0] < low or values[-1] > high:
                raise bad_value(option, wanted, text)
            found += values
        return tuple(dict.fromkeys(found))

    return read


def above_zero(option: str) -> Callable[[str], float]:
    """Return the reader of a positive number."""
    return lambda text: number(option, "a positive number", text, lambda value: 0 < value < math.inf)


def frame_rate(text: str) -> float:
    """Read a number of frames a second."""
    low, high = 1e-3, 1e5  # `FRAME_RATES` of the motion, whose module would load NumPy
    return number("--fps", f"{low:g} to {high:g} frames a second", text, lambda value: low <= value <= high)


def weight(text: str) -> float:
    """Read the exponent of the paper's weights."""
    return number("--k", "a number from 0 up, or inf", text, lambda value: value >= 0)


def distance(option: str) -> Callable[[str], float]:
    """Return the reader of a distance in millimetres."""
    return lambda text: number(option, "millimetres above 0", text, lambda value: 0 < value < math.inf)


def number(option: str, wanted: str, text: str, fits: Callable[[float], bool]) -> float:
    """Read a number; raises `UsageError` with what is `wanted` where `text` is none or does not fit."""
    try:
        value = float(text)
    except ValueError:
        raise bad_value(option, wanted, text) from None
    if not fits(value):
        raise bad_value(option, wanted, text)
    return value


def bad_value(option: str, wanted: str, got: str) -> UsageError:
    """Return the error for a value that `option` does not take."""
    return UsageError(f"{option} does not take this value", wanted=wanted, got=repr(got), hint="See qmd --help")
