"""How a long compact encoding is watched and stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

from qmd_studio.errors import CodecError


class EncodingCancelledError(CodecError):
    """The encoding was stopped by whoever asked for it."""


def stop_if(cancel: threading.Event | None) -> None:
    """Raise `EncodingCancelledError` where `cancel` is set."""
    if cancel is not None and cancel.is_set():
        raise EncodingCancelledError("the encoding was cancelled")


@dataclass(frozen=True, slots=True)
class Watch:
    """`cancel` stops an encoding within a block; `on_attempt(number, most)` hears of each finished attempt."""

    cancel: threading.Event | None = None
    on_attempt: Callable[[int, int], None] | None = None

    def tell(self, number: int, most: int) -> None:
        """Report attempt `number` of at most `most`."""
        if self.on_attempt is not None:
            self.on_attempt(number, most)


UNWATCHED = Watch()
