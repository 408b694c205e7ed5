"""Inline: scenes from files in the same folder. Nothing else is opened: no network, no other folder."""

from __future__ import annotations

import re
from pathlib import Path

from qmd_studio.errors import QmdStudioError
from qmd_studio.formats.hanim_view import View
from qmd_studio.formats.scene_file import parse_scene
from qmd_studio.formats.scene_graph import Node
from qmd_studio.storage import read_bytes

MAX_FILES = 32
"""A scene that draws in more files than this is not followed further."""
MAX_BYTES = 64 << 20
_PLAIN_NAME = re.compile(r"[^/\\:\x00]+")


def open_inlines(view: View, path: Path | None) -> None:
    """Read the scenes that the Inlines of `view` name, and those that they name in turn; what is left out is said."""
    opened = 0
    waiting = [(inline, [path.resolve()] if path else []) for inline in view.every("Inline")]
    while waiting:
        inline, trail = waiting.pop()
        target, reason = _target(inline, trail)
        if target is None:
            view.warn(inline, f"{reason}; it is left out")
            continue
        opened += 1
        if opened > MAX_FILES:
            view.warn(inline, f"more than {MAX_FILES} files are drawn in; it is left out")
            return
        try:
            scene = parse_scene(read_bytes(target, limit=MAX_BYTES))
        except QmdStudioError as problem:
            view.warn(inline, f"{target.name} cannot be read ({problem.message}); it is left out")
            continue
        view.inlined[id(inline)] = [scene]
        inner = View(scene)
        waiting.extend((node, [*trail, target]) for node in inner.every("Inline"))


def _target(inline: Node, trail: list[Path]) -> tuple[Path | None, str]:
    """Return the file that an Inline names, or why none is opened."""
    urls = inline.get("url")
    names = [urls] if isinstance(urls, str) else list(urls) if isinstance(urls, tuple) else []
    if not trail:
        return None, "an Inline is only found beside a file that has a name"
    reason = "it names no file"
    for name in names:
        if not isinstance(name, str) or not _PLAIN_NAME.fullmatch(name) or name in (".", ".."):
            reason = "only files in the same folder are opened"
            continue
        found = (trail[0].parent / name).resolve()
        if found.parent != trail[0].parent:
            reason = "the file lies in another folder"
        elif found in trail:
            reason = "the file draws in itself"
        elif not found.is_file():
            reason = f"there is no file {name[:60]!r}"
        else:
            return found, ""
    return None, reason
