"""`qmd info`: what a file holds."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

from qmd_studio import registry, storage
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_any
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.codecs.qmd.file import describe
from qmd_studio.codecs.qmd.settings import Encoder
from qmd_studio.formats.loaded import Loaded
from qmd_studio.tuning.budget import Device, budget_of_file, devices


def run(arguments: Namespace) -> Report:
    """Describe FILE. Raises `FormatError` where it is damaged: what is described could also be opened."""
    path = Path(arguments.file)
    device = _device(arguments.device)
    loaded = open_any(arguments.file, skeleton=arguments.skeleton)
    data = storage.read_bytes(path)
    recognised = registry.recognise(data, path)
    values, lines = _about_motion(loaded)
    lines.insert(0, ("format", recognised.title))
    if recognised.name == "qmd":
        more_values, more_lines = _about_encoding(data)
        values |= more_values
        lines += more_lines
        more_values, more_lines = _about_playing(data, loaded.motion.fps if loaded.motion else 0.0, device)
        values |= more_values
        lines += more_lines
    elif device:
        raise UsageError(
            "what playing costs is known of QMD files only", wanted="a .qmd with --device", got=arguments.file
        )
    return Report({"format": recognised.name, **values}, lines, loaded.warnings, loaded.notes)


def _device(name: str | None) -> Device | None:
    if name is None:
        return None
    if name not in devices():
        raise UsageError("no such device", wanted=f"--device {' or '.join(devices())}", got=name)
    return devices()[name]


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
    facts = describe(data)
    values, encoding = _about_compact(facts) if facts["profile"] == "compact" else _about_paper(facts)
    values |= {
        "profile": facts["profile"],
        "segments": facts["segments"],
        "encoder": facts["encoder"],
        "payload_bytes": facts["payload_bytes"],
        "bytes": facts["bytes"],
    }
    lines = [
        ("encoding", encoding),
        ("payload", in_bytes(facts["payload_bytes"])),
        ("file", in_bytes(facts["bytes"])),
    ]
    return values, lines


def _about_paper(facts: dict[str, Any]) -> tuple[dict[str, Value], str]:
    segments = facts["segments"]
    values: dict[str, Value] = {
        "fdf": facts["fdf"],
        "bits": facts["bits"],
        "segment": facts["segment"] if segments > 1 else 0,  # as `--segment` takes it: 0 is one for all
    }
    split = f"{segments} segments of {facts['segment']} rows" if segments > 1 else "one segment"
    bound = f" within {facts['max_error_mm']:g} mm" if facts["encoder"] == Encoder.BOUNDED else ""
    return values, f"{facts['encoder']} encoder{bound}, FDF {facts['fdf']}, {facts['bits']} bits, {split}"


def _about_compact(facts: dict[str, Any]) -> tuple[dict[str, Value], str]:
    split = f"{facts['segments']} segments of {facts['segment']} frames" if facts["segments"] > 1 else "one segment"
    bits = 8 * facts["payload_bytes"] / facts["frames"]
    told = f"compact profile, a key pose every {facts['block']} frames, {split}, {bits:.0f} bits a frame"
    return {"segment": facts["segment"], "block": facts["block"]}, told


def _about_playing(data: bytes, fps: float, device: Device | None) -> tuple[dict[str, Value], list[tuple[str, str]]]:
    """Return what playing takes: on `device`, or without one on any that loads the file into its memory."""
    cost = budget_of_file(data)
    per_frame = round(cost.instructions_per_frame)
    ram_bytes = cost.ram_on(device) if device else cost.ram_bytes
    values: dict[str, Value] = {"ram_bytes": ram_bytes, "instructions_per_frame": per_frame}
    lines = [("playing", f"{in_bytes(ram_bytes)} of memory, {per_frame:,} instructions a frame")]
    if device:
        cpu, ram = 100 * cost.load_on(device, fps), 100 * ram_bytes / device.ram_bytes
        values |= {"device": device.name, "cpu_percent": cpu, "ram_percent": ram}
        where = ", the file read where it lies" if device.reads_in_place else ""
        lines += [
            ("device", device.title),
            ("processor", f"{cpu:.2g} % at {fps:g} fps (estimated)"),
            ("memory", f"{ram:.2g} %{where}"),
        ]
    return values, lines
