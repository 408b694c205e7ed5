"""Where the files that ship with the studio are, in a checkout and in an installed wheel alike."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _root() -> Path:
    """Return the folder that holds `resources/` and `avatars/`: the package in a wheel, its parent in a checkout."""
    return _PACKAGE if (_PACKAGE / "resources").is_dir() else _PACKAGE.parent


def resource(*parts: str) -> Path:
    """Return the path of a shipped resource, such as `resource("motions", "walk.bap")`."""
    return _root().joinpath("resources", *parts)


def avatar(*parts: str) -> Path:
    """Return the path of a shipped avatar file."""
    return _root().joinpath("avatars", *parts)
