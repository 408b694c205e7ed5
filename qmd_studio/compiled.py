"""Compiling kernels: what numba makes is kept on disk where that can be, and made anew in each run where it cannot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator that compiles a kernel at its first call, without the interpreter's lock.

    `options` are numba's. The machine code goes beside the module or into the user's cache folder. Where neither can be
    written, as in a read-only installation without a home, each run compiles for itself: slower, and no error. Shared
    temporary folders are not used, for what stands in a cache is loaded and run.
    """

    def decorate(kernel: Callable[..., Any]) -> Any:
        try:
            return njit(cache=True, nogil=True, **options)(kernel)
        except RuntimeError:  # numba has found no folder to keep it in
            return njit(nogil=True, **options)(kernel)

    return decorate
