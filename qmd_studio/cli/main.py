"""`qmd`: the studio's verbs without a window."""

from __future__ import annotations

import io
import os
import sys
import threading
from collections.abc import Sequence

from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.parser import build_parser
from qmd_studio.cli.report import print_error, print_report
from qmd_studio.errors import CodecError, QmdStudioError

EXIT_INPUT = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb and return the exit code: 0, 1 where the input is at fault, 2 where the command line is."""
    words = list(sys.argv[1:] if argv is None else argv)
    _print_any_character()
    try:
        code = _run(words, as_json="--json" in words)
        if sys.stdout:  # None where whoever called has closed it
            sys.stdout.flush()
    except BrokenPipeError:
        _forget_output()  # whoever read it has seen enough
        return 0
    except OSError as problem:
        _forget_output()
        print(f"qmd: the output could not be written: {problem.strerror}", file=sys.stderr)
        return EXIT_INPUT
    except KeyboardInterrupt:
        _end_threads()
        return EXIT_INTERRUPTED
    return code


def _run(words: list[str], *, as_json: bool) -> int:
    try:
        arguments = build_parser().parse_args(words)
        report = arguments.run(arguments)
        print_report(report, as_json=as_json)
    except UsageError as error:
        if not as_json:
            print(error.usage, end="", file=sys.stderr)
        print_error(error, as_json=as_json)
        return EXIT_USAGE
    except QmdStudioError as error:
        print_error(error, as_json=as_json)
        return EXIT_INPUT
    except MemoryError:
        hint = "Take a part of the motion, or close other programs"
        print_error(CodecError("there is not enough memory for this motion", hint=hint), as_json=as_json)
        return EXIT_INPUT
    return EXIT_INPUT if report.failed else 0


def _print_any_character() -> None:
    """Let a terminal that lacks a character show its code instead of ending the program."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _end_threads() -> None:
    """End the program at once where threads of a search still encode: Python would wait for them, a minute or more."""
    if any(thread.name.startswith("qmd-tuning") for thread in threading.enumerate()):
        for stream in (sys.stdout, sys.stderr):
            if stream:
                stream.flush()
        os._exit(EXIT_INTERRUPTED)


def _forget_output() -> None:
    """Drop what could not be written, or Python would complain of it once more when it closes stdout at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    raise SystemExit(main())
