"""Which format or codec opens and writes what: the one list of them.

The modules are imported when a file is first opened or written, so that asking for help costs nothing.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache, lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qmd_studio import assets
from qmd_studio.errors import FormatError, QmdStudioError
from qmd_studio.formats.gzip_bytes import head as unpacked_head
from qmd_studio.formats.gzip_bytes import packed, unpacked
from qmd_studio.formats.loaded import Format, Loaded, ReadOptions
from qmd_studio.storage import read_bytes, write_atomic

if TYPE_CHECKING:
    from qmd_studio.avatar.humanoid import Body
    from qmd_studio.motion.motion import Motion

    FORMATS: tuple[Format, ...]

FORMAT_MODULES: tuple[str, ...] = (
    "qmd_studio.formats.glb",
    "qmd_studio.formats.gltf",
    "qmd_studio.formats.bvh",
    "qmd_studio.formats.asf_amc",
    "qmd_studio.formats.asf",
    "qmd_studio.formats.bap_text",
    "qmd_studio.formats.csv_text",
    "qmd_studio.formats.npz",
    "qmd_studio.formats.x3d",
    "qmd_studio.formats.x3dv",
    "qmd_studio.formats.wrl",
)
"""A format is a module with a `FORMAT`; one line here adds it. The more telling the content, the earlier it stands."""

DEFAULT_AVATAR = "ada"
"""The avatar that stands there at first, and that any motion of a person is shown on."""
_AVATAR_FILE = "avatar.x3d"

SNIFFED_BYTES = 4096
"""How much of a file's beginning decides what it is."""

_DEFAULTS = ReadOptions()


def open_file(path: Path | str, options: ReadOptions = _DEFAULTS) -> Loaded:
    """Open the file at `path`, recognised by its content first and by its suffix second.

    Raises `StorageError` where it cannot be read, and `FormatError`, naming the file, where its content is wrong.
    """
    path = Path(path)
    _check_options(options)
    data = read_bytes(path)
    if not data:
        raise FormatError("the file is empty", path=path, wanted="a motion or a body", hint="Get a whole copy")
    try:
        data = unpacked(data)
        chosen = recognise(data, path)
        return chosen.read(data, replace(options, path=path))
    except QmdStudioError as problem:
        problem.located(path)
        raise


def save_motion(path: Path | str, motion: Motion) -> None:
    """Write `motion` to `path`, whole or not at all, in the format that the suffix names.

    A file that the format needs beside it, such as an AMC's skeleton, is written too unless one is there.

    Raises `FormatError` where no format has that suffix or the format cannot hold the motion's skeleton, and
    `StorageError` where the file cannot be written.
    """
    path = Path(path)
    try:
        data = encode_motion(path.suffix, motion)
        companion = format_for(path).companion
        beside = companion(path, motion) if companion else None
    except QmdStudioError as problem:
        problem.located(path)
        raise
    if beside:
        write_atomic(*beside)
    write_atomic(path, data)


def encode_motion(suffix: str, motion: Motion) -> bytes:
    """Return the bytes of a file with `suffix` (".bvh") that holds `motion`; see `save_motion`."""
    target = format_for(Path(f"motion{suffix}"))
    if target.write is None and target.write_figure is not None:
        message = f"{target.title} files hold a body with its motion, not a motion alone"
        raise FormatError(message, hint=f"Save the body. {_writable_hint()}")
    if target.write is None:
        raise FormatError(f"{target.title} files can be read but not written", hint=_writable_hint())
    return target.write(motion)


def save_figure(path: Path | str, body: Body, motion: Motion | None = None) -> None:
    """Write `body` to `path`, whole or not at all, with `motion` on its skeleton where one is given.

    Raises `FormatError` where no format has that suffix, the format holds no bodies, or the motion is on another
    skeleton than the body, and `StorageError` where the file cannot be written.
    """
    path = Path(path)
    try:
        data = encode_figure(path.suffix, body, motion)
    except QmdStudioError as problem:
        problem.located(path)
        raise
    write_atomic(path, data)


def encode_figure(suffix: str, body: Body, motion: Motion | None = None) -> bytes:
    """Return the bytes of a file with `suffix` (".x3d") that holds `body` and `motion`; see `save_figure`."""
    target = format_for(Path(f"figure{suffix}"))
    if target.write_figure is None:
        raise FormatError(f"{target.title} files hold no body", hint=_hint(_suffixes_of_figures(), "hold one"))
    if motion is not None and motion.skeleton != body.skeleton:
        raise FormatError(
            "the motion is on another skeleton than the body",
            wanted=f"the {body.skeleton.n_columns} columns of {body.skeleton.name!r}",
            got=f"the {motion.skeleton.n_columns} columns of {motion.skeleton.name!r}",
            hint="Retarget the motion to the body first",
        )
    data = target.write_figure(body, motion)
    return packed(data) if suffix.lower() in target.packed else data


def avatar_names() -> tuple[str, ...]:
    """Return the names of the avatars that ship, the default first."""
    found = sorted(path.parent.name for path in assets.avatar().glob(f"*/{_AVATAR_FILE}"))
    return tuple(sorted(found, key=lambda name: name != DEFAULT_AVATAR))


def avatar_file(name: Path | str) -> Path:
    """Return the file of the avatar that ships as `name`, or `name` as a path.

    Raises `FormatError` where no such avatar ships.
    """
    if isinstance(name, Path) or not re.fullmatch(r"[\w-]+", name) or Path(name).exists():
        return Path(name)
    if name in avatar_names():
        return assets.avatar(name, _AVATAR_FILE)
    wanted = f"a file with a body, or {' or '.join(avatar_names()) or 'none'}"
    raise FormatError("no avatar of this name ships", got=name, wanted=wanted)


def open_body(name: Path | str) -> Loaded:
    """Open a file with a body, or an avatar that ships, by its name; the latter is read once.

    Raises as `open_file` and `avatar_file` do.
    """
    path = avatar_file(name)
    return _open_avatar(path) if isinstance(name, str) and path != Path(name) else open_file(path)


def default_body() -> Body | None:
    """Return the body of the default avatar, read once; None where it does not ship."""
    return open_body(DEFAULT_AVATAR).body if DEFAULT_AVATAR in avatar_names() else None


@lru_cache(maxsize=8)
def _open_avatar(path: Path) -> Loaded:
    return open_file(path)


def format_for(path: Path | str) -> Format:
    """Return the format that the suffix of `path` names; raises `FormatError` with the suffixes there are."""
    suffix = Path(path).suffix.lower()
    for candidate in formats():
        if suffix in candidate.suffixes:
            return candidate
    raise FormatError("no format has this suffix", got=suffix or "no suffix", hint=_writable_hint())


@cache
def formats() -> tuple[Format, ...]:
    """Return all formats in the order in which they are tried; also as the module's `FORMATS`."""
    return (_qmd(), *(import_module(name).FORMAT for name in FORMAT_MODULES))


def __getattr__(name: str) -> Any:
    if name == "FORMATS":
        return formats()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def recognise(data: bytes, path: Path) -> Format:
    """Return the format of a file by its content first and its suffix second; raises `FormatError` for neither."""
    head = unpacked_head(data, SNIFFED_BYTES)
    suffix = path.suffix.lower()
    by_content = [candidate for candidate in formats() if candidate.sniff(head)]
    by_suffix = [candidate for candidate in formats() if suffix in candidate.suffixes]
    agreed = [candidate for candidate in by_content if candidate in by_suffix]
    for candidate in (*agreed, *by_content, *by_suffix):
        return candidate
    known = ", ".join(f"{candidate.title} ({' '.join(candidate.suffixes)})" for candidate in formats())
    raise FormatError("this is no file that the studio can open", got=suffix or "no suffix", wanted=known)


def _qmd() -> Format:
    """Return the format of .qmd files: it is put together here because codecs and formats do not know each other."""
    from qmd_studio.codecs.qmd import file

    return Format("qmd", "Quantized Motion Data", (file.SUFFIX,), file.sniff, _read_qmd, file.write)


def _read_qmd(data: bytes, options: ReadOptions) -> Loaded:
    from qmd_studio.codecs.qmd.decode import decode

    skeleton = open_file(options.skeleton).skeleton if options.skeleton else None
    motion = decode(data, skeleton)
    if options.skeleton and motion.skeleton is skeleton:
        _check_says_order(options.skeleton)
    if options.fps is not None:
        motion = replace(motion, fps=options.fps)
    return Loaded(motion.skeleton, motion)


def _check_says_order(path: Path) -> None:
    """Raise `FormatError` for an ASF: its motions have their own order of columns, so values would go astray."""
    if recognise(read_bytes(path), path).name == "asf":
        raise FormatError(
            "an .asf does not say in which order a motion's columns stand",
            path=path,
            wanted="a motion on that skeleton, such as the .amc that was encoded",
            hint="Give that with --skeleton",
        )


def _check_options(options: ReadOptions) -> None:
    for name, value in (("frame rate", options.fps), ("length unit", options.metres_per_unit)):
        if value is not None and not 0 < value < math.inf:
            raise FormatError(f"the {name} given is not a positive number", wanted="a number above 0", got=f"{value:g}")


def _writable_hint() -> str:
    suffixes = [suffix for candidate in formats() if candidate.write for suffix in candidate.suffixes]
    return _hint(suffixes, "can be written")


def _suffixes_of_figures() -> list[str]:
    return [suffix for candidate in formats() if candidate.write_figure for suffix in candidate.suffixes]


def _hint(suffixes: list[str], what: str) -> str:
    return f"Suffixes that {what} are {', '.join(suffixes) or 'none yet'}"
