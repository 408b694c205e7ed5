"""Which format or codec opens and writes what: the one list of them."""

from __future__ import annotations

from qmd_studio.formats.loaded import Format

FORMATS: tuple[Format, ...] = ()
