"""`qmd body info`: what a body consists of."""

from __future__ import annotations

from argparse import Namespace

import numpy as np

from qmd_studio import registry
from qmd_studio.cli.load import open_body
from qmd_studio.cli.report import Report, Value
from qmd_studio.motion.hanim_names import level_of_articulation
from qmd_studio.storage import read_bytes


def run(arguments: Namespace) -> Report:
    """Describe the body in FILE. Raises `FormatError` where it holds none."""
    opened = open_body(arguments.file, metres_per_unit=arguments.metres_per_unit)
    body, skeleton = opened.body, opened.body.skeleton
    surface = body.surface
    joints, sites = len(skeleton.joints), len(skeleton.end_sites)
    segments = sum(1 for name in body.segments if name)
    influences = int((surface.weights > 0).sum(axis=1).max(initial=0))
    loa = level_of_articulation(joint.name for joint in skeleton.joints)
    height = float(np.ptp(surface.vertices[:, 1])) if len(surface.vertices) else 0.0
    kind = registry.recognise(read_bytes(arguments.file), opened.path)
    values: dict[str, Value] = {
        "format": kind.name,
        "name": body.name,
        "joints": joints,
        "segments": segments,
        "sites": sites,
        "vertices": len(surface.vertices),
        "triangles": len(surface.faces),
        "influences": influences,
        "displacers": len(body.displacers),
        "frames": opened.motion.n_frames if opened.motion else 0,
        "loa": loa,
        "height_m": height,
        "warnings": list(opened.warnings),
        "notes": list(opened.notes),
    }
    lines = [
        ("format", kind.title),
        ("body", f"{body.name}, {height:.2f} m tall"),
        ("joints", f"{joints}, level of articulation {loa}"),
        ("segments", f"{segments} named, {sites} sites"),
        ("surface", f"{len(surface.vertices):,} vertices, {len(surface.faces):,} triangles"),
        ("influences", f"at most {influences} joints a vertex"),
        ("displacers", str(len(body.displacers))),
    ]
    return Report(values, lines, opened.warnings, opened.notes)
