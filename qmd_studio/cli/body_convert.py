"""`qmd body convert`: a body and its motion in another format."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from qmd_studio import registry, storage
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import OpenedBody, open_body
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.formats.gzip_bytes import packed
from qmd_studio.formats.hanim_write import figure_bytes
from qmd_studio.formats.scene_graph import Encoding

_SCENES = {"x3d": Encoding.XML, "x3dv": Encoding.CLASSIC, "wrl": Encoding.VRML97}


def run(arguments: Namespace) -> Report:
    """Write the body of IN as OUT. Raises `FormatError` where IN holds none or OUT's format holds none."""
    path = Path(arguments.output)
    opened = open_body(arguments.input, metres_per_unit=arguments.metres_per_unit)
    target = registry.format_for(path)
    if arguments.motion == "interpolators":
        data = _with_interpolators(opened, path)
    else:
        motion = opened.motion if arguments.motion == "frames" else None
        data = registry.encode_figure(path.suffix, opened.body, motion)
    storage.write_atomic(path, data)
    body = opened.body
    lines = [
        ("written", str(path)),
        ("body", f"{len(body.skeleton.joints)} joints, {len(body.surface.vertices):,} vertices"),
        ("file", in_bytes(len(data))),
    ]
    joints = len(body.skeleton.joints)
    values: dict[str, Value] = {"file": str(path), "format": target.name, "joints": joints, "bytes": len(data)}
    return Report(values, lines, opened.warnings, opened.notes)


def _with_interpolators(opened: OpenedBody, path: Path) -> bytes:
    target = registry.format_for(path)
    if target.name not in _SCENES:
        raise UsageError(
            "only scenes have interpolators", wanted="a name that ends in .x3d, .x3dv or .wrl", got=path.suffix
        )
    data = figure_bytes(opened.body, opened.motion, _SCENES[target.name], interpolators=True)
    return packed(data) if path.suffix.lower() in target.packed else data
