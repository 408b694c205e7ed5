"""The tokens of ClassicVRML and VRML97: one scan, in which a run of numbers is one token."""

from __future__ import annotations

import re
from dataclasses import dataclass

from qmd_studio.errors import FormatError

_TOKEN = re.compile(
    r"""(?:[\s,\x00]++|\#[^\n\r]*+)*+
    (?:(?P<string>"(?:[^"\\]++|\\.)*+")
    |(?P<numbers>[-+]?\.?\d[-+.\d,\s]*+(?:(?<=[\d.])[eE][-+\d][-+.\d,\s]*+)*+(?:(?<=0)[xX][0-9a-fA-F]++[\s,]*+)?+)
    |(?P<word>[^\s,"'\#\[\]{}.\x00-\x20+\-\d\\][^\s,"'\#\[\]{}.\x00-\x20\\]*+)
    |(?P<mark>[\[\]{}.]))""",
    re.VERBOSE | re.DOTALL,
)
_BLANK = re.compile(r"(?:[\s,\x00]++|#[^\n\r]*+)*+")
_KINDS = ("", "string", "numbers", "word", "mark")


@dataclass(slots=True)
class Tokens:
    """The tokens of `text` one after the other: `kind`, `word` and `start` are those of the one that is due.

    Kinds are "string" (quotes included), "numbers" (one or more), "word", "mark" (one of []{}.) and "end".
    """

    text: str
    position: int = 0
    kind: str = ""
    word: str = ""
    start: int = 0

    def advance(self) -> None:
        """Go on to the next token; raises `FormatError` for a character that begins none."""
        match = _TOKEN.match(self.text, self.position)
        if match is None:
            blank = _BLANK.match(self.text, self.position)
            self.start = blank.end() if blank else self.position
            if self.start < len(self.text):
                raise self.wrong("this is no part of the language", wanted="a name, a number or a quoted text")
            self.kind, self.word = "end", ""
            return
        group = match.lastindex or 0
        self.kind, self.word = _KINDS[group], match.group(group)
        self.start, self.position = match.start(group), match.end()

    def take(self, kind: str, wanted: str) -> str:
        """Return the due token's text, which must be of `kind`, and go on."""
        if self.kind != kind:
            raise self.wrong("the file breaks its grammar", wanted=wanted)
        word = self.word
        self.advance()
        return word

    def expect(self, mark: str) -> None:
        """Go past `mark`, which must be due."""
        if self.kind not in ("mark", "word") or self.word != mark:
            raise self.wrong("the file breaks its grammar", wanted=repr(mark))
        self.advance()

    def wrong(self, message: str, *, wanted: str) -> FormatError:
        """Return the error for the due token, with its line and column."""
        line = self.text.count("\n", 0, self.start) + 1
        column = self.start - (self.text.rfind("\n", 0, self.start) + 1) + 1
        got = self.text[self.start : self.start + 20].split("\n")[0] or "the end of the file"
        return FormatError(message, at=f"line {line}, column {column}", wanted=wanted, got=got)
