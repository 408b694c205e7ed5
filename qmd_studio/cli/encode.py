"""`qmd encode`: a motion as QMD, with the error that the file's reader will see."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from qmd_studio import storage
from qmd_studio.cli.encode_compact import run as run_compact
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_motion
from qmd_studio.cli.measure import error_lines
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import QmdStudioError
from qmd_studio.tuning.reduced_session import ReducedSession
from qmd_studio.tuning.reduction import Reduction

_ERROR_KEYS = ("def", "mean_mm", "p99_mm", "max_mm", "worst_joint", "worst_frame")


def run(arguments: Namespace) -> Report:
    """Encode IN into OUT.qmd and report size and error of those very bytes. Raises `FormatError`, `CodecError`."""
    if Path(arguments.output).suffix.lower() != ".qmd":
        raise UsageError("encode writes QMD only", wanted="a name that ends in .qmd", got=arguments.output)
    reduction = _reduction(arguments)
    if arguments.profile == "compact":
        return run_compact(arguments)
    if arguments.mean_error_mm is not None:
        raise UsageError("only the compact profile is made for a mean error", wanted="--profile compact")
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    original = opened.motion.X.shape
    try:
        session = ReducedSession(opened.motion, reduction)
        frames, dofs = session.reduced.X.shape
        settings = _settings(arguments, dofs)
        outcome = session.evaluate(settings)
    except QmdStudioError as error:
        raise error.located(arguments.input) from None
    storage.write_atomic(arguments.output, outcome.data)
    values = {
        "bytes": outcome.file_bytes,
        "payload_bytes": outcome.size.bytes,
        "frames": frames,
        "dofs": dofs,
        **(found := _found(outcome.data)),
        **{key: value for key, value in outcome.error.as_json().items() if key in _ERROR_KEYS},
        "seconds": round(outcome.seconds, 6),
    }
    raw_bytes = original[0] * original[1] * 4
    lines = [
        ("written", arguments.output),
        *([("found", _in_words(found))] if settings.encoder is Encoder.BOUNDED else []),
        ("motion", f"{original[0]:,} frames × {original[1]} degrees of freedom"),
        *(
            [("kept", f"{frames:,} frames × {dofs}, at {session.reduced.fps:g} fps")]
            if original != (frames, dofs)
            else []
        ),
        ("payload", f"{in_bytes(outcome.size.bytes)}, {outcome.size.bytes / raw_bytes:.1%} of the raw numbers"),
        ("file", in_bytes(outcome.file_bytes)),
        *error_lines(outcome.error),
        ("took", f"{outcome.seconds:.2f} s"),
    ]
    return Report(values, lines, opened.warnings, opened.notes)


def _found(data: bytes) -> dict[str, Value]:
    """Return what the file was made with; the bounded encoder chooses that by itself."""
    facts = describe(data)
    return {key: facts[key] for key in ("encoder", "fdf", "bits", "segments")}


def _in_words(found: dict[str, Value]) -> str:
    segments = "one segment" if found["segments"] == 1 else f"{found['segments']} segments"
    return f"FDF {found['fdf']}, {found['bits']} bits, {segments}"


def _reduction(arguments: Namespace) -> Reduction:
    reduction = Reduction(arguments.every, arguments.max_level, arguments.max_loa)
    if reduction != Reduction() and (arguments.encoder == "bounded" or arguments.profile == "compact"):
        raise UsageError(
            "a file made for an error keeps all frames and columns",
            wanted="--every, --max-level and --max-loa without --encoder bounded and --profile compact",
        )
    return reduction


def _settings(arguments: Namespace, n_columns: int) -> QmdSettings:
    """Return the settings asked for; the default FDF, unlike a wish, gives way where there are fewer columns.

    Raises `UsageError` for a bound without the bounded encoder, or the encoder without its bound.
    """
    encoder, bound_mm = Encoder(arguments.encoder), arguments.max_error_mm
    if (encoder is Encoder.BOUNDED) != (bound_mm is not None):
        raise UsageError("the bounded encoder and its bound go together", wanted="--encoder bounded --max-error-mm E")
    settings = QmdSettings(
        bits=arguments.bits,
        segment=arguments.segment,
        encoder=encoder,
        k=arguments.k,
        rqt=arguments.rqt,
        buckets=Buckets(arguments.buckets),
        max_error_mm=bound_mm or QmdSettings().max_error_mm,
    )
    return settings.fitted(n_columns) if arguments.fdf is None else replace(settings, fdf=arguments.fdf)
