"""`qmd`: the studio's verbs without a window."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from qmd_studio.cli.parser import UsageError, build_parser
from qmd_studio.cli.report import print_error, print_report
from qmd_studio.errors import QmdStudioError

EXIT_INPUT = 1
EXIT_USAGE = 2


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb and return the exit code: 0, 1 where the input is at fault, 2 where the command line is."""
    words = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in words
    try:
        code = _run(words, as_json=as_json)
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read our output has seen enough. Python would complain once more when it closes stdout at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return 130
    return code


def _run(words: list[str], *, as_json: bool) -> int:
    try:
        arguments = build_parser().parse_args(words)
        print_report(arguments.run(arguments), as_json=as_json)
    except UsageError as error:
        if not as_json:
            print(error.usage, end="", file=sys.stderr)
        print_error(error, as_json=as_json)
        return EXIT_USAGE
    except QmdStudioError as error:
        print_error(error, as_json=as_json)
        return EXIT_INPUT
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
