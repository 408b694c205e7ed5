"""The project's own formats on one motion: version 1 with any of its encoders, and the compact profile."""

from __future__ import annotations

from dataclasses import replace

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.compact import payload as compact_payload
from qmd_studio.codecs.compact.decode import decode_payload as decode_compact
from qmd_studio.codecs.compact.encode import CompactEncoder
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.compact.target import meet_target
from qmd_studio.codecs.qmd import container, payload
from qmd_studio.codecs.qmd.decode import decode_payload
from qmd_studio.codecs.qmd.encode import encode_matrix
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.skeleton_block import pack_skeleton_block
from qmd_studio.codecs.qmd.units import codec_matrix
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.coding import Coding, last_that_holds
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.grid import wide_grid
from qmd_studio.tuning.memory import Memory
from qmd_studio.tuning.targets import Target, TargetKind, meet

_SLOW_SEGMENTS = (1, 2, 4)
"""Into how many segments an encoder is let cut a motion that is encoded whole for every setting."""

_COARSEST, _FINEST = 6.0, -22.0
"""Base-2 logarithms of the steps, in ASF units of effect, between which the compact profile is tried."""


class Version1:
    """Version 1 of the format: FDF, b and n_d are sought on the wide grid, no file larger than the raw motion.

    Where a motion is so short that every file is larger, files of any size are.
    """

    def __init__(self, encoder: Encoder, motion: Motion) -> None:
        self._motion, self._matrix = motion, codec_matrix(motion)
        self._evaluator = evaluator_for(motion, QmdSettings(encoder=encoder))
        self._memory = Memory(self._evaluator)
        grid = wide_grid(motion)
        if not self._evaluator.is_fast:
            grid = replace(grid, segments=_few_segments(motion))
        self._grid = grid if any(grid.columns(motion)) else grid.unbounded()

    def for_error(self, mean_mm: float) -> Coding:
        """Return the smallest file found with a mean joint error of at most `mean_mm`."""
        return self._found(Target(TargetKind.MEAN_MM, mean_mm))

    def for_size(self, n_bytes: int) -> Coding:
        """Return the least DEF found in a payload of `n_bytes`."""
        return self._found(Target(TargetKind.BYTES, n_bytes))

    def _found(self, target: Target) -> Coding:
        best = meet(self._evaluator, self._grid, target, memory=self._memory).best
        assert best is not None  # the grid holds a setting, and nobody cancels
        settings, motion, matrix = best.paper, self._motion, self._matrix

        def encode() -> bytes:
            return payload.pack(encode_matrix(matrix, motion.skeleton, settings).payload)

        def file(data: bytes) -> bytes:
            return container.build(data, pack_skeleton_block(motion), motion.fps, settings)

        rows = f"n_d {settings.segment}" if settings.segment else "one segment"
        words = f"FDF {settings.fdf}, b {settings.bits}, {rows}"
        return Coding(words, encode, lambda data: decode_payload(payload.unpack(memoryview(data))), file)


class Compact:
    """The compact profile in segments of `segment` frames (0: one); its knob is the fineness of all steps."""

    def __init__(self, segment: int, motion: Motion) -> None:
        self._motion = motion
        self._settings = CompactSettings(mean_error_mm=1.0, segment=segment).checked(motion.n_frames)

    def for_error(self, mean_mm: float) -> Coding:
        """Return the coarsest steps with a mean joint error of at most `mean_mm`."""
        outcome = meet_target(self._motion, replace(self._settings, mean_error_mm=mean_mm))
        return self._coding(outcome.fineness, outcome.block)

    def for_size(self, n_bytes: int) -> Coding:
        """Return the finest steps that fit into `n_bytes`."""
        encoder = CompactEncoder(self._motion, self._settings)

        def holds(power: float) -> bool:
            return len(compact_payload.pack(encoder.encode(2.0**power).payload)) <= n_bytes

        return self._coding(2.0 ** last_that_holds(holds, _COARSEST, _FINEST), encoder.block)

    def _coding(self, fineness: float, block: int) -> Coding:
        motion, settings = self._motion, replace(self._settings, block=block)

        def encode() -> bytes:
            return compact_payload.pack(CompactEncoder(motion, settings).encode(fineness).payload)

        def file(data: bytes) -> bytes:
            return container.build_compact(data, pack_skeleton_block(motion), motion.fps, settings.segment)

        segments = f"segments of {settings.segment}" if settings.segment else "one segment"
        return Coding(f"steps of {fineness:.3g} units, {segments}", encode, _decode_compact, file)


def _decode_compact(data: bytes) -> Float32Array:
    return decode_compact(compact_payload.unpack(memoryview(data)))


def _few_segments(motion: Motion) -> tuple[int, ...]:
    n_rows = motion.n_frames - 1
    return tuple(0 if parts == 1 else max(-(-n_rows // parts), 1) for parts in _SLOW_SEGMENTS)
