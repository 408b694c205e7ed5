"""What a search came to, and what is told while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from qmd_studio.tuning.trial import Trial


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a search is: settings `done` of `total`, the `best` so far, and the `latest` ones."""

    done: int
    total: int
    best: Trial | None
    latest: tuple[Trial, ...]


OnProgress: TypeAlias = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """The `best` of all `trials` (None where there are none), and what was asked for.

    `evaluations` counts encodings made now, not those remembered from an earlier run. `complete` is False for a search
    that was stopped.
    """

    best: Trial | None
    trials: tuple[Trial, ...]
    evaluations: int
    seconds: float
    complete: bool
