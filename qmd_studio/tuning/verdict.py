"""What a comparison comes to, in sentences that are computed from its rows, whoever wins."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from qmd_studio.tuning.comparison import Comparison, Row
from qmd_studio.tuning.contenders import PAPER

_NOTABLE = 1.1
"""Times that differ by less are the machine's mood."""


def verdict(comparison: Comparison) -> tuple[str, ...]:
    """Return who is smallest at the error, who is closest in the size, and where QMD loses; nothing where none met."""
    return tuple(sentence for sentence in (*_at_error(comparison), *_at_size(comparison)) if sentence)


def _at_error(comparison: Comparison) -> list[str]:
    rows = [row for row in comparison.at_error if row.met]
    if not rows:
        return []
    best = min(rows, key=_size)
    words = f"Smallest at {comparison.mean_error_mm:g} mm: {best.name}, {best.bytes_per_frame:.1f} bytes a frame"
    paper = _paper(comparison.at_error)
    if paper and not paper.met:
        words += f"; the paper's format does not get there with its own encoder ({paper.error.mean_mm:.3g} mm at best)"
    elif paper and paper is not best:
        words += f"; the paper's format takes {_times(_size(paper) / _size(best))} as much with its own encoder"
    return [f"{words}.", _slower(rows, best), _losers(rows, _size, "is smaller at this error than")]


def _slower(rows: Sequence[Row], best: Row) -> str:
    """Return what a QMD that is smallest pays in decoding: time against the smallest rival, work against other QMD."""
    rivals = [row for row in rows if not row.is_qmd]
    costs = []
    if best.is_qmd and rivals:
        rival = min(rivals, key=_size)
        ratio = best.decode_us / rival.decode_us
        if ratio > _NOTABLE:
            costs.append(f"{_times(ratio)} the time of {rival.name} to decode here")
    counted = [(row.instructions, row.name) for row in rows if row.instructions]
    if best.instructions and best.instructions > _NOTABLE * min(counted)[0]:
        least, name = min(counted)
        costs.append(f"{_times(best.instructions / least)} the instructions of {name} on a device")
    return f"It pays for that: {' and '.join(costs)}." if costs else ""


def _at_size(comparison: Comparison) -> list[str]:
    rows = [row for row in comparison.at_size if row.met]
    if not rows:
        return []
    best = min(rows, key=_def)
    words = f"Closest in {comparison.n_bytes:,} bytes: {best.name}, {best.error.mean_mm:.3g} mm"
    paper = _paper(comparison.at_size)
    if paper and paper.met and paper is not best and best.error.mean_mm > 0:
        ratio = paper.error.mean_mm / best.error.mean_mm
        words += f"; the paper's format is {_times(ratio)} as far off with its own encoder"
    return [f"{words}.", _losers(rows, _def, "is closer in this size than")]


def _losers(rows: Sequence[Row], measure: Callable[[Row], float], words: str) -> str:
    """Return which of QMD's rows lose to one that is not QMD's, "" where none does."""
    rivals = [row for row in rows if not row.is_qmd]
    if not rivals:
        return ""
    rival = min(rivals, key=measure)
    beaten = [row.name for row in rows if row.is_qmd and measure(row) > measure(rival)]
    return f"QMD loses here: {rival.name} {words} {_listed(beaten)}." if beaten else ""


def _listed(names: Sequence[str]) -> str:
    return "; ".join(names[:-1]) + (" and " if len(names) > 1 else "") + names[-1]


def _paper(rows: Sequence[Row]) -> Row | None:
    return next((row for row in rows if row.name == PAPER), None)


def _size(row: Row) -> float:
    return len(row.data)


def _def(row: Row) -> float:
    return row.error.def_


def _times(ratio: float) -> str:
    return f"{ratio:,.1f} times" if ratio < 100 else f"{ratio:,.0f} times"
