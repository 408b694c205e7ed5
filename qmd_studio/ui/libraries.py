"""The large libraries that threads beside the window bring in when they are first wanted."""

from __future__ import annotations

import threading

IMPORTING = threading.RLock()
"""Held by whatever thread beside the window imports something large: one at a time."""


def load_libraries() -> None:
    """Import what kernels are made of; at once where that has been done.

    Every thread calls this before it imports what stands on Numba and SciPy. Where several threads begin with that at
    once, one of them is now and then given a package that is half made, and a file fails to open.
    """
    with IMPORTING:
        import numba  # noqa: F401
        import scipy.fft
        import scipy.linalg  # noqa: F401
