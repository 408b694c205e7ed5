"""The file of a preset: settings with a name, as JSON that a person can read.

Version 1 holds settings of the paper's format alone; version 2 names the profile and what is left out. What version 1
can hold is written as version 1.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any, TypeVar

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.tuning.encode_settings import EncodeSettings, Profile
from qmd_studio.tuning.reduction import Reduction

MAX_NAME = 80
_KIND = "QMD Studio preset"
_PAPER_ONLY, _ANY_PROFILE = 1, 2
_MAYBE_NONE = {"mean_error_mm": 0.0, "max_loa": 0}
"""Settings that may be absent, with a value of their type; the bound of a compact file is one too."""

_Settings = TypeVar("_Settings", QmdSettings, CompactSettings, Reduction)


@dataclass(frozen=True, slots=True)
class Preset:
    """`settings` called `name`."""

    name: str
    settings: EncodeSettings


def to_json(preset: Preset) -> bytes:
    """Return the file of a preset; an infinite number is the string "inf", which JSON has no number for."""
    settings, values = preset.settings, _values_of(preset.settings.coding)
    contents: dict[str, Any] = {"kind": _KIND, "version": _PAPER_ONLY, "name": preset.name, "settings": values}
    if settings.paper is None or settings.reduction != Reduction():
        contents |= {
            "version": _ANY_PROFILE,
            "profile": str(settings.profile),
            "reduction": _values_of(settings.reduction),
        }
    return (json.dumps(contents, indent=2, ensure_ascii=False) + "\n").encode()


def from_json(data: bytes) -> Preset:
    """Return the preset that `to_json` wrote; settings that it does not name have their defaults.

    Raises `FormatError` for anything else. Whether a motion can have these settings shows when they are used.
    """
    try:
        contents = json.loads(data)
        version = contents["version"]
        if contents["kind"] != _KIND or version not in (_PAPER_ONLY, _ANY_PROFILE):
            raise ValueError(contents["kind"])
        name, given = contents["name"], dict(contents["settings"])
        wide = contents if version == _ANY_PROFILE else {}
        profile, left = Profile(wide.get("profile", Profile.PAPER)), dict(wide.get("reduction", {}))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as problem:
        raise FormatError("this is no preset", wanted=f"a JSON file of the kind {_KIND!r}") from problem
    if not isinstance(name, str):
        raise FormatError("the preset has no name", got=repr(name))
    coding: QmdSettings | CompactSettings
    coding = _settings(QmdSettings(), given) if profile is Profile.PAPER else _settings(CompactSettings(), given)
    return Preset(checked_name(name), EncodeSettings(coding, _settings(Reduction(), left)))


def checked_name(name: str) -> str:
    """Return `name` without space around it; raises `FormatError` for none and for one that is too long."""
    name = name.strip()
    if not name:
        raise FormatError("a preset needs a name", hint="Type at least one character")
    if len(name) > MAX_NAME:
        raise FormatError("the name is too long", wanted=f"at most {MAX_NAME} characters", got=str(len(name)))
    return name


def _values_of(settings: QmdSettings | CompactSettings | Reduction) -> dict[str, Any]:
    values = {field.name: getattr(settings, field.name) for field in fields(settings)}
    return {key: "inf" if value == math.inf else value for key, value in values.items()}


def _settings(defaults: _Settings, given: dict[str, Any]) -> _Settings:
    """Return `defaults` with what is `given`; raises `FormatError` for names and values that it cannot have."""
    kinds = {field.name: _kind(defaults, field.name) for field in fields(defaults)}
    values = {key: _value(key, value, kinds.get(key), defaults) for key, value in given.items()}
    try:
        return type(defaults)(**values)
    except CodecError as problem:
        raise FormatError("the preset's settings are out of range", got=str(problem)) from problem


def _kind(defaults: _Settings, name: str) -> Any:
    value = getattr(defaults, name)
    return _MAYBE_NONE.get(name, 0.0) if value is None else value


def _value(key: str, value: Any, kind: Any, defaults: object) -> Any:
    """Return a setting's value as the type of `kind`; raises `FormatError`."""
    wrong = FormatError(f"the preset's setting {key!r} cannot be understood", got=repr(value)[:80])
    if kind is None:
        raise wrong
    if value is None and getattr(defaults, key) is None:
        return None
    if isinstance(kind, StrEnum):
        try:
            return type(kind)(value)
        except ValueError:
            raise wrong from None
    if isinstance(kind, float):
        value = math.inf if value == "inf" else value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise wrong
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise wrong
    return value
