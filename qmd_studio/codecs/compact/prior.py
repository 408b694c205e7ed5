"""What a decoder expects of integers before it has seen any: a table made from motions that it is not measured on.

`tests/benchmarks/make_compact_prior.py` makes it; resources/help/qmd-compact.md prints it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from qmd_studio.assets import resource
from qmd_studio.codecs.compact import PRIOR_SHAPE


@cache
def prior() -> NDArray[np.uint8]:
    """Return the table (classes, contexts, buckets): the chance of "larger than this bucket" in 256ths, 1 to 255."""
    text = resource("tables", "compact_prior.txt").read_text(encoding="ascii")
    rows = [bytes.fromhex(line) for line in text.splitlines() if line and not line.startswith("#")]
    table = np.frombuffer(b"".join(rows), dtype=np.uint8).reshape(PRIOR_SHAPE)
    table.flags.writeable = False
    return table
