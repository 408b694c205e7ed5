"""The stroke alphabet: letters stand where they should and differ from each other."""

from itertools import combinations

import numpy as np

from qmd_studio.render.contact_sheet import contact_sheet
from qmd_studio.render.lettering import _STROKES, text_mask


def test_every_letter_of_a_file_name_is_there_and_no_two_look_the_same():
    masks = {letter: text_mask(letter, 20) for letter in _STROKES}
    assert set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-()[]+#= ,") <= masks.keys()
    alike = [a + b for a, b in combinations(masks, 2) if np.abs(masks[a] - masks[b]).sum() < 1]
    assert alike == []


def test_letters_keep_inside_their_height_and_stand_on_a_line():
    for letter, mask in ((letter, text_mask(letter, 40)) for letter in _STROKES if letter != " "):
        assert 0 <= mask.min() <= mask.max() <= 1
        assert mask.any(), letter
    foot = [np.flatnonzero(text_mask(letter, 40).any(axis=1)).max() for letter in "AEHKMNTXZabdhiklmnrxz1247"]
    assert max(foot) - min(foot) <= 1
    assert np.flatnonzero(text_mask("g", 40).any(axis=1)).max() > max(foot) + 3


def test_unknown_letters_are_boxes_and_length_goes_by_letters():
    assert text_mask("语", 20).any()
    assert text_mask("abc", 20).shape == (20, 3 * text_mask("a", 20).shape[1])
    assert text_mask("", 20).shape == (20, 0)


def test_sheet_holds_every_picture_unchanged_and_shortens_long_captions():
    rng = np.random.default_rng(3)
    pictures = [rng.integers(0, 256, (30, 40, 3)).astype(np.uint8) for _ in range(5)]
    sheet = contact_sheet(pictures, ["frame 0 and a very long caption indeed"] * 5, "title " * 50)
    for picture in pictures:
        rows, columns = np.nonzero((sheet == picture[0, 0]).all(axis=2))
        inside = zip(rows, columns, strict=True)
        assert any(np.array_equal(sheet[y : y + 30, x : x + 40], picture) for y, x in inside)
    assert contact_sheet([p[:, :, [0, 1, 2, 2]] for p in pictures], [""] * 5, "")[0, 0, 3] == 0
