"""Acclaim motions: an AMC on the skeleton of the ASF that belongs to it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from qmd_studio.errors import FormatError
from qmd_studio.formats.amc import AMC_FPS, Amc, parse_amc, write_amc
from qmd_studio.formats.asf import skeleton_of
from qmd_studio.formats.asf_parse import Asf, parse_asf
from qmd_studio.formats.asf_write import write_asf
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import ColumnKind
from qmd_studio.storage import read_bytes

_HEAD = re.compile(rb"\s*(:fully-specified|:degrees|:radians|:samples-per-second|\d+\s*[\r\n]\s*root\s)", re.IGNORECASE)


def read_amc(data: bytes, options: ReadOptions) -> Loaded:
    """Read an AMC on the skeleton found for it; raises `FormatError` where there is none or it does not fit."""
    amc = parse_amc(data)
    asf_path = find_skeleton(options)
    try:
        asf = parse_asf(read_bytes(asf_path))
    except FormatError as problem:
        problem.located(asf_path)
        raise
    _check_fit(amc, asf, asf_path)
    bones = [name for name, _, _ in amc.bones]
    skeleton, notes = skeleton_of(asf, bones, metres_per_unit=options.metres_per_unit)
    turns = np.array([column.kind is ColumnKind.ROTATION for column in skeleton.columns])
    degrees = asf.degrees if amc.degrees is None else amc.degrees
    X = amc.values * np.where(turns, np.pi / 180 if degrees else 1.0, skeleton.metres_per_unit)
    fps = next((rate for rate in (options.fps, amc.fps) if rate is not None), AMC_FPS)
    motion = Motion(skeleton, X, fps, name=options.path.stem if options.path else "")
    notes += (f"Skeleton from {asf_path.name}",)
    if options.fps is None and amc.fps is None:
        notes += (f"An AMC does not say its frame rate; taken as {AMC_FPS:g} fps",)
    return Loaded(skeleton, motion, warnings=amc.warnings, notes=notes)


def find_skeleton(options: ReadOptions) -> Path:
    """Return the ASF for the AMC at `options.path`: the one given, or of its name, or its subject's, or the only one.

    Raises `FormatError` where none is found.
    """
    if options.skeleton is not None:
        return options.skeleton
    if options.path is None:
        raise FormatError("an AMC needs a skeleton", hint="Give the .asf file that belongs to it")
    folder = options.path.parent
    beside = {path.stem.lower(): path for path in sorted(folder.glob("*.[aA][sS][fF]"))}
    stem = options.path.stem.lower()
    names = tuple(dict.fromkeys((stem, stem.split("_")[0])))
    for name in names:
        if name in beside:
            return beside[name]
    if len(beside) == 1:
        return next(iter(beside.values()))
    raise FormatError(
        "no skeleton was found for this motion",
        wanted=f"{' or '.join(f'{name}.asf' for name in names)} beside it",
        got=f"{len(beside)} .asf files of other names" if beside else "no .asf file there",
        hint="Put the .asf file beside the motion under the same name, or give it with --skeleton",
    )


def companion(path: Path, motion: Motion) -> tuple[Path, bytes] | None:
    """Return the ASF to write beside an AMC at `path`, as its path and bytes; None where the name is taken."""
    beside = path.with_suffix(".asf")
    return None if beside.exists() else (beside, write_asf(motion.skeleton))


def _check_fit(amc: Amc, asf: Asf, asf_path: Path) -> None:
    hint = f"{asf_path.name} is the skeleton of another motion; put the right one there, or give it with --skeleton"
    for name, count, line in amc.bones:
        if name not in asf.bones:
            got = f"no such bone in {asf_path.name}"
            raise FormatError("the skeleton does not fit", at=f"line {line}", wanted=f"bone {name}", got=got, hint=hint)
        dofs = asf.bones[name].dofs
        if len(dofs) != count:
            raise FormatError(
                f"the skeleton does not fit: bone {name}",
                at=f"line {line}",
                wanted=f"{len(dofs)} values ({' '.join(dofs) or 'it does not move'})",
                got=str(count),
                hint=hint,
            )
    present = {name for name, _, _ in amc.bones}
    missing = [name for name, bone in asf.bones.items() if bone.dofs and name not in present]
    if missing:
        wanted = sum(len(bone.dofs) for bone in asf.bones.values())
        raise FormatError(
            f"the skeleton does not fit: the frames have no line for {', '.join(missing[:5])}",
            at=f"line {amc.bones[-1][2]}",
            wanted=f"{wanted} values a frame",
            got=str(sum(count for _, count, _ in amc.bones)),
            hint=hint,
        )


def _sniff(head: bytes) -> bool:
    return _HEAD.match(re.sub(rb"#[^\r\n]*", b"", head.removeprefix(b"\xef\xbb\xbf"))) is not None


FORMAT = Format("amc", "Acclaim motion", (".amc",), _sniff, read_amc, write_amc, companion)
