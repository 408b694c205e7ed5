"""Which reductions a search may try: their combinations, without those that come to the same on a motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product

from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.tuning.encode_settings import fitted_reduction, has_articulation
from qmd_studio.tuning.reduction import Reduction

_LAB_EVERY, _LAB_LEVELS, _LAB_LOA = (2, 3, 4, 8), (5, 4), (2, 1)


def combined(
    every: Sequence[int] = (1,), max_level: Sequence[int] = (MAX_LEVEL,), max_loa: Sequence[int | None] = (None,)
) -> tuple[Reduction, ...]:
    """Return all combinations, in the order given; raises `CodecError` for a value out of range."""
    return tuple(Reduction(*values) for values in product(every, max_level, max_loa))


def distinct(reductions: Iterable[Reduction], motion: Motion) -> tuple[Reduction, ...]:
    """Return those that leave something else than the ones before, fitted to `motion`.

    One that leaves no column is passed over; raises `CodecError` where no reduction is left.
    """
    found: dict[tuple[int, bytes], Reduction] = {}
    problem = CodecError("no reduction was given", hint="Keep all frames and columns, or name what to leave out")
    for reduction in reductions:
        fitted = fitted_reduction(reduction, motion)
        try:
            kept = fitted.kept_columns(motion.skeleton)
        except CodecError as error:
            problem = error
            continue
        found.setdefault((fitted.fps_divisor, kept.tobytes()), fitted)
    if not found:
        raise problem
    return tuple(found.values())


def lab_reductions(motion: Motion) -> tuple[Reduction, ...]:
    """Return a few reductions that are worth a try beside none: fewer frames, fewer joints, and both; none comes first.

    Joints go by level of articulation where there is one, otherwise by the paper's level.
    """
    if has_articulation(motion):
        fewer = [Reduction(max_loa=loa) for loa in _LAB_LOA]
    else:
        fewer = [Reduction(max_level=level) for level in _LAB_LEVELS]
    both = Reduction(2, fewer[0].max_level, fewer[0].max_loa)
    return distinct([Reduction(), *(Reduction(every) for every in _LAB_EVERY), *fewer, both], motion)
