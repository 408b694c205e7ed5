"""The verbs that choose what side B is encoded by: an encoder of the paper's format, or the compact profile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.project.commands import SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.tuning.encode_settings import COMPACT_DEFAULT, EncodeSettings, Profile

_PREFIX = "encoder_"


def encoder_handlers(document: Document) -> dict[str, Callable[[], object]]:
    """Return what each of these verbs does, by its id."""
    handlers: dict[str, Callable[[], object]] = {
        f"{_PREFIX}{encoder}": lambda encoder=encoder: _choose(document, encoder) for encoder in Encoder
    }
    handlers[f"{_PREFIX}{Profile.COMPACT}"] = lambda: _choose_compact(document)
    return handlers


def encoder_verb(settings: EncodeSettings) -> str:
    """Return the id of the verb that stands for `settings`."""
    return f"{_PREFIX}{settings.profile if settings.paper is None else settings.paper.encoder}"


def _choose(document: Document, encoder: Encoder) -> None:
    settings = document.state.codec
    coding = replace(settings.paper or QmdSettings(), encoder=encoder)
    document.execute(SetCodecSettings(replace(settings, coding=coding)))


def _choose_compact(document: Document) -> None:
    settings = document.state.codec
    document.execute(SetCodecSettings(replace(settings, coding=settings.compact or COMPACT_DEFAULT)))
