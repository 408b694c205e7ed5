"""What an encoder that was asked for too small an error says it can reach."""

from __future__ import annotations

import math
import re

from qmd_studio.errors import QmdStudioError

_MARGIN = 1.05
"""What is named is rounded, and an encoder that aims at it exactly may just miss."""

_MILLIMETRES = re.compile(r"^([0-9.e+-]+) mm\b")


def reachable_mm(problem: QmdStudioError) -> float | None:
    """Return the error in mm that `problem` names as the best there is, None where it is about something else."""
    found = _MILLIMETRES.match(problem.got or "")
    try:
        return float(found[1]) if found else None
    except ValueError:
        return None


def allowance_mm(best_mm: float) -> float:
    """Return an error that will be kept to where `best_mm` is said to be the best: a little more, in two digits."""
    wanted = best_mm * _MARGIN
    place = 10.0 ** (math.floor(math.log10(wanted)) - 1)
    return float(f"{math.ceil(wanted / place) * place:.2g}")
