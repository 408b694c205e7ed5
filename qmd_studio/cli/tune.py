"""`qmd tune`: the best settings for a motion, by the paper's figure of merit or for a target."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from qmd_studio.cli.load import open_motion
from qmd_studio.cli.measure import error_lines
from qmd_studio.cli.parser import TARGETS
from qmd_studio.cli.progress import ProgressLine
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import Grid, paper_grid, wide_grid
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.outcome import Outcome
from qmd_studio.tuning.report import EncodeReport
from qmd_studio.tuning.search import search
from qmd_studio.tuning.session import TuningSession
from qmd_studio.tuning.targets import Target, TargetKind, meet
from qmd_studio.tuning.trial import Trial


def run(arguments: Namespace) -> Report:
    """Search the settings for IN. Raises `FormatError`, `CodecError` where the grid allows no setting at all."""
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    motion, target = opened.motion, _target(arguments)
    grid = _grid(arguments, motion, target)
    base = QmdSettings(encoder=Encoder(arguments.encoder), k=arguments.k, rqt=arguments.rqt)
    outcome = _found(arguments, motion, base, grid, target)
    if outcome.best is None:
        raise CodecError(
            "the grid holds no setting for this motion",
            wanted=_allowed(grid, motion),
            hint="Widen it with --fdf, --bits and --segments, or allow larger files with --any-size",
        )
    report = TuningSession(motion).evaluate(outcome.best.settings)
    met = target.met_by(outcome.best, motion) if target else None
    values: dict[str, Value] = {
        "evaluations": outcome.evaluations,
        "seconds": round(outcome.seconds, 6),
        "settings": _count(grid, motion),
        "best": _best(outcome.best, report),
    }
    if target:
        values["target"] = {"kind": str(target.kind), "value": target.value, "met": met}
    return Report(values, _lines(outcome, report, grid, motion, target), opened.warnings, opened.notes)


def _found(arguments: Namespace, motion: Motion, base: QmdSettings, grid: Grid, target: Target | None) -> Outcome:
    line = ProgressLine(quiet=arguments.json)
    try:
        line.tell(0, 1, "getting ready")
        evaluator = evaluator_for(motion, base)
        memory = Memory(evaluator, Path(arguments.state) if arguments.state else None)
        if target:
            thorough = True if arguments.exhaustive else None
            return meet(evaluator, grid, target, memory=memory, on_progress=line.of_search, thorough=thorough)
        find: Callable[..., Outcome] = exhaustive if arguments.exhaustive else search
        return find(evaluator, grid, memory=memory, on_progress=line.of_search)
    finally:
        line.close()


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


def _count(grid: Grid, motion: Motion) -> int:
    return sum(len(column.bits) for column in grid.columns(motion))


def _allowed(grid: Grid, motion: Motion) -> str:
    fdf = f"an FDF of at most {motion.skeleton.n_columns}"
    if grid.largest_bytes is None:
        return fdf
    return f"{fdf} and a payload of at most {grid.largest_bytes:,} bytes, the raw motion's"


def _best(best: Trial, report: EncodeReport) -> dict[str, Value]:
    return {
        "encoder": str(best.settings.encoder),
        "fdf": best.settings.fdf,
        "bits": best.settings.bits,
        "segment": best.settings.segment,
        "bytes": best.bytes,
        "file_bytes": report.file_bytes,
        "merit": best.merit,
        **report.error.as_json(),
    }


def _lines(
    outcome: Outcome, report: EncodeReport, grid: Grid, motion: Motion, target: Target | None
) -> list[tuple[str, str]]:
    settings, lines = report.settings, []
    if target and outcome.best and not target.met_by(outcome.best, motion):
        lines.append(("target", f"{target.kind} {target.value:g} cannot be met; the best is:"))
    segment = f"n_d {settings.segment}" if settings.segment else "one segment"
    lines += [
        ("best", f"{settings.encoder} encoder, FDF {settings.fdf}, b {settings.bits}, {segment}"),
        ("payload", in_bytes(report.size.bytes)),
        ("bytes × DEF", f"{report.size.bytes * report.error.def_:,.4g}"),
        *error_lines(report.error),
        ("grid", _described(grid, motion)),
        ("tried", f"{outcome.evaluations:,} of {_count(grid, motion):,} settings in {outcome.seconds:.2f} s"),
    ]
    return lines


def _described(grid: Grid, motion: Motion) -> str:
    n_d = ", ".join(str(segment or f"{motion.n_frames - 1} (one segment)") for segment in _ends(grid.segments))
    fdf, bits = (" … ".join(map(str, _ends(values))) for values in (grid.fdf, grid.bits))
    bound = "no file larger than the raw motion" if grid.largest_bytes else "files of any size"
    return f"FDF {fdf}; b {bits}; n_d {n_d.replace(', ', ' … ')}; {bound}"


def _ends(values: tuple[int, ...]) -> tuple[int, ...]:
    return values if len(values) < 3 else (values[0], values[-1])
