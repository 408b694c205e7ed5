"""One setting that was tried: what it costs and how far it strays, and the paper's figure of merit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction


@dataclass(frozen=True, slots=True)
class Trial:
    """`settings`, the payload's `bytes`, and the error: DEF in ASF length units, mean and worst distance in mm.

    The error is against all of the original, also where the settings leave something out.
    """

    settings: EncodeSettings
    bytes: int
    def_: float
    mean_mm: float
    max_mm: float

    @property
    def merit(self) -> float:
        """The paper's figure of merit, bytes times DEF (equation 5): the smaller the better."""
        return self.bytes * self.def_

    @property
    def paper(self) -> QmdSettings:
        """The settings of the paper's format, which all have that come from a grid; raises `TypeError` for others."""
        if self.settings.paper is None:
            raise TypeError("the trial is of the compact profile")
        return self.settings.paper

    def as_json(self) -> dict[str, float | int | str]:
        """Return the figures of a trial from a grid under the names that the command line prints."""
        settings = self.paper
        return {
            "encoder": str(settings.encoder),
            "fdf": settings.fdf,
            "bits": settings.bits,
            "segment": settings.segment,
            "bytes": self.bytes,
            "def": self.def_,
            "mean_mm": self.mean_mm,
            "max_mm": self.max_mm,
            "merit": self.merit,
        }


class Cancel(Protocol):
    """What a search asks whether to go on; a `threading.Event` will do."""

    def is_set(self) -> bool:
        """Return whether the search shall stop."""
        ...


class Never:
    """The `Cancel` of a search that nobody can stop."""

    def is_set(self) -> bool:
        """Return False."""
        return False


class Evaluator(Protocol):
    """Tries settings on one motion; several threads may call at once. Sizes cost nothing, trials an encoding."""

    @property
    def motion(self) -> Motion:
        """The motion that is encoded: what the reduction leaves of the original."""
        ...

    @property
    def original(self) -> Motion:
        """The motion that errors are measured against."""
        ...

    @property
    def reduction(self) -> Reduction:
        """What is left out of every trial."""
        ...

    @property
    def base(self) -> QmdSettings:
        """The settings that no search changes: the encoder, k and RQT."""
        ...

    @property
    def is_fast(self) -> bool:
        """Whether a trial takes about as long as reading the motion's values a few times."""
        ...

    def size(self, fdf: int, bits: int, segment: int) -> int:
        """Return the payload's bytes, by formula."""
        ...

    def try_bits(self, fdf: int, segment: int, bits: tuple[int, ...]) -> list[Trial]:
        """Try one FDF and one segment length (0: one segment) at several index widths."""
        ...
