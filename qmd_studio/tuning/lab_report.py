"""What one side of the codec lab came to: its bytes, how far it is from all of the original, what playing it costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from qmd_studio.motion.metrics import MotionError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.budget import Budget
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.size_figures import SizeFigures


@dataclass(frozen=True, slots=True)
class Found:
    """What the bounded encoder chose: FDF and b of the first segment, and how many segments."""

    fdf: int
    bits: int
    n_segments: int


@dataclass(frozen=True, eq=False)
class LabReport:
    """The outcome of one setting: `size`, and `error` against every frame of the original.

    `fps` is the rate of the file, `found` what an encoder chose by itself. `draft` as in `EncodeReport`. `data`,
    `decoded`, `played` and `budget` are made when first asked for, from the very indices that were measured, on any
    thread.
    """

    settings: EncodeSettings
    size: SizeFigures
    error: MotionError
    fps: float
    seconds: float
    draft: bool
    found: Found | None
    _assemble: Callable[[], bytes]
    _decode: Callable[[], Motion]
    _play: Callable[[Motion], Motion]
    _reckon: Callable[[], Budget]

    @property
    def file_bytes(self) -> int:
        """The bytes of the whole file."""
        return self.size.file_bytes

    @cached_property
    def data(self) -> bytes:
        """The whole file: what Export writes, and what the error was measured on."""
        return self._assemble()

    @cached_property
    def decoded(self) -> Motion:
        """The motion that every reader gets from `data`."""
        return self._decode()

    @cached_property
    def played(self) -> Motion:
        """What a player shows, with the frames and columns of the original."""
        return self._play(self.decoded)

    @cached_property
    def budget(self) -> Budget:
        """What playing the file takes."""
        return self._reckon()
