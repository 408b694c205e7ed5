"""The grammar of `qmd render`: what is drawn, of which frames, how it looks, and into which file."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from qmd_studio.cli.grammar import above_zero, add_skeleton, add_verb, bad_value

VIEWS = ("front", "back", "left", "right", "top", "bottom", "three-quarter")
LOOKS = ("solid", "segments", "xray", "wire")
MAX_SIDE = 8192

FrameChoice = Callable[[int], list[int]]
"""Given the number of frames there are, the numbers of those that are meant, which may be none of them."""

_DESCRIPTION = """One frame gives a picture. Several in a .png give a contact sheet with captions, or, where the name of
OUT holds # signs, such as walk-####.png, a numbered file each. An .mp4 or .gif plays them; the camera goes along with
the figure."""


def add_render(verbs: Any) -> None:
    """Add the verb `render`."""
    parser = add_verb(verbs, "render", "draw a motion or a body into a picture, a contact sheet or a film")
    parser.description = f"{parser.description} {_DESCRIPTION}"
    parser.add_argument("input", metavar="MOTION", help="any file that opens: a motion, a body or a skeleton")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="a name that ends in .png, .mp4 or .gif")
    add_skeleton(parser)
    parser.add_argument("--body", metavar="AVATAR", help="who moves: a file with a body, or the name of an avatar")
    parser.add_argument(
        "--frames",
        metavar="LIST",
        type=read_frames,
        help="such as 0,10,20 or 0:300:25, b of a:b:step included (the first; all for a film)",
    )
    parser.add_argument("--size", metavar="WxH", type=read_size, help="pixels (1280x720; 400x400 each on a sheet)")
    parser.add_argument("--view", choices=VIEWS, default="three-quarter", help="where from (three-quarter)")
    parser.add_argument("--theme", choices=("light", "dark"), default="light", help="the stage (light)")
    parser.add_argument("--look", choices=LOOKS, default="solid", help="how the body is shown (solid)")
    parser.add_argument(
        "--fps", metavar="F", type=above_zero("--fps"), help="frames a second of a film (the motion's, at most 30)"
    )
    parser.add_argument("--transparent", action="store_true", help=".png: no backdrop, only what stands before it")


def read_size(text: str) -> tuple[int, int]:
    """Read "1280x720"."""
    match = re.fullmatch(r"(\d{1,5})[xX×](\d{1,5})", text, re.ASCII)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(16 <= side <= MAX_SIDE for side in size):
        raise bad_value("--size", f"WxH, 16 to {MAX_SIDE} pixels each, such as 1280x720", text)
    return size


def read_frames(text: str) -> FrameChoice:
    """Read "0,10,20-…": numbers and ranges a:b:step, of which a, b and step may each be left out."""
    parts = [_range(part.strip(), text) for part in text.split(",")]

    def chosen(n_frames: int) -> list[int]:
        found: list[int] = []
        for first, last, step in parts:
            found += range(first, (n_frames - 1 if last is None else last) + 1, step)
        return found

    return chosen


def _range(part: str, text: str) -> tuple[int, int | None, int]:
    match = re.fullmatch(r"(\d{1,9})|(\d{1,9})?:(\d{1,9})?(?::(\d{1,9}))?", part, re.ASCII)
    if match is None:
        raise bad_value("--frames", "frames and ranges a:b:step from 0 up, such as 0,10,20 or 0:300:25", text)
    if match[1]:
        return int(match[1]), int(match[1]), 1
    first, last, step = int(match[2] or 0), int(match[3]) if match[3] else None, int(match[4] or 1)
    if step == 0 or (last is not None and (last < first or (last - first) // step >= 100_000)):
        raise bad_value("--frames", "a range a:b:step with a not above b and a step of 1 or more", text)
    return first, last, step
