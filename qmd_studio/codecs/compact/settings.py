"""What the compact encoder may be told: how far off it may be, and how the motion is cut."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from qmd_studio.codecs.compact.layout import MAX_BLOCK
from qmd_studio.errors import CodecError

_MAX_U32 = 2**32 - 1


@dataclass(frozen=True, slots=True)
class CompactSettings:
    """The settings of one encoding; exactly one of the two errors is the target.

    `mean_error_mm` is what the mean distance of all measured points over all frames may come to, `max_error_mm` what
    no point may exceed in any frame; both in millimetres. `segment` is the frames of a segment, each of which decodes
    alone (0: one for all); `block` about how many lie from key pose to key pose, 1 to 60 (None: what makes
    the file smallest).
    """

    mean_error_mm: float | None = None
    max_error_mm: float | None = None
    segment: int = 0
    block: int | None = None

    def checked(self, n_frames: int) -> CompactSettings:
        """Return these settings for a motion of `n_frames`; a segment that holds them all becomes 0.

        Raises `CodecError` for anything out of range, for two targets and for none.
        """
        targets = [target for target in (self.mean_error_mm, self.max_error_mm) if target is not None]
        if len(targets) != 1:
            raise CodecError("a compact file has one target", wanted="a mean error or a largest one")
        if not 0 < targets[0] < math.inf:
            raise CodecError("the error asked for is not a positive number", wanted="millimetres", got=str(targets[0]))
        if not 0 <= self.segment <= _MAX_U32:
            raise CodecError("the segment is out of range", wanted=f"0 to {_MAX_U32}", got=str(self.segment))
        if self.block is not None and not 1 <= self.block <= MAX_BLOCK:
            raise CodecError("the block is out of range", wanted=f"1 to {MAX_BLOCK}", got=str(self.block))
        return replace(self, segment=0) if self.segment >= n_frames else self
