"""`qmd encode --profile compact`: a motion as small as an error allows."""

from __future__ import annotations

import time
from argparse import Namespace

from qmd_studio import storage
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_motion
from qmd_studio.cli.measure import error_lines
from qmd_studio.cli.report import Report, in_bytes
from qmd_studio.codecs.compact.file import encode
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.motion.metrics import measure

_MEAN_ERROR_MM = 0.5


def run(arguments: Namespace) -> Report:
    """Encode IN into OUT.qmd and report size and error of those very bytes. Raises `FormatError`, `CodecError`."""
    if arguments.fdf is not None or arguments.encoder != "closed":
        raise UsageError("the compact profile has neither exact columns nor encoders", wanted="no --fdf, no --encoder")
    if arguments.mean_error_mm is not None and arguments.max_error_mm is not None:
        raise UsageError("a compact file has one target", wanted="--mean-error-mm or --max-error-mm")
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    frames, dofs = opened.motion.X.shape
    started = time.perf_counter()
    try:
        outcome = encode(opened.motion, _settings(arguments))
    except QmdStudioError as problem:
        raise problem.located(arguments.input) from None
    seconds = time.perf_counter() - started
    storage.write_atomic(arguments.output, outcome.data)
    error = measure(opened.motion, outcome.decoded)
    values = {
        "profile": "compact",
        "bytes": len(outcome.data),
        "payload_bytes": outcome.payload_bytes,
        "frames": frames,
        "dofs": dofs,
        **error.as_json(),
        "seconds": round(seconds, 6),
    }
    a_frame = outcome.payload_bytes / frames
    lines = [
        ("written", arguments.output),
        ("motion", f"{frames:,} frames × {dofs} degrees of freedom"),
        ("payload", f"{in_bytes(outcome.payload_bytes)}, {a_frame:.1f} bytes a frame, {a_frame / dofs / 4:.1%} of raw"),
        ("file", in_bytes(len(outcome.data))),
        *error_lines(error),
        ("took", f"{seconds:.2f} s"),
    ]
    return Report(values, lines, opened.warnings, opened.notes)


def _settings(arguments: Namespace) -> CompactSettings:
    mean = arguments.mean_error_mm
    if mean is None and arguments.max_error_mm is None:
        mean = _MEAN_ERROR_MM
    return CompactSettings(mean_error_mm=mean, max_error_mm=arguments.max_error_mm, segment=arguments.segment)
