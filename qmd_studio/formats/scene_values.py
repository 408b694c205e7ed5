"""Values of fields as text: runs of numbers, flags and quoted texts, read and written."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.formats.scene_graph import Raw

_SHORT = 160
"""Below this many characters a list of words is quicker than setting up the scanner."""
_INTEGERS = frozenset({"MFInt32", "SFInt32", "SFImage"})
_ESCAPED_OR_QUOTE = re.compile(r'\\.|"', re.DOTALL)


def parse_numbers(text: str, whole: bool = False) -> FloatArray | IntArray | None:
    """Return the numbers (n,) in `text`, commas being blanks; None where a word is none.

    `whole` asks for whole numbers, and gives fractions where they stand.
    """
    if "," in text:
        text = text.replace(",", " ")
    if len(text) >= _SHORT:
        found: FloatArray | IntArray | None = _scan(text, np.int64) if whole else None
        if found is None:
            found = _scan(text, np.float64)
        return found
    words = text.split()
    try:
        if whole:
            try:
                return np.array([int(word, 16 if word[:2] in ("0x", "0X") else 10) for word in words], dtype=np.int64)
            except (ValueError, OverflowError):
                pass
        return np.array([float(word) for word in words], dtype=np.float64)
    except ValueError:
        return None


def _scan(text: str, dtype: Any) -> Any:
    if not text or text.isspace():
        return np.zeros(0, dtype=dtype)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return np.fromstring(text, dtype=dtype, sep=" ")
    except (ValueError, DeprecationWarning, OverflowError):
        return None


def parse_value(kind: str | None, text: str) -> Any:
    """Return the value of an XML attribute of type `kind`; `Raw` where the type is not known or the text not of it."""
    if kind is None:
        return Raw(text)
    if kind == "SFString":
        return text
    if kind == "MFString":
        quoted = list(_quoted(text))
        if not quoted and text.strip():
            return (text,)
        return tuple(_unescaped(part) for part in quoted)
    if kind == "SFBool":
        return {"true": True, "false": False}.get(text.strip().lower(), Raw(text))
    if kind.endswith(("Node", "MFBool")):
        return Raw(text)
    found = parse_numbers(text, kind in _INTEGERS)
    return Raw(text) if found is None else found


def closing_quote(text: str, start: int) -> int:
    """Return where the quotation that begins at `start`, after its quote, is closed; -1 where it is not."""
    return next((m.start() for m in _ESCAPED_OR_QUOTE.finditer(text, start) if m.group() == '"'), -1)


def _quoted(text: str) -> Iterator[str]:
    start = text.find('"')
    while start >= 0 and (end := closing_quote(text, start + 1)) >= 0:
        yield text[start + 1 : end]
        start = text.find('"', end + 1)


def guessed_value(text: str) -> Any:
    """Return what the text of an attribute of no known type most likely is: a flag, numbers, or a text."""
    flag = {"true": True, "false": False}.get(text.strip().lower())
    if flag is not None:
        return flag
    found = parse_numbers(text) if text.strip() else None
    return text if found is None else found


def numbers_text(values: FloatArray | IntArray) -> str:
    """Return numbers as text, each in the fewest digits that read back the same."""
    if values.dtype.kind in "iu":
        return " ".join(map(str, values.tolist()))
    words = [repr(value) for value in values.tolist()]
    return " ".join(word[:-2] if word.endswith(".0") else word for word in words)


def quoted(text: str) -> str:
    """Return `text` in the quotes of VRML."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def unquoted(text: str) -> str:
    """Return what stands inside the quotes of VRML."""
    return _unescaped(text[1:-1])


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", r"\1", text, flags=re.DOTALL) if "\\" in text else text
