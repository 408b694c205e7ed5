"""Several pictures on one sheet, each with its caption."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from qmd_studio.render.lettering import text_mask

Picture = NDArray[np.uint8]
_PAPER = {False: ((232, 235, 239), (44, 51, 62)), True: ((22, 24, 29), (214, 220, 229))}
"""Paper and ink, light and dark."""


def sheet_columns(n_pictures: int, size: tuple[int, int]) -> int:
    """Return how many pictures of `size` stand beside each other, for a sheet half as wide again as it is high."""
    return max(1, min(n_pictures, round(math.sqrt(1.5 * n_pictures * size[1] / size[0]))))


def contact_sheet(pictures: Sequence[Picture], captions: Sequence[str], title: str, *, dark: bool = False) -> Picture:
    """Return the pictures, all of one size and kind, in rows with a caption under each and `title` above all.

    With (h, w, 4) pictures the sheet is transparent too, and so is its paper.
    """
    height, width, channels = pictures[0].shape
    columns = sheet_columns(len(pictures), (width, height))
    rows = -(-len(pictures) // columns)
    letters = max(12, min(26, width // 17))
    gap, foot = max(6, letters // 2), letters + max(6, letters // 2)
    head = 2 * letters + gap
    paper, ink = _PAPER[dark]
    sheet = np.empty((head + rows * (height + foot + gap), gap + columns * (width + gap), channels), np.uint8)
    sheet[:] = (*paper, 0)[:channels]
    _write(sheet, title, (gap, gap), round(1.25 * letters), ink)
    for number, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        row, column = divmod(number, columns)
        top, left = head + row * (height + foot + gap), gap + column * (width + gap)
        sheet[top : top + height, left : left + width] = picture
        _write(sheet[:, : left + width], caption, (left + 2, top + height + gap // 2), letters, ink)
    return sheet


def _write(sheet: Picture, text: str, at: tuple[int, int], height: int, ink: tuple[int, int, int]) -> None:
    """Write on the sheet itself, `at` being the left and upper end; what has no room is cut off."""
    left, top = at
    room = max(sheet.shape[1] - left, 0)
    mask = text_mask(_fitting(text, room, height), height)[:, :room, None]
    under = sheet[top : top + height, left : left + mask.shape[1]]
    full = np.array((*ink, 255)[: sheet.shape[2]], dtype=np.float64)
    if sheet.shape[2] == 4:
        under[:, :, :3] = ink  # nothing lies under it but transparent paper
        under[:, :, 3:] = np.maximum(under[:, :, 3:], np.rint(255 * mask))
    else:
        under[:] = np.rint(under * (1 - mask) + full * mask)


def _fitting(text: str, room: int, height: int) -> str:
    """The text, shortened in its middle until it fits."""
    most = max(room // max(1, round(0.6 * height)), 1)
    if len(text) <= most:
        return text
    head = (most - 1) * 2 // 3
    return text[:head] + "…" + text[len(text) - max(most - 1 - head, 0) :]
