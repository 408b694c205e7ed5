"""The exceptions that a user may see. Each says what, where, what was wanted, what was got, and what to do."""

from __future__ import annotations

from pathlib import Path


class QmdStudioError(Exception):
    """Base of every error the studio reports on purpose.

    `message` says what is wrong in one sentence. The keywords say the rest where it is known: `path` the file,
    `at` the place in it ("line 12", "byte 48", "frame 3, joint lhand"), `wanted` and `got`, and `hint` the next step.
    """

    def __init__(
        self,
        message: str,
        *,
        path: Path | str | None = None,
        at: str | None = None,
        wanted: str | None = None,
        got: str | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.path = Path(path) if path is not None else None
        self.at = at
        self.wanted = wanted
        self.got = got
        self.hint = hint

    def __str__(self) -> str:
        place = ", ".join(str(part) for part in (self.path, self.at) if part)
        text = f"{place}: {self.message}" if place else self.message
        expectation = "; ".join(
            f"{word} {value}" for word, value in (("wanted", self.wanted), ("got", self.got)) if value
        )
        if expectation:
            text += f" ({expectation})"
        return f"{text}. {self.hint}" if self.hint else text

    def located(self, path: Path | str) -> QmdStudioError:
        """Return this error with `path` filled in, where the raiser saw only bytes."""
        if self.path is None:
            self.path = Path(path)
        return self

    def as_json(self) -> dict[str, str | None]:
        """Return the keys that every `--json` error has: error, file, at, wanted, got, hint."""
        return {
            "error": self.message,
            "file": str(self.path) if self.path else None,
            "at": self.at,
            "wanted": self.wanted,
            "got": self.got,
            "hint": self.hint,
        }


class FormatError(QmdStudioError):
    """A file is not what it should be, or cannot hold what it is asked to hold."""


class CodecError(QmdStudioError):
    """A codec was given settings or a motion that it cannot encode."""


class Cancelled(QmdStudioError):
    """Work was told to stop before it had come to anything."""


class EditError(QmdStudioError):
    """A command cannot be applied to the open document."""


class StorageError(QmdStudioError):
    """A file of the user's could not be read or written."""
