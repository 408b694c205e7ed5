"""`qmd tune`: the best settings for a motion, by the paper's figure of merit or for a target."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import dataclass, replace
from pathlib import Path

from qmd_studio.cli.load import open_motion
from qmd_studio.cli.measure import error_lines
from qmd_studio.cli.parser import TARGETS
from qmd_studio.cli.progress import ProgressLine
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import MAX_LEVEL
from qmd_studio.tuning.across import across
from qmd_studio.tuning.attempts import by_merit
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import Grid, paper_grid, wide_grid
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import OnProgress, Outcome
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.reductions import combined, distinct
from qmd_studio.tuning.report import EncodeReport
from qmd_studio.tuning.search import search
from qmd_studio.tuning.targets import Target, TargetKind, meet
from qmd_studio.tuning.trial import Trial


@dataclass(frozen=True, slots=True, eq=False)
class _Field:
    """One reduction, the motion that it leaves, and the grid that is searched on that."""

    reduction: Reduction
    left: Motion
    grid: Grid

    @property
    def n_settings(self) -> int:
        return sum(len(column.bits) for column in self.grid.columns(self.left))


def run(arguments: Namespace) -> Report:
    """Search the settings for IN. Raises `FormatError`, `CodecError` where the grid allows no setting at all."""
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    motion, target = opened.motion, _target(arguments)
    line = ProgressLine(quiet=arguments.json)
    try:
        line.tell(0, 1, "getting ready")
        fields = _fields(arguments, motion, target)
        outcome = _found(arguments, motion, fields, target, line)
    finally:
        line.close()
    if outcome.best is None:
        raise CodecError(
            "the grid holds no setting for this motion",
            wanted=_allowed(_grid(arguments, motion, target), motion),
            hint="Widen it with --fdf, --bits and --segments, or allow larger files with --any-size",
        )
    report = ReducedSession(motion, outcome.best.settings.reduction).evaluate(outcome.best.paper)
    values: dict[str, Value] = {
        "evaluations": outcome.evaluations,
        "seconds": round(outcome.seconds, 6),
        "settings": sum(field.n_settings for field in fields),
        "best": _best(outcome.best, report),
    }
    if target:
        met = target.met_by(outcome.best, motion)
        values["target"] = {"kind": str(target.kind), "value": target.value, "met": met}
    return Report(values, _lines(outcome, report, fields, motion, target), opened.warnings, opened.notes)


def _fields(arguments: Namespace, motion: Motion, target: Target | None) -> list[_Field]:
    wanted = combined(arguments.every, arguments.max_level, arguments.max_loa)
    reduced = [(reduction, reduction.reduce(motion)) for reduction in distinct(wanted, motion)]
    return [_Field(reduction, left, _grid(arguments, left, target)) for reduction, left in reduced]


def _found(
    arguments: Namespace, motion: Motion, fields: list[_Field], target: Target | None, line: ProgressLine
) -> Outcome:
    rank = target.rank(motion) if target else by_merit
    searches = [lambda tell, field=field: _searched(arguments, motion, field, target, tell) for field in fields]
    return across(searches, rank=rank, on_progress=line.of_search)


def _searched(arguments: Namespace, motion: Motion, field: _Field, target: Target | None, tell: OnProgress) -> Outcome:
    base = QmdSettings(encoder=Encoder(arguments.encoder), k=arguments.k, rqt=arguments.rqt)
    evaluator, grid = evaluator_for(motion, base, field.reduction), field.grid
    memory = Memory(evaluator, _state(arguments.state, evaluator.reduction))
    if target:
        thorough = True if arguments.exhaustive else None
        return meet(evaluator, grid, target, memory=memory, on_progress=tell, thorough=thorough)
    find = exhaustive if arguments.exhaustive else search
    return find(evaluator, grid, memory=memory, on_progress=tell)


def _state(path: str | None, reduction: Reduction) -> Path | None:
    """Return the file that keeps a search: the one named for all of a motion, one beside it for each reduction."""
    if path is None or reduction == Reduction():
        return Path(path) if path else None
    named = Path(path)
    loa = "" if reduction.max_loa is None else f"-loa{reduction.max_loa}"
    return named.with_stem(f"{named.stem}-every{reduction.fps_divisor}-level{reduction.max_level}{loa}")


def _target(arguments: Namespace) -> Target | None:
    for kind in TARGETS:
        value = getattr(arguments, f"target_{kind.replace('-', '_')}")
        if value is not None:
            return Target(TargetKind(kind), value)
    return None


def _grid(arguments: Namespace, motion: Motion, target: Target | None) -> Grid:
    name = arguments.grid or ("wide" if target else "paper")
    grid = paper_grid(motion) if name == "paper" else wide_grid(motion)
    bounds = {"fdf": arguments.fdf, "bits": arguments.bits, "segments": arguments.segments}
    grid = replace(grid, **{name: values for name, values in bounds.items() if values is not None})
    return grid.unbounded() if arguments.any_size else grid


def _allowed(grid: Grid, motion: Motion) -> str:
    fdf = f"an FDF of at most {motion.skeleton.n_columns}"
    if grid.largest_bytes is None:
        return fdf
    return f"{fdf} and a payload of at most {grid.largest_bytes:,} bytes, the raw motion's"


def _best(best: Trial, report: EncodeReport) -> dict[str, Value]:
    reduction = best.settings.reduction
    return {
        "encoder": str(best.paper.encoder),
        "fdf": best.paper.fdf,
        "bits": best.paper.bits,
        "segment": best.paper.segment,
        "every": reduction.fps_divisor,
        "max_level": reduction.max_level,
        "max_loa": reduction.max_loa,
        "bytes": best.bytes,
        "file_bytes": report.file_bytes,
        "merit": best.merit,
        **report.error.as_json(),
    }


def _lines(
    outcome: Outcome, report: EncodeReport, fields: list[_Field], motion: Motion, target: Target | None
) -> list[tuple[str, str]]:
    settings, lines = report.settings, []
    if target and outcome.best and not target.met_by(outcome.best, motion):
        lines.append(("target", f"{target.kind} {target.value:g} cannot be met; the best is:"))
    segment = f"n_d {settings.segment}" if settings.segment else "one segment"
    lines.append(("best", f"{settings.encoder} encoder, FDF {settings.fdf}, b {settings.bits}, {segment}"))
    if len(fields) > 1 and outcome.best:
        lines.append(("kept", _kept(outcome.best.settings.reduction)))
    n_settings = sum(field.n_settings for field in fields)
    reductions = f" in {len(fields)} reductions" if len(fields) > 1 else ""
    return [
        *lines,
        ("payload", in_bytes(report.size.bytes)),
        ("bytes × DEF", f"{report.size.bytes * report.error.def_:,.4g}"),
        *error_lines(report.error),
        ("grid", _described(fields[0].grid, fields[0].left)),
        ("tried", f"{outcome.evaluations:,} of {n_settings:,} settings{reductions} in {outcome.seconds:.2f} s"),
    ]


def _kept(reduction: Reduction) -> str:
    words = [f"every {reduction.fps_divisor} frames" if reduction.fps_divisor > 1 else "all frames"]
    words.append(f"levels up to {reduction.max_level}" if reduction.max_level < MAX_LEVEL else "all levels")
    if reduction.max_loa is not None:
        words.append(f"LOA {reduction.max_loa}")
    return ", ".join(words)


def _described(grid: Grid, motion: Motion) -> str:
    n_d = ", ".join(str(segment or f"{motion.n_frames - 1} (one segment)") for segment in _ends(grid.segments))
    fdf, bits = (" … ".join(map(str, _ends(values))) for values in (grid.fdf, grid.bits))
    bound = "no file larger than the raw motion" if grid.largest_bytes else "files of any size"
    return f"FDF {fdf}; b {bits}; n_d {n_d.replace(', ', ' … ')}; {bound}"


def _ends(values: tuple[int, ...]) -> tuple[int, ...]:
    return values if len(values) < 3 else (values[0], values[-1])
