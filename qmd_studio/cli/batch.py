"""`qmd batch`: many files with many settings, on all cores or on a cluster, into one folder."""

from __future__ import annotations

import time
from argparse import Namespace
from contextlib import closing
from itertools import product
from pathlib import Path

from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.progress import ProgressLine
from qmd_studio.cli.report import Report, Value
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import StorageError
from qmd_studio.tuning.batch import Job, run_jobs
from qmd_studio.tuning.batch_folder import BatchFolder
from qmd_studio.tuning.plots import batch_plot, check_plots

_MOTION_SUFFIXES = frozenset((".amc", ".bvh", ".bap", ".csv", ".npz"))


def run(arguments: Namespace) -> Report:
    """Run what is missing of a batch. Files that cannot be encoded are told, and stop only the exit code from being 0.

    Raises `StorageError` where the folder cannot be made, `CodecError` where plots or the cluster cannot be had.
    """
    if arguments.plot:
        check_plots(Path(arguments.plot))
    jobs = _jobs(arguments)
    started = time.perf_counter()
    try:
        folder = BatchFolder(Path(arguments.output))
    except OSError as problem:
        raise StorageError(f"the folder cannot be made: {problem.strerror}", path=arguments.output) from problem
    missing = folder.missing(jobs)
    failed: list[str] = []
    line = ProgressLine(quiet=arguments.json)
    results = run_jobs(missing, n_jobs=arguments.jobs or -1, cluster=arguments.cluster)
    with closing(results):
        for done, result in enumerate(results, start=1):
            folder.add(result)
            if result.error:
                failed.append(result.error)
            line.tell(done, len(missing), result.job.path.name)
    line.close()
    if arguments.plot and folder.rows:
        batch_plot(Path(arguments.plot), folder.rows)
    seconds = time.perf_counter() - started
    values: dict[str, Value] = {
        "files": len(jobs),
        "done_before": len(jobs) - len(missing),
        "failed": len(failed),
        "rows": len(folder.rows),
        "seconds": round(seconds, 3),
        "table": str(folder.table),
    }
    lines = [
        ("files", f"{len(jobs):,}, of which {len(jobs) - len(missing):,} were done before and {len(failed):,} failed"),
        ("results", f"{len(folder.rows):,} in {folder.table}"),
        ("took", f"{seconds:.2f} s"),
    ]
    return Report(values, lines, tuple(failed), failed=bool(failed))


def _jobs(arguments: Namespace) -> list[Job]:
    settings = tuple(
        QmdSettings(fdf=fdf, bits=bits, segment=segment, encoder=Encoder(encoder))
        for encoder, fdf, bits, segment in product(
            arguments.encoder, arguments.fdf or (6,), arguments.bits or (8,), arguments.segments or (0,)
        )
    )
    skeleton = Path(arguments.skeleton) if arguments.skeleton else None
    paths = dict.fromkeys(path for name in arguments.inputs for path in _motions(Path(name)))
    if not paths:
        raise UsageError("there is no motion in these folders", got=", ".join(arguments.inputs))
    return [Job(path, settings, skeleton) for path in paths]


def _motions(path: Path) -> list[Path]:
    """Return the path itself, or all files below a folder that hold motion by their suffix."""
    if not path.is_dir():
        return [path]
    return sorted(file for file in path.rglob("*") if file.suffix.lower() in _MOTION_SUFFIXES and file.is_file())
