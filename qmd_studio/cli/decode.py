"""`qmd decode`: a QMD file back as a motion that other programs read."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from qmd_studio import storage
from qmd_studio.cli.report import Report
from qmd_studio.cli.save import save_motion
from qmd_studio.codecs.qmd.decode import decode
from qmd_studio.errors import FormatError


def run(arguments: Namespace) -> Report:
    """Write the motion of IN.qmd as OUT. Raises `FormatError` where IN is no sound QMD file or OUT cannot hold it."""
    data = storage.read_bytes(arguments.input)
    try:
        motion = decode(data)
    except FormatError as error:
        raise error.located(arguments.input) from None
    return save_motion(Path(arguments.output), motion)
