"""`qmd retarget`: a motion on another body."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from qmd_studio import registry, storage
from qmd_studio.avatar.humanoid import Body
from qmd_studio.avatar.upright import upright
from qmd_studio.cli.load import open_motion
from qmd_studio.cli.report import Report, Value
from qmd_studio.cli.save import save_motion
from qmd_studio.errors import FormatError
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.bap_body import bap_skeleton_like, is_hanim
from qmd_studio.motion.joint_map import JointMap, cmu_62_map, read_joint_map, write_joint_map
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.reference_pose import REST, ZERO, Reference, choose_reference, frame_reference
from qmd_studio.motion.retarget import RetargetResult, retargeting
from qmd_studio.motion.skeleton import Skeleton

CMU_62 = "cmu-62"
"""The name of the map that ships: CMU's bones to as few body animation parameters."""


def run(arguments: Namespace) -> Report:
    """Write MOTION on AVATAR as OUT. Raises `FormatError` for a map that does not fit or a frame that is not there."""
    output = Path(arguments.output)
    opened = open_motion(arguments.input, skeleton=arguments.skeleton)
    motion = opened.motion
    target, body, warnings = _target(arguments.body, output)
    way = retargeting(
        motion.skeleton,
        target,
        joint_map=_map(arguments.map, motion.skeleton, target),
        reference=_reference(arguments.align, motion),
        upright=upright(motion),
        limits=arguments.limits,
    )
    result = way.motion(motion, fps=arguments.fps, pin_feet=arguments.pin_feet)
    written = _save(output, result.motion, body)
    if arguments.save_map:
        storage.write_atomic(arguments.save_map, write_joint_map(way.joint_map))
    values, lines = _figures(result)
    return Report(
        {**written.values, **values},
        [*written.lines, *lines],
        opened.warnings + warnings + written.warnings,
        opened.notes + result.notes,
    )


def _target(name: str | None, output: Path) -> tuple[Skeleton, Body | None, tuple[str, ...]]:
    """Return the skeleton to move, the body it is of where there is one, and the warnings about its file."""
    if name is None:
        return bap_skeleton(), None, ()
    loaded = registry.open_body(name)
    if output.suffix.lower() == ".bap" and all(column.bap_id is None for column in loaded.skeleton.columns):
        if not is_hanim(loaded.skeleton):
            raise FormatError(
                "body animation parameters move H-Anim bodies only",
                path=name,
                wanted="a body with H-Anim's joint names",
                got=f"the joints of {loaded.skeleton.name!r}",
            )
        return bap_skeleton_like(loaded.skeleton), None, loaded.warnings
    return loaded.skeleton, loaded.body, loaded.warnings


def _map(name: str | None, source: Skeleton, target: Skeleton) -> JointMap | None:
    if name is None:
        return None
    if name == CMU_62:
        return cmu_62_map(source, target)
    try:
        return read_joint_map(storage.read_bytes(name)).checked(source, target)
    except FormatError as problem:
        raise problem.located(name) from None


def _reference(align: str | int | None, motion: Motion) -> Reference:
    if align is None:
        return choose_reference(motion)
    if align == "rest":
        return REST
    return ZERO if align == "zero" else frame_reference(motion, int(align))


def _save(output: Path, motion: Motion, body: Body | None) -> Report:
    """Write the motion, with the body where the format holds one."""
    if body is not None and registry.format_for(output).write_figure is not None:
        figure = body if body.skeleton == motion.skeleton else replace(body, skeleton=motion.skeleton)
        registry.save_figure(output, figure, motion)
        frames, dofs = motion.X.shape
        size = output.stat().st_size
        values: dict[str, Value] = {
            "file": str(output),
            "frames": frames,
            "fps": motion.fps,
            "dofs": dofs,
            "bytes": size,
        }
        return Report(values, [("written", f"{output}, with its body, {frames:,} frames")])
    return save_motion(output, motion)


def _figures(result: RetargetResult) -> tuple[dict[str, Value], list[tuple[str, str]]]:
    worst = sorted(result.joint_angle_error_deg.items(), key=lambda item: -item[1])[:3]
    values: dict[str, Value] = {
        "mapped": len(result.mapped),
        "unmapped": len(result.unmapped),
        "unmapped_joints": list(result.unmapped),
        "clamped_share": result.clamped_share,
        "mean_angle_error_deg": result.mean_angle_error_deg,
        "joint_angle_error_deg": dict(result.joint_angle_error_deg),
        "notes": list(result.notes),
    }
    missing = f"; nothing follows {', '.join(result.unmapped[:6])}" if result.unmapped else ""
    more = f" and {len(result.unmapped) - 6} more" if len(result.unmapped) > 6 else ""
    lines = [
        ("joints", f"{len(result.mapped)} driven{missing}{more}"),
        ("limits", f"{100 * result.clamped_share:.1f} % of the values lay outside the anatomical ones"),
        ("angle error", f"{result.mean_angle_error_deg:.2f}°; most: " + ", ".join(f"{n} {e:.1f}°" for n, e in worst)),
    ]
    return values, lines
