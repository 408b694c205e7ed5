"""What playing a file costs on a device: memory, and instructions of the C decoder as callgrind counts them.

The decoder's work is linear in what `decoder_work` counts in a file; the coefficients are measured by
tests/benchmarks/decoder_instructions.py and shipped as resources/tables/decoder_cost.csv. Counted are instructions of a
64-bit x86 processor without its vector units; a device's table row says what one of them takes there, in cycles.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from qmd_studio.assets import resource
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import n_segments
from qmd_studio.errors import CodecError
from qmd_studio.tuning.decoder_work import DecoderWork, Part, paper_work, work_of_file

_FLOAT_BYTES = 4


@dataclass(frozen=True, slots=True)
class Device:
    """A kind of machine that plays. Cycles are estimates; the table's page says from what.

    `ram_bytes` is all its memory. `reads_in_place` tells that a file can stay in flash while it is played.
    `cycles_per_instruction` is for one instruction as counted here; `cycles_per_addition` come on top of it for each
    float addition where there is no unit for them.
    """

    name: str
    title: str
    megahertz: float
    ram_bytes: int
    reads_in_place: bool
    cycles_per_instruction: float
    cycles_per_addition: float


@dataclass(frozen=True, slots=True)
class Budget:
    """What one file costs a player.

    Memory: `state_bytes` the decoder, `pose_bytes` the pose, `work_bytes` what the compact profile decodes into,
    `file_bytes` the file, in which `table_bytes` are the largest segment's table, read where it lies. Work:
    instructions and float additions a frame, the mean over the clip, and once to open and check the file.
    """

    file_bytes: int
    table_bytes: int
    pose_bytes: int
    state_bytes: int
    work_bytes: int
    instructions_per_frame: float
    additions_per_frame: float
    instructions_to_open: float

    @property
    def ram_bytes(self) -> int:
        """The memory of a player that loads the file: decoder, pose, work and file, a table being part of it."""
        return self.least_ram_bytes + self.file_bytes

    @property
    def least_ram_bytes(self) -> int:
        """The memory of a player that reads the file where it lies in flash: decoder, pose and work."""
        return self.state_bytes + self.pose_bytes + self.work_bytes

    def ram_on(self, device: Device) -> int:
        """Return the bytes of memory that playing takes on `device`."""
        return self.least_ram_bytes if device.reads_in_place else self.ram_bytes

    def load_on(self, device: Device, fps: float) -> float:
        """Return the share (1 = all) of `device`'s processor that playing at `fps` frames a second takes."""
        cycles = self.instructions_per_frame * device.cycles_per_instruction
        cycles += self.additions_per_frame * device.cycles_per_addition
        return cycles * fps / (device.megahertz * 1e6)


def budget_of_file(data: bytes) -> Budget:
    """Return what a QMD file of either version costs; raises `FormatError` for a damaged one."""
    return _budget(work_of_file(data), len(data))


def budget_of_settings(settings: QmdSettings, n_rows: int, n_columns: int, *, file_bytes: int) -> Budget:
    """Return what the file of version 1 would cost that `settings` make of `n_rows` differences of `n_columns`.

    `settings` are checked for that motion; `file_bytes` is the size of the whole file, known by formula.
    """
    length = settings.segment or max(n_rows, 1)
    rows = [min(length, n_rows - length * k) for k in range(n_segments(n_rows, settings.segment))]
    return _budget(paper_work([Part(n, settings.fdf, settings.bits) for n in rows], n_columns, file_bytes), file_bytes)


@lru_cache(maxsize=1)
def devices() -> Mapping[str, Device]:
    """Return the device profiles that ship, by name."""
    return {row["name"]: _device(row) for row in _rows("devices.csv")}


def device(name: str) -> Device:
    """Return the profile called `name`; raises `CodecError` with the names that exist."""
    known = devices()
    if name not in known:
        raise CodecError("no such device profile", wanted=", ".join(known), got=name)
    return known[name]


@lru_cache(maxsize=1)
def decoder_costs() -> Mapping[str, float]:
    """Return the coefficients of the model: instructions by what is counted, and the bytes of a decoder."""
    return {row["what"]: float(row["instructions"]) for row in _rows("decoder_cost.csv")}


def _budget(work: DecoderWork, file_bytes: int) -> Budget:
    costs = decoder_costs()
    return Budget(
        file_bytes=file_bytes,
        table_bytes=work.table_bytes,
        pose_bytes=_FLOAT_BYTES * work.n_columns,
        state_bytes=int(costs["state_bytes"]),
        work_bytes=work.work_bytes,
        instructions_per_frame=sum(costs[what] * amount for what, amount in work.playing.items()) / work.n_frames,
        additions_per_frame=work.additions / work.n_frames,
        instructions_to_open=sum(costs[what] * amount for what, amount in work.opening.items()),
    )


def _rows(table: str) -> Iterator[dict[str, str]]:
    with resource("tables", table).open(encoding="utf-8", newline="") as stream:
        yield from csv.DictReader(stream)


def _device(row: Mapping[str, str]) -> Device:
    return Device(
        name=row["name"],
        title=row["title"],
        megahertz=float(row["megahertz"]),
        ram_bytes=int(row["ram_kib"]) * 1024,
        reads_in_place=row["reads_in_place"] == "yes",
        cycles_per_instruction=float(row["cycles_per_instruction"]),
        cycles_per_addition=float(row["cycles_per_addition"]),
    )
