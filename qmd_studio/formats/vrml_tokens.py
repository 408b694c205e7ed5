"""The tokens of ClassicVRML and VRML97: one scan, in which a run of numbers is one token."""

from __future__ import annotations

import re
from dataclasses import dataclass

from qmd_studio.errors import FormatError
from qmd_studio.formats.scene_values import closing_quote

# No group is possessive: Python 3.11 before .5 goes astray in them. No group is repeated without end either, for every
# repetition is remembered.
_BLANK = re.compile(r"[\s,\x00]*(?:\#[^\n\r]*(?:[\n\r]|\Z)[\s,\x00]*){0,1000}")
_TOKEN = re.compile(
    r"""(?P<string>")
    |(?P<numbers>[-+]?\.?\d[-+.\d,\s]*)
    |(?P<word>[^\s,"'\#\[\]{}.\x00-\x20+\-\d\\][^\s,"'\#\[\]{}.\x00-\x20\\]*)
    |(?P<mark>[\[\]{}.])""",
    re.VERBOSE,
)
_EXPONENTS = re.compile(r"(?:(?<=[\d.])[eE][-+\d][-+.\d,\s]*){1,1000}")
"""What goes on after a number's e, and all numbers up to the next; so many at a time, for each is remembered."""
_HEXADECIMAL = re.compile(r"(?<=0)[xX][0-9a-fA-F]+[\s,]*")
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
        while (blank := _BLANK.match(self.text, self.position)) and blank.end() > self.position:
            self.position = blank.end()
        self.start = self.position
        match = _TOKEN.match(self.text, self.position)
        if match is None:
            if self.start < len(self.text):
                raise self.wrong("this is no part of the language", wanted="a name, a number or a quoted text")
            self.kind, self.word = "end", ""
            return
        self.kind, self.position = _KINDS[match.lastindex or 0], match.end()
        if self.kind == "numbers":
            self._go_on_with_numbers()
        elif self.kind == "string":
            self._go_on_to_quote()
        self.word = self.text[self.start : self.position]

    def _go_on_with_numbers(self) -> None:
        """Take into the due token what follows an exponent or stands in hexadecimal."""
        for pattern in (_EXPONENTS, _HEXADECIMAL):
            while more := pattern.match(self.text, self.position):
                self.position = more.end()

    def _go_on_to_quote(self) -> None:
        end = closing_quote(self.text, self.position)
        if end < 0:
            raise self.wrong("a quotation is not closed", wanted='"')
        self.position = end + 1

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
