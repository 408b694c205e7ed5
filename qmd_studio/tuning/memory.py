"""What a search has found, kept in a file, so that a search that was stopped goes on where it was."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

import numpy as np

from qmd_studio import storage
from qmd_studio.errors import FormatError
from qmd_studio.motion.skeleton_json import json_text, skeleton_to_json
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction
from qmd_studio.tuning.trial import Evaluator, Trial

_SAVE_EVERY_S = 2.0
_VERSION = 1
_REDUCTION = "reduction"


class Memory:
    """The trials of one motion and one encoder, by setting; kept in `path` if there is one.

    Raises `FormatError` for a file that is damaged, or that is of another motion or encoder, and `StorageError` where
    it cannot be read or written. `clock` tells seconds.
    """

    def __init__(
        self, evaluator: Evaluator, path: Path | None = None, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._base, self._reduction = evaluator.base, evaluator.reduction
        self._path, self._clock = path, clock
        self._about = {"version": _VERSION, **_identity(evaluator)}
        self._trials: dict[tuple[int, int, int], Trial] = {}
        self._saved_at = clock()
        if path is not None and path.exists():
            self._load(path)

    def get(self, fdf: int, bits: int, segment: int) -> Trial | None:
        """Return the trial of a setting, None where it has not been tried."""
        return self._trials.get((fdf, bits, segment))

    def add(self, trials: list[Trial]) -> None:
        """Remember `trials`, and save every other second or so."""
        for trial in trials:
            settings = trial.paper
            self._trials[settings.fdf, settings.bits, settings.segment] = trial
        if self._clock() - self._saved_at > _SAVE_EVERY_S:
            self.save()

    def save(self) -> None:
        """Write the file, if there is one."""
        if self._path is None:
            return
        rows = [[*key, t.bytes, t.def_, t.mean_mm, t.max_mm] for key, t in sorted(self._trials.items())]
        storage.write_atomic(self._path, json.dumps({**self._about, "trials": rows}).encode())
        self._saved_at = self._clock()

    def _load(self, path: Path) -> None:
        try:
            contents = json.loads(storage.read_bytes(path))
            about = {key: contents[key] for key in self._about if key != _REDUCTION}
            about[_REDUCTION] = contents.get(_REDUCTION)  # files of before there were reductions do not say
            rows = [_checked(row) for row in contents["trials"]]
        except (ValueError, KeyError, TypeError) as problem:
            raise FormatError(
                "the saved search cannot be read", path=path, hint="Remove the file to search anew"
            ) from problem
        if about != self._about:
            wrong = next(key for key in self._about if about[key] != self._about[key])
            raise FormatError(
                f"the saved search is of another {wrong}",
                path=path,
                wanted=str(self._about[wrong]),
                got=str(about[wrong]),
                hint="Name another file, or remove this one to search anew",
            )
        for fdf, bits, segment, size, *error in rows:
            settings = replace(self._base, fdf=fdf, bits=bits, segment=segment)
            self._trials[fdf, bits, segment] = Trial(EncodeSettings(settings, self._reduction), size, *error)


def _checked(row: Any) -> tuple[int, int, int, int, float, float, float]:
    fdf, bits, segment, size, def_, mean_mm, max_mm = row
    if not all(type(v) is int and v >= 0 for v in (fdf, bits, segment, size)):
        raise ValueError(row)
    return fdf, bits, segment, size, float(def_), float(mean_mm), float(max_mm)


def _identity(evaluator: Evaluator) -> dict[str, Any]:
    motion, base = evaluator.original, evaluator.base
    digest = hashlib.sha256(np.ascontiguousarray(motion.X).tobytes())
    digest.update(json_text(skeleton_to_json(motion.skeleton)).encode())
    k = "inf" if math.isinf(base.k) else base.k
    reduction = None if evaluator.reduction == Reduction() else list(astuple(evaluator.reduction))
    about = {"motion": digest.hexdigest(), "encoder": str(base.encoder), "k": k, "rqt": base.rqt}
    return about | {_REDUCTION: reduction}
