"""Which encoders the searches know by heart."""

from __future__ import annotations

from qmd_studio.codecs.qmd.settings import Encoder

PLAIN_CLOSED = Encoder.PLAIN
"""The closed loop that takes the nearest level, column by column."""

FAST_ENCODERS = (Encoder.PAPER, PLAIN_CLOSED)
"""Those with kernels of their own in `encode_kernels`; any other is encoded whole for every setting."""
