"""Biovision Hierarchy (BVH): joints with channels in degrees and file units, one line of numbers a frame."""

from __future__ import annotations

import math
import re

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError
from qmd_studio.formats import bvh_write
from qmd_studio.formats.bvh_hierarchy import BvhNode, parse_hierarchy, parse_number
from qmd_studio.formats.bvh_numbers import MotionHead, Rows, parse_head, parse_rows
from qmd_studio.formats.frame_rate import rate_from_frame_time
from qmd_studio.formats.length_unit import with_guessed_unit
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.motion.as_euler import as_euler
from qmd_studio.motion.channels import channel_skeleton, default_site_name, has_channels
from qmd_studio.motion.kinematics import rest_values
from qmd_studio.motion.motion import Motion, check_frame_rate
from qmd_studio.motion.skeleton import LARGEST, ColumnKind, EndSite, Skeleton, Vector3

_MOTION = re.compile(rb"(?:\A|[\r\n}])[ \t]*(?=MOTION\b)", re.IGNORECASE)
_SNIFF = re.compile(rb"\s*HIERARCHY\s", re.IGNORECASE)
REST_FPS = 30.0
"""The rate of the one frame of a file without motion."""
_ADDED_SHARE = 0.05
"""Positions of at most this share of their offsets cannot be meant to replace them."""
_NEAR = 0.1
"""The share of `LARGEST` from which on a file is read again before it is handed out."""
_UTF8_BOM = b"\xef\xbb\xbf"


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins with `head` is BVH."""
    return _SNIFF.match(head.removeprefix(_UTF8_BOM)) is not None


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read a BVH file.

    Positions replace the joint's OFFSET, as is the custom; where those below the root stay near zero although the
    offsets do not, they are taken to be added to them, and made such as replace. A count of frames that the rows
    contradict and a last frame that is incomplete are warned of; a file without MOTION opens with one frame, at rest.
    Raises `FormatError` with the line.
    """
    data = data.removeprefix(_UTF8_BOM)
    found = _MOTION.search(data)
    header = data[: found.end()] if found else data
    skeleton = _skeleton(parse_hierarchy(_decode(header)))
    skeleton, note = with_guessed_unit(skeleton, options.metres_per_unit)
    if found is None or skeleton.n_columns == 0:
        missing = "MOTION section" if found is None else "channel"
        warning = f"the file has no {missing}: its skeleton stands at rest"
        return Loaded(skeleton, _at_rest(skeleton, options), warnings=(warning,), notes=(note,))
    head = parse_head(data, found.end())
    rows = parse_rows(data, skeleton.n_columns, head.end)
    warnings = _check_counts(head, rows)
    fps = options.fps if options.fps is not None else _rate(head)
    values = rows.values
    values *= _factors(skeleton)  # in place: they are this call's own
    notes = (note, *_replace_added_positions(skeleton, values))
    values.flags.writeable = False  # the motion then keeps it without a copy
    return Loaded(skeleton, Motion(skeleton, values, fps, name=_name(options)), warnings=warnings, notes=notes)


def _replace_added_positions(skeleton: Skeleton, values: FloatArray) -> tuple[str, ...]:
    """Turn positions that count from the joint's offset into such as replace it, in place; returns what to say of it.

    As positions that replace, they would draw every bone to nothing: that tells the two customs apart.
    """
    moves = [
        (index, column.rest)
        for index, column in enumerate(skeleton.columns)
        if column.kind is ColumnKind.TRANSLATION and skeleton.joints[column.joint].parent >= 0 and column.rest
    ]
    if not moves:
        return ()
    columns = [index for index, _ in moves]
    offsets = np.array([rest for _, rest in moves])
    if np.abs(values[:, columns]).mean() > _ADDED_SHARE * np.abs(offsets).mean():
        return ()
    values[:, columns] += offsets
    return ("positions below the root are near zero all through: taken as added to the joints' offsets",)


def _at_rest(skeleton: Skeleton, options: ReadOptions) -> Motion:
    return Motion(skeleton, rest_values(skeleton)[None], options.fps or REST_FPS, name=_name(options))


def _name(options: ReadOptions) -> str:
    return options.path.stem if options.path else ""


def _decode(header: bytes) -> str:
    for encoding in ("utf-8", "cp932"):
        try:
            return header.decode(encoding)
        except UnicodeDecodeError:
            continue
    return header.decode("latin-1")


def _skeleton(nodes: list[BvhNode]) -> Skeleton:
    """Build the skeleton in file units."""
    number: dict[int, int] = {}
    joints: list[tuple[str, int, Vector3, tuple[str, ...]]] = []
    sites: list[EndSite] = []
    for index, node in enumerate(nodes):
        offset = node.offset or (0.0, 0.0, 0.0)
        parent = number.get(node.parent, -1)
        if node.is_site:
            sites.append(EndSite(node.name or default_site_name(joints[parent][0]), parent, offset))
        else:
            number[index] = len(joints)
            joints.append((node.name, parent, offset, node.channels))
    return channel_skeleton(joints, sites)


def _check_counts(head: MotionHead, rows: Rows) -> tuple[str, ...]:
    n_rows, n_columns = rows.values.shape
    if rows.left_over:
        if n_rows == 0 or head.n_frames != n_rows + 1:
            raise FormatError(
                "a frame has the wrong number of values",
                at=f"line {rows.line}",
                wanted=f"{n_columns} values, {head.n_frames} frames",
                got=f"{rows.left_over} values in frame {n_rows}",
                hint="The file is cut off or damaged; get a whole copy",
            )
        return (
            f"line {rows.line}: the last frame is incomplete ({rows.left_over} of {n_columns} values) and is dropped;"
            f" {n_rows} frames remain",
        )
    if n_rows == 0:
        raise FormatError("the motion has no frame", at=f"line {head.count_line}", wanted="at least 1 frame", got="0")
    if n_rows != head.n_frames:
        return (f"line {head.count_line} says {head.n_frames} frames, but {n_rows} are there; those are used",)
    return ()


def _rate(head: MotionHead) -> float:
    try:
        parse_number(head.frame_time)
        fps = rate_from_frame_time(head.frame_time.replace(",", "."))
    except ValueError:
        raise FormatError(
            "the frame time is not a positive number",
            at=f"line {head.time_line}",
            wanted="seconds",
            got=head.frame_time[:40],
            hint="Give the frame rate by hand",
        ) from None
    check_frame_rate(fps, at=f"line {head.time_line}")
    return fps


def _factors(skeleton: Skeleton) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    radians = math.radians(1.0)
    turns = [column.kind is ColumnKind.ROTATION for column in skeleton.columns]
    return np.where(turns, radians, skeleton.metres_per_unit)


def write(motion: Motion) -> bytes:
    """Return a BVH file that holds `motion`; see `bvh_write`.

    Raises `FormatError` also for a motion so large that the file would not open again: BVH does not say its length
    unit, and under the one that is guessed on opening lengths may pass `LARGEST`.
    """
    motion = motion if has_channels(motion.skeleton) else as_euler(motion)
    data = bvh_write.write(motion)
    if _is_vast(motion):
        try:
            read(data, ReadOptions())
        except FormatError as problem:
            raise FormatError(
                f"a BVH file of this motion would not open again: {problem.message}",
                at=problem.at,
                wanted=problem.wanted,
                got=problem.got,
                hint="A BVH file does not say its length unit, which is guessed on opening; save it as CSV or NPZ",
            ) from None
    return data


def _is_vast(motion: Motion) -> bool:
    """Return whether a number of the file could be too large for the reader, in whatever unit that takes it."""
    skeleton = motion.skeleton
    offsets = [*(joint.offset for joint in skeleton.joints), *(site.offset for site in skeleton.end_sites)]
    largest = max(np.abs(motion.X).max(initial=0.0), np.abs(offsets).max())
    return bool(largest / min(skeleton.metres_per_unit, 1.0) > LARGEST * _NEAR)


FORMAT = Format(name="bvh", title="Biovision Hierarchy", suffixes=(".bvh",), sniff=sniff, read=read, write=write)
