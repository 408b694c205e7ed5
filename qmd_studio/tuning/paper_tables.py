"""Tables 1 and 2 of the paper, and the CMU trials that their rows are (Chattopadhyay, Bhandarkar, Li, VRST 2005)."""

from __future__ import annotations

from dataclasses import dataclass

from qmd_studio.codecs.qmd.size import payload_size

N_COLUMNS = 62
_KB = 1024


@dataclass(frozen=True, slots=True)
class Take:
    """One motion of the paper: its name, frames, CMU `trial`, and its file in the corpus of real motions.

    `file` and `skeleton` are names in the corpus, None where it lacks the trial. `mark` says what the file is where it
    is not the raw trial itself.
    """

    name: str
    n_frames: int
    trial: str
    file: str | None = None
    skeleton: str | None = None
    mark: str = ""


@dataclass(frozen=True, slots=True)
class PaperRow:
    """A row of a table: the settings, DEF, and KB (1,024 bytes) of the raw motion, MPEG-4's and QMD's file."""

    take: Take
    fdf: int
    bits: int
    segment: int
    def_: float
    raw_kb: float
    mpeg4_kb: float
    qmd_kb: float

    @property
    def formula_bytes(self) -> int:
        """Equation 4 as the paper counts: its n is the number of frames, not of differences."""
        return payload_size(self.take.n_frames, N_COLUMNS, self.fdf, self.bits, self.segment).bytes

    @property
    def formula_kb(self) -> float:
        """The same in KB."""
        return self.formula_bytes / _KB


_JOG = Take("jog", 136, "16_46")
_LEAP = Take("run_Leap", 251, "49_04")
_STRIDE = Take(
    "stride", 298, "08_05", "cmu_asfamc/02_02.amc", mark="stand-in: 02_02, a walk of the same length; 08_05 is absent"
)
_WALK = Take("walk", 343, "02_01", "cmu_asfamc/02_01.amc")
_JUMP = Take("jump", 351, "13_39", "cmu_derived/13_39_derived.amc", "cmu_asfamc/02.asf", "rebuilt from the same take")
_BALL = Take(
    "basket Ball", 396, "06_04", "cmu_derived/06_04_derived.amc", "cmu_asfamc/02.asf", "rebuilt from the same take"
)
_FORWARD = Take(
    "forward jump", 415, "13_11", "cmu_derived/13_11_derived.amc", "cmu_asfamc/02.asf", "rebuilt from the same take"
)
_DANCE = Take("dance", 434, "05_03", "cmu_asfamc/05_03.amc")
_PIANO = Take("play piano", 691, "79_19")
_DRUMS = Take("play drums", 804, "79_18")
_VIOLIN = Take("play violin", 804, "79_17")
_SWORD = Take("sword play", 2251, "02_07")

TABLE_1 = tuple(
    PaperRow(take, 6, 8, 0, *figures)
    for take, figures in (
        (_JOG, (3, 33.2, 28, 11.9)),
        (_LEAP, (0.7, 61.0, 52, 20.9)),
        (_STRIDE, (1.4, 72.4, 64, 24.6)),
        (_WALK, (0.5, 83.3, 69, 28.1)),
        (_JUMP, (1.4, 85.3, 62, 28.7)),
        (_BALL, (0.8, 96.1, 78, 32.3)),
        (_FORWARD, (1.4, 100.8, 68, 33.7)),
        (_DANCE, (20, 105.4, 86, 35.2)),
        (_PIANO, (1, 167.6, 99, 55.3)),
        (_DRUMS, (3.4, 195.0, 88, 64.1)),
        (_VIOLIN, (3.2, 195.0, 98, 64.1)),
        (_SWORD, (4, 545.4, 390, 177.2)),
    )
)
"""Table 1: FDF 6, b 8, one segment."""

TABLE_2 = (
    PaperRow(_JOG, 11, 9, 30, 0.73, 33.2, 28, 29.7),
    PaperRow(_LEAP, 11, 10, 120, 0.20, 61.0, 52, 48.1),
    PaperRow(_STRIDE, 1, 8, 120, 1.23, 72.4, 64, 22.2),
    PaperRow(_WALK, 1, 10, 330, 0.11, 83.3, 69, 50.5),
    PaperRow(_JUMP, 26, 10, 300, 0.07, 85.3, 62, 68.6),
    PaperRow(_BALL, 11, 10, 210, 0.19, 96.1, 78, 64.7),
    PaperRow(_FORWARD, 6, 10, 90, 0.20, 100.8, 68, 75.4),
    PaperRow(_DANCE, 1, 8, 150, 19.06, 105.4, 86, 30.8),
    PaperRow(_PIANO, 26, 10, 60, 0.13, 167.6, 99, 167.2),
)
"""Table 2: the settings that the paper's exhaustive search chose."""
