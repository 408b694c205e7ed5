"""`qmd info`: what a file holds."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from qmd_studio import registry, storage
from qmd_studio.cli.load import open_any
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.codecs.qmd import container
from qmd_studio.codecs.qmd.payload import unpack
from qmd_studio.formats.loaded import Loaded


def run(arguments: Namespace) -> Report:
    """Describe FILE. Raises `FormatError` where it is damaged: what is described could also be opened."""
    path = Path(arguments.file)
    loaded = open_any(arguments.file, skeleton=arguments.skeleton)
    data = storage.read_bytes(path)
    name, title = _format_of(data, path)
    values, lines = _about_motion(loaded)
    lines.insert(0, ("format", title))
    if name == "qmd":
        more_values, more_lines = _about_encoding(data)
        values |= more_values
        lines += more_lines
    return Report({"format": name, **values}, lines, loaded.warnings, loaded.notes)


def _about_motion(loaded: Loaded) -> tuple[dict[str, Value], list[tuple[str, str]]]:
    motion, skeleton = loaded.motion, loaded.skeleton
    frames = motion.n_frames if motion else 0
    fps = motion.fps if motion else None
    duration_s = motion.duration_s if motion else 0.0
    values: dict[str, Value] = {
        "frames": frames,
        "fps": fps,
        "dofs": skeleton.n_columns,
        "joints": len(skeleton.joints),
        "duration_s": duration_s,
    }
    timing = f"{frames:,} at {fps:g} fps, {duration_s:.2f} s" if fps else "none"
    lines = [
        ("frames", timing),
        ("joints", f"{len(skeleton.joints)}, with {skeleton.n_columns} degrees of freedom"),
    ]
    return values, lines


def _about_encoding(data: bytes) -> tuple[dict[str, Value], list[tuple[str, str]]]:
    parts = container.parse(data)
    segments = unpack(parts.payload).segments
    first = segments[0]
    values: dict[str, Value] = {
        "fdf": first.fdf,
        "bits": first.bits,
        "segment": parts.segment,
        "segments": len(segments),
        "encoder": parts.encoder,
        "payload_bytes": len(parts.payload),
        "bytes": len(data),
    }
    split = f"{len(segments)} segments of {parts.segment} rows" if len(segments) > 1 else "one segment"
    lines = [
        ("encoding", f"{parts.encoder} encoder, FDF {first.fdf}, {first.bits} bits, {split}"),
        ("payload", in_bytes(len(parts.payload))),
        ("file", in_bytes(len(data))),
    ]
    return values, lines


def _format_of(data: bytes, path: Path) -> tuple[str, str]:
    """Return name and title of the format that `registry.open_file` takes `data` for."""
    recognised = registry.recognise(data, path)
    return recognised.name, recognised.title
