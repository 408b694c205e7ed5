"""`qmd render`: a motion or a body as a picture, a contact sheet, numbered pictures or a film, without a window."""

from __future__ import annotations

import re
import time
from argparse import Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from qmd_studio import storage
from qmd_studio.avatar.dressed import Dressed, dress
from qmd_studio.cli.grammar import UsageError
from qmd_studio.cli.load import open_any
from qmd_studio.cli.parser_render import FrameChoice
from qmd_studio.cli.progress import ProgressLine
from qmd_studio.cli.report import Report, Value, in_bytes
from qmd_studio.errors import FormatError
from qmd_studio.motion.kinematics import rest_values
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import open_body
from qmd_studio.render.contact_sheet import contact_sheet
from qmd_studio.render.film import MAX_GIF_FPS, gif, mp4
from qmd_studio.render.png import png
from qmd_studio.render.scene import Look
from qmd_studio.render.shoot import Shot, shoot

Picture = NDArray[np.uint8]
_SUFFIXES = (".png", ".mp4", ".gif")
_FILM_FPS = 30.0
_SIZE, _TILE = (1280, 720), (400, 400)
_MAX_SHEET_PIXELS = 1 << 27
_MAX_FRAMES = 100_000


def run(arguments: Namespace) -> Report:
    """Draw the frames into OUT. Raises `FormatError` for what cannot be drawn, `GraphicsError` without a renderer."""
    started = time.perf_counter()
    path = Path(arguments.output)
    kind = path.suffix.lower()
    _check(arguments, kind)
    dressed, warnings, notes = _dressed(arguments)
    frames, fps = _frames(arguments.frames, dressed.motion, kind, arguments.fps)
    numbered = kind == ".png" and "#" in path.name
    shot = _shot(arguments, as_tiles=kind == ".png" and len(frames) > 1 and not numbered)
    line = ProgressLine(quiet=arguments.json)
    try:
        pictures = _told(shoot(dressed, frames, shot), len(frames), line)
        if numbered:
            written, size = _write_numbered(path, pictures, frames)
        else:
            data, size = _file(kind, pictures, (dressed.motion, frames, fps), (arguments, shot))
            storage.write_atomic(path, data)
            written = [str(path)]
    finally:
        line.close()
    values: dict[str, Value] = {
        "written": written if numbered else written[0],
        "frames": len(frames),
        "width": size[0],
        "height": size[1],
        "seconds": round(time.perf_counter() - started, 3),
    }
    lines = [("written", written[0] if len(written) == 1 else f"{written[0]} to {Path(written[-1]).name}")]
    lines.append(("frames", f"{len(frames):,}" + (f" at {fps:g} fps" if kind != ".png" else "")))
    n_bytes = sum(Path(name).stat().st_size for name in written)
    lines.append(("size", f"{size[0]} × {size[1]} pixels, {in_bytes(n_bytes)}"))
    return Report(values, lines, warnings, notes)


def _check(arguments: Namespace, kind: str) -> None:
    if kind not in _SUFFIXES:
        raise UsageError("pictures have another suffix", wanted=" ".join(_SUFFIXES), got=kind or "no suffix")
    if arguments.transparent and kind != ".png":
        raise UsageError("only a picture can be transparent", wanted="a .png with --transparent", got=kind)
    if arguments.fps is not None and kind == ".png":
        raise UsageError("a picture has no frame rate", wanted="an .mp4 or .gif with --fps", got=kind)
    if arguments.size and kind == ".mp4" and any(side % 2 for side in arguments.size):
        size = "x".join(map(str, arguments.size))
        raise UsageError("an MP4's sides are even", wanted="even numbers with --size", got=size)
    if arguments.fps is not None and kind == ".gif" and arguments.fps > MAX_GIF_FPS:
        raise UsageError("a GIF cannot be so quick", wanted=f"at most {MAX_GIF_FPS:g}", got=f"{arguments.fps:g}")


def _dressed(arguments: Namespace) -> tuple[Dressed, tuple[str, ...], tuple[str, ...]]:
    loaded = open_any(arguments.input, skeleton=arguments.skeleton)
    body, warnings, notes = loaded.body, loaded.warnings, loaded.notes
    if arguments.body:
        asked = open_body(arguments.body)
        if asked.body is None:
            raise FormatError("the file holds no body", path=arguments.body, wanted="an avatar")
        body, warnings = asked.body, warnings + asked.warnings
    motion = loaded.motion or Motion(loaded.skeleton, rest_values(loaded.skeleton)[None], _FILM_FPS)
    if motion.n_frames == 0:
        raise FormatError("the motion has no frames", path=arguments.input)
    dressed = dress(motion, body)
    return dressed, warnings, (*notes, dressed.note) if dressed.note else notes


def _frames(chosen: FrameChoice | None, motion: Motion, kind: str, fps: float | None) -> tuple[list[int], float]:
    """Return which frames are drawn, and how many of them a second make a film."""
    if chosen is not None:
        frames = chosen(motion.n_frames)
        if not frames or max(frames) >= motion.n_frames:
            wanted = f"frames from 0 to {motion.n_frames - 1}"
            raise UsageError("the motion has no such frame", wanted=wanted, got=str(max(frames, default="none")))
        steps = set(np.diff(frames).tolist())
        step = steps.pop() if len(steps) == 1 else 1
        return frames, fps or min(motion.fps / max(step, 1), MAX_GIF_FPS if kind == ".gif" else 60.0)
    if kind == ".png":
        return [0], motion.fps
    step = max(1, int(np.ceil(motion.fps / _FILM_FPS - 1e-9)))
    fps = fps or motion.fps / step
    n_frames = max(1, round(motion.n_frames / motion.fps * fps))
    if n_frames > _MAX_FRAMES:
        raise UsageError("the film would be too long", wanted=f"at most {_MAX_FRAMES:,} frames", got=f"{n_frames:,}")
    at = np.round(np.arange(n_frames) / fps * motion.fps).astype(int)
    return np.minimum(at, motion.n_frames - 1).tolist(), fps


def _shot(arguments: Namespace, *, as_tiles: bool) -> Shot:
    return Shot(
        size=arguments.size or (_TILE if as_tiles else _SIZE),
        view=arguments.view,
        dark=arguments.theme == "dark",
        look=Look(arguments.look),
        transparent=arguments.transparent,
    )


def _told(pictures: Iterator[Picture], n_pictures: int, line: ProgressLine) -> Iterator[Picture]:
    for number, picture in enumerate(pictures):
        line.tell(number, n_pictures, "drawing")
        yield picture


def _file(
    kind: str,
    pictures: Iterator[Picture],
    what: tuple[Motion, Sequence[int], float],
    how: tuple[Namespace, Shot],
) -> tuple[bytes, tuple[int, int]]:
    """Return the bytes of the one file that is asked for, and its size in pixels."""
    (motion, frames, fps), (arguments, shot) = what, how
    if kind == ".mp4":
        return mp4(pictures, shot.size, fps)[0], shot.size
    if kind == ".gif":
        return gif(pictures, shot.size, fps), shot.size
    if len(frames) == 1:
        return png(next(pictures)), shot.size
    if len(frames) * shot.size[0] * shot.size[1] > _MAX_SHEET_PIXELS:
        raise UsageError("the contact sheet would be too large", wanted="fewer frames, or a smaller --size")
    captions = [f"frame {frame} · {frame / motion.fps:.2f} s" for frame in frames]
    title = f"{Path(arguments.input).name} · {motion.n_frames} frames at {motion.fps:g} fps"
    sheet = contact_sheet(list(pictures), captions, title, dark=shot.dark)
    return png(sheet), (sheet.shape[1], sheet.shape[0])


def _write_numbered(
    path: Path, pictures: Iterator[Picture], frames: Sequence[int]
) -> tuple[list[str], tuple[int, int]]:
    """Write a file for each picture, the number of its frame in the place of the # signs."""
    written, size = [], (0, 0)
    for frame, picture in zip(frames, pictures, strict=True):
        head, signs, tail = re.fullmatch(r"([^#]*)(#+)(.*)", path.name, re.DOTALL).groups()  # type: ignore[union-attr]
        name = f"{head}{frame:0{len(signs)}d}{tail}"
        storage.write_atomic(path.with_name(name), png(picture))
        written.append(str(path.with_name(name)))
        size = (picture.shape[1], picture.shape[0])
    return written, size
