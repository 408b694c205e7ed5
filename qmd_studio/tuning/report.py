"""What one encoding of the open motion came to: its bytes and how far it is from the original."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.codecs.qmd.size import SizeBreakdown
from qmd_studio.motion.metrics import MotionError
from qmd_studio.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class EncodeReport:
    """The outcome of one setting: `size` of the payload, `file_bytes` with all around it, `error`, `seconds` it took.

    `draft` says whether the indices were chosen in haste: such a report is to be looked at, not exported.

    `data` and `decoded` are made when first asked for, from the very indices and poses that were measured: a slider
    that is dragged needs neither. They are kept then, and may be asked for on any thread.
    """

    settings: QmdSettings
    size: SizeBreakdown
    file_bytes: int
    error: MotionError
    seconds: float
    draft: bool
    _assemble: Callable[[], bytes]
    _decode: Callable[[], Motion]

    @cached_property
    def data(self) -> bytes:
        """The whole file: what Export writes, and what the error was measured on."""
        return self._assemble()

    @cached_property
    def decoded(self) -> Motion:
        """The motion that every reader gets from `data`."""
        return self._decode()
