"""`qmd size`: the closed formula of the paper's section 4, without any motion."""

from __future__ import annotations

from argparse import Namespace

from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.report import Report, in_bytes
from qmd_studio.codecs.qmd.size import payload_size


def run(arguments: Namespace) -> Report:
    """Return the size of a payload and of its parts. Raises `UsageError` where FDF exceeds the columns."""
    if arguments.fdf > arguments.dofs:
        raise UsageError(
            "more columns are kept exact than there are", wanted=f"--fdf 0 to {arguments.dofs}", got=str(arguments.fdf)
        )
    size = payload_size(arguments.frames, arguments.dofs, arguments.fdf, arguments.bits, arguments.segment)
    parts = {
        "bytes": size.bytes,
        "header_bytes": size.header_bytes,
        "table_bytes": size.table_bytes,
        "exact_bytes": size.exact_bytes,
        "index_bytes": size.index_bytes,
        "pose_bytes": size.pose_bytes,
    }
    lines = [("payload", in_bytes(size.bytes))]
    lines += [(key.removesuffix("_bytes"), f"{count:,} bytes") for key, count in parts.items() if key != "bytes"]
    return Report(parts, lines)
