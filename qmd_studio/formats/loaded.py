"""What a reader is told and what it returns: one contract for every format."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What the user may say beside the file itself.

    `path` is the file's own path, for messages and for finding companions beside it. `skeleton` is an ASF given for an
    AMC, `fps` overrides the frame rate, `metres_per_unit` the length unit that a reader would otherwise guess.
    """

    path: Path | None = None
    skeleton: Path | None = None
    fps: float | None = None
    metres_per_unit: float | None = None


@dataclass(frozen=True, slots=True)
class Loaded:
    """What a file held: a motion, a body, or both. `warnings` are sentences for the user, each naming its place."""

    skeleton: Skeleton
    motion: Motion | None = None
    body: Body | None = None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    """What the reader decided and the user may want to know, such as a guessed length unit."""


@dataclass(frozen=True, slots=True)
class Format:
    """One file format: its name, suffixes (lower case, with dot), and what it can do.

    `sniff(head)` answers from the first 4,096 bytes whether the content is of this format. `read(data, options)`
    returns what the file held or raises `FormatError`. `write(motion)` returns the file's bytes, or raises
    `FormatError` where the motion's skeleton cannot be held; None where the format is read only.
    `companion(path, motion)` returns the path and bytes of a second file that the first, at `path`, cannot be opened
    without, or None where one stands there already.

    `write_figure(body, motion)` returns the bytes of a file with a body, and with a motion on that body's skeleton
    where one is given; None where the format holds no bodies. `packed` are those of the suffixes under which the bytes
    are packed by gzip; every file is unpacked before it is sniffed and read.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    sniff: Callable[[bytes], bool]
    read: Callable[[bytes, ReadOptions], Loaded]
    write: Callable[[Motion], bytes] | None = None
    companion: Callable[[Path, Motion], tuple[Path, bytes] | None] | None = None
    write_figure: Callable[[Body, Motion | None], bytes] | None = None
    packed: tuple[str, ...] = ()
