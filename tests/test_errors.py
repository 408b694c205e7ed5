"""An error says what, where, wanted, got and what to do, in a sentence and in JSON."""

from pathlib import Path

import pytest

from qmd_studio.errors import CodecError, EditError, FormatError, QmdStudioError, StorageError


def test_message_names_place_expectation_and_way_out() -> None:
    error = FormatError(
        "a frame is cut off", path="walk.amc", at="line 12", wanted="62 values", got="61", hint="Copy the file again"
    )
    assert str(error) == "walk.amc, line 12: a frame is cut off (wanted 62 values; got 61). Copy the file again"


def test_message_leaves_out_what_is_not_known() -> None:
    assert str(FormatError("the motion has no frame")) == "the motion has no frame"
    assert str(FormatError("too short", got="3 bytes")) == "too short (got 3 bytes)"


def test_json_has_the_six_keys_always() -> None:
    assert FormatError("odd", path=Path("a/b.bvh"), at="byte 4").as_json() == {
        "error": "odd",
        "file": "a/b.bvh",
        "at": "byte 4",
        "wanted": None,
        "got": None,
        "hint": None,
    }


def test_located_names_the_file_once() -> None:
    error = FormatError("odd")
    assert error.located("walk.bvh").path == Path("walk.bvh")
    assert error.located("other.bvh").path == Path("walk.bvh")


@pytest.mark.parametrize("kind", [FormatError, CodecError, EditError, StorageError])
def test_every_error_is_caught_as_the_studios_own(kind: type[QmdStudioError]) -> None:
    with pytest.raises(QmdStudioError, match=r"^message$"):
        raise kind("message")
