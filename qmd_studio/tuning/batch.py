"""Files times settings on all cores of this machine, or on a cluster: every file encoded and measured as the lab does.

A worker opens its files itself, so on a cluster they must have the same names everywhere.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from qmd_studio import registry, storage
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import CodecError, FormatError, QmdStudioError
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.session import TuningSession
from qmd_studio.tuning.size_figures import size_figures
from qmd_studio.tuning.trial import Cancel, Never

Row: TypeAlias = dict[str, str | int | float]
"""One line of the table that a batch makes; the keys are its columns."""

_CONNECT_S = 10


@dataclass(frozen=True, slots=True)
class Job:
    """One file and the settings to encode it with; FDF gives way where the motion has fewer columns.

    `skeleton` is for an AMC that finds none by its own name.
    """

    path: Path
    settings: tuple[QmdSettings, ...]
    skeleton: Path | None = None


@dataclass(frozen=True, slots=True)
class JobResult:
    """What came of a job: its `rows`, a `log` line for each step, and the `error` that ended it, if one did."""

    job: Job
    rows: tuple[Row, ...]
    log: tuple[str, ...]
    error: str | None = None


def digest_of(path: Path) -> str:
    """Return what tells this file's bytes from others', 16 hexadecimal digits; raises `StorageError`."""
    return hashlib.sha256(storage.read_bytes(path)).hexdigest()[:16]


def run_job(job: Job) -> JobResult:
    """Encode and measure one file with each of its settings. What is wrong with the file becomes `error`."""
    rows: list[Row] = []
    log: list[str] = []
    try:
        digest = digest_of(job.path)
        loaded = _opened(job)
        log += [f"warning: {warning}" for warning in loaded.warnings]
        if loaded.motion is None:
            raise FormatError("the file holds no motion", path=job.path, wanted="frames")
        log.append(f"opened: {loaded.motion.n_frames} frames of {loaded.motion.skeleton.n_columns} columns")
        session = TuningSession(loaded.motion)
        for settings in job.settings:
            row = _row(job, loaded.motion, session, settings.fitted(loaded.motion.skeleton.n_columns))
            rows.append({**row, "digest": digest})
            log.append(", ".join(f"{key} {row[key]}" for key in ("encoder", "fdf", "bits", "segment", "bytes", "def")))
    except QmdStudioError as error:
        return JobResult(job, tuple(rows), (*log, f"error: {error}"), str(error))
    return JobResult(job, tuple(rows), (*log, "done"))


def run_jobs(
    jobs: Sequence[Job], *, n_jobs: int = -1, cluster: str | None = None, cancel: Cancel | None = None
) -> Generator[JobResult, None, None]:
    """Yield the result of each job as it is done, in no certain order.

    `n_jobs` processes, -1 for one a core; or the workers of the Dask scheduler at the address `cluster`. When it has
    ended, been cancelled or closed, no job of it runs any more. Raises `CodecError` where the cluster is out of reach.
    """
    cancel = cancel or Never()
    from joblib import Parallel, delayed

    with ExitStack() as stack:
        if cluster:
            _use_cluster(stack, cluster)
        else:
            stack.callback(_end_workers)
        parallel = Parallel(n_jobs=n_jobs, batch_size=1, pre_dispatch="2*n_jobs", return_as="generator_unordered")
        results = parallel(delayed(run_job)(job) for job in _until(jobs, cancel))
        stack.callback(_drop, results)
        for result in results:
            yield result
            if cancel.is_set():
                return


def _opened(job: Job) -> Loaded:
    try:
        return registry.open_file(job.path)
    except FormatError:
        if job.skeleton is None:
            raise
        return registry.open_file(job.path, ReadOptions(skeleton=job.skeleton))


def _until(jobs: Iterable[Job], cancel: Cancel) -> Iterator[Job]:
    for job in jobs:
        if cancel.is_set():
            return
        yield job


def _use_cluster(stack: ExitStack, address: str) -> None:
    try:
        from distributed import Client
    except ImportError:
        raise CodecError("a cluster needs Dask", hint='Install it: pip install "qmd-studio[cluster]"') from None
    from joblib import parallel_config

    try:
        client = stack.enter_context(Client(address, timeout=_CONNECT_S, set_as_default=False))
    except (OSError, ValueError) as problem:
        raise CodecError(
            "the cluster cannot be reached",
            wanted="the address of a Dask scheduler, such as tcp://host:8786",
            got=address,
            hint="Start one with: dask scheduler, and workers with: dask worker " + address,
        ) from problem
    stack.enter_context(parallel_config("dask", client=client))


def _drop(results: Generator[JobResult, None, None]) -> None:
    """Call off what is still running; that is what was asked for, so joblib need not warn of it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        results.close()


def _end_workers() -> None:
    """End joblib's processes, which would otherwise wait for more work for minutes."""
    from joblib.externals.loky import get_reusable_executor

    get_reusable_executor().shutdown(wait=True, kill_workers=True)


def _row(job: Job, motion: Motion, session: TuningSession, settings: QmdSettings) -> Row:
    report = session.evaluate(settings)
    settings, figures = report.settings, size_figures(motion, report.settings)
    error: dict[str, Any] = report.error.as_json()
    return {
        "file": str(job.path),
        "frames": motion.n_frames,
        "columns": motion.skeleton.n_columns,
        "encoder": str(settings.encoder),
        "fdf": settings.fdf,
        "bits": settings.bits,
        "segment": settings.segment,
        "k": str(settings.k),
        "rqt": settings.rqt,
        "bytes": report.size.bytes,
        "file_bytes": report.file_bytes,
        "percent_of_raw": round(figures.percent_of_raw, 3),
        "kbit_s": round(figures.kbit_s, 3),
        **error,
        "seconds": round(report.seconds, 6),
    }
