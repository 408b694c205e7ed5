"""The folder of a batch: one CSV of all results, a log for each file, and what is done already."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from qmd_studio import storage
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import FormatError
from qmd_studio.tuning.batch import Job, JobResult, Row, digest_of

_STATE, _TABLE, _LOGS = "batch.json", "batch.csv", "logs"


class BatchFolder:
    """Keeps the results of a batch in `folder`, which is made where it is absent.

    A later batch with the same folder does only what is missing: other files, other settings, files that have changed.
    Raises `FormatError` for a damaged folder, `StorageError` where it cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / _LOGS).mkdir(parents=True, exist_ok=True)
        self.rows: list[Row] = self._load()

    @property
    def table(self) -> Path:
        """The CSV, a line for each file and setting."""
        return self._folder / _TABLE

    def missing(self, jobs: Sequence[Job]) -> list[Job]:
        """Return `jobs` without the settings whose results are here."""
        done = {(row["file"], row["digest"], row["asked"]) for row in self.rows}
        rest = []
        for job in jobs:
            digest = digest_of(job.path) if any(row["file"] == str(job.path) for row in self.rows) else ""
            wanted = tuple(s for s in job.settings if (str(job.path), digest, _asked(s)) not in done)
            if wanted:
                rest.append(replace(job, settings=wanted))
        return rest

    def add(self, result: JobResult) -> None:
        """Keep a result: its rows in place of those of an older version of the file, and its log."""
        digest = result.rows[0]["digest"] if result.rows else None
        path = str(result.job.path)
        kept = [row for row in self.rows if row["file"] != path or row["digest"] == digest or digest is None]
        asked = [_asked(settings) for settings in result.job.settings]
        new = [{**row, "asked": asked} for row, asked in zip(result.rows, asked, strict=False)]
        self.rows = kept + new
        self._save()
        log = "".join(f"{line}\n" for line in (path, *result.log))
        storage.write_atomic(self._folder / _LOGS / f"{_log_name(result.job.path)}.log", log.encode())

    def _save(self) -> None:
        storage.write_atomic(self._folder / _STATE, json.dumps({"version": 1, "rows": self.rows}).encode())
        text = io.StringIO()
        columns = [key for key in (self.rows[0] if self.rows else {}) if key not in ("asked", "digest")]
        table = csv.DictWriter(text, columns, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(sorted(self.rows, key=lambda row: str(row["file"])))
        storage.write_atomic(self.table, text.getvalue().encode())

    def _load(self) -> list[Row]:
        path = self._folder / _STATE
        if not path.exists():
            return []
        try:
            rows: list[Any] = json.loads(storage.read_bytes(path))["rows"]
            if not all({"file", "digest", "asked"} <= row.keys() for row in rows):
                raise ValueError("a row lacks its file")
        except (ValueError, KeyError, TypeError, AttributeError) as problem:
            raise FormatError(
                "the saved batch cannot be read", path=path, hint="Remove the file to start the batch anew"
            ) from problem
        return rows


def _asked(settings: QmdSettings) -> str:
    """Return settings as they were asked for: what a motion makes of them may differ."""
    return f"{settings.encoder} {settings.fdf} {settings.bits} {settings.segment} {settings.k} {settings.rqt}"


def _log_name(path: Path) -> str:
    """Return a name for the file's log that no other file of the batch has, unless folders differ in "_" alone."""
    return "_".join(part for part in path.parts if part not in ("/", "..", "."))
