"""Codecs side by side on one motion, at equal error and at equal size; every figure is that of decoding the very bytes.

The payload is all that is sent but skeleton and rate, the complete file what can be played alone. Where a contender has
no container of its own, QMD's header and skeleton block are counted for it, since it would need as much.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import motion_matrix
from qmd_studio.errors import CodecError
from qmd_studio.motion.metrics import MotionError, measure
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.budget import budget_of_file
from qmd_studio.tuning.contenders import CONTENDERS, Contender, Entrant

MEAN_ERROR_MM = 0.5
"""The error that codecs are compared at unless another is asked for."""

_SLACK = 1.001
"""Searches measure in float32, the table in float64: a thousandth more than was asked for still counts as met."""

_ENCODINGS, _DECODINGS = 3, 7
"""How often each is timed; the least counts."""

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One contender at one question.

    Times are microseconds a frame; `instructions` are the C decoder's for a frame, None where no model tells. Encoding
    is timed once its setting has been found: the search for it is not part of it. `met` tells whether the error or the
    size that was asked for is kept; otherwise this is what came nearest. `data` is the payload, `file` the complete
    file where the contender has one of its own.
    """

    name: str
    is_qmd: bool
    setting: str
    met: bool
    data: bytes
    file: bytes | None
    file_bytes: int
    n_frames: int
    seconds: float
    error: MotionError
    encode_us: float
    decode_us: float
    instructions: float | None

    @property
    def bytes_per_frame(self) -> float:
        """The payload's bytes a frame."""
        return len(self.data) / self.n_frames

    @property
    def kbps(self) -> float:
        """The payload's 1000 bits a second."""
        return 8 * len(self.data) / self.seconds / 1000

    def as_json(self) -> dict[str, float | int | str | bool | None]:
        """Return the figures under the names that the command line prints."""
        return {
            "name": self.name,
            "setting": self.setting,
            "met": self.met,
            "payload_bytes": len(self.data),
            "file_bytes": self.file_bytes,
            "bytes_per_frame": self.bytes_per_frame,
            "kbps": self.kbps,
            **self.error.as_json(),
            "encode_us": self.encode_us,
            "decode_us": self.decode_us,
            "instructions": self.instructions,
        }


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """The rows at a mean error of `mean_error_mm` and those at a payload of `n_bytes`, and why others are absent."""

    mean_error_mm: float
    n_bytes: int
    at_error: tuple[Row, ...]
    at_size: tuple[Row, ...]
    absent: tuple[str, ...]


def usual_bytes(motion: Motion) -> int:
    """Return the payload's bytes at the usual setting of version 1: FDF 6, b 8, one segment."""
    settings = QmdSettings().fitted(motion.skeleton.n_columns)
    return payload_size(motion.n_frames - 1, motion.skeleton.n_columns, settings.fdf, settings.bits).bytes


def compare(
    motion: Motion,
    *,
    mean_error_mm: float = MEAN_ERROR_MM,
    n_bytes: int | None = None,
    contenders: Sequence[Contender] = CONTENDERS,
    on_progress: Callable[[int, int, str], None] | None = None,
) -> Comparison:
    """Let each of `contenders` encode `motion` for `mean_error_mm`, then for a payload of `n_bytes` (`usual_bytes`).

    `on_progress` is told how many of how many contenders are done, and who is next. Raises `CodecError` for a motion
    that has nothing to measure at; who cannot encode it otherwise is absent from the table, with the reason.
    """
    if not motion.skeleton.points or not motion.skeleton.n_columns:
        raise CodecError("there is nothing to compare", wanted="a motion with columns and joints to measure at")
    n_bytes = n_bytes or usual_bytes(motion)
    at_error: list[Row] = []
    at_size: list[Row] = []
    absent = []
    for number, contender in enumerate(contenders):
        if on_progress:
            on_progress(number, len(contenders), contender.name)
        if lacks := contender.lacks():
            absent.append(lacks)
            continue
        try:
            entrant = contender.enter(motion)
        except CodecError as problem:
            absent.append(f"{contender.name}: {problem}")
            continue
        for rows, at, bound in ((at_error, "error", mean_error_mm), (at_size, "size", n_bytes)):
            try:
                rows.append(_row(motion, contender, entrant, at, bound))
            except CodecError as problem:
                absent.append(f"{contender.name}, at equal {at}: {problem}")
    if not at_error and not at_size:
        raise CodecError("no codec can hold this motion", got="; ".join(absent))
    return Comparison(mean_error_mm, n_bytes, tuple(at_error), tuple(at_size), tuple(absent))


def _row(motion: Motion, contender: Contender, entrant: Entrant, at: str, bound: float) -> Row:
    coding = entrant.for_error(bound) if at == "error" else entrant.for_size(int(bound))
    data, encode_s = _timed(coding.encode, _ENCODINGS)
    matrix, decode_s = _timed(lambda: coding.decode(data), _DECODINGS)
    error = measure(motion, motion.with_values(motion_matrix(matrix, motion.skeleton)))
    file = coding.file(data) if coding.file else None
    return Row(
        name=contender.name,
        is_qmd=contender.is_qmd,
        setting=coding.setting,
        met=error.mean_mm <= bound * _SLACK if at == "error" else len(data) <= bound,
        data=data,
        file=file,
        file_bytes=len(file) if file else container.HEADER.size + len(data) + len(pack_skeleton_block(motion)),
        n_frames=motion.n_frames,
        seconds=motion.duration_s,
        error=error,
        encode_us=1e6 * encode_s / motion.n_frames,
        decode_us=1e6 * decode_s / motion.n_frames,
        instructions=budget_of_file(file).instructions_per_frame if file else None,
    )


def _timed(do: Callable[[], Result], times: int) -> tuple[Result, float]:
    """Return what `do` makes, and the least seconds that it takes once it has run: others on the machine only add."""
    made, took = do(), []
    for _ in range(times):
        started = time.perf_counter()
        made = do()
        took.append(time.perf_counter() - started)
    return made, min(took)
