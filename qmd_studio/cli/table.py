"""`qmd table`: Tables 1 and 2 of the paper beside our figures, each row with the trial that it really is."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from qmd_studio.cli.load import open_motion
from qmd_studio.cli.report import Report, Value
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import StorageError
from qmd_studio.motion.motion import Motion
from qmd_studio.tuning.evaluator import evaluator_for
from qmd_studio.tuning.exhaustive import exhaustive
from qmd_studio.tuning.grid import paper_grid
from qmd_studio.tuning.paper_tables import TABLE_1, TABLE_2, PaperRow, Take
from qmd_studio.tuning.session import TuningSession


def run(arguments: Namespace) -> Report:
    """Print the rows of a table. Raises `StorageError` where the corpus is no folder, `FormatError` for its files."""
    corpus = Path(arguments.corpus)
    if not corpus.is_dir():
        raise StorageError("there is no corpus", path=corpus, wanted="a folder with cmu_asfamc and cmu_derived")
    rows = [
        _row(row, corpus, optimum=arguments.number == "2") for row in (TABLE_1 if arguments.number == "1" else TABLE_2)
    ]
    lines = [("", _HEADING_2 if arguments.number == "2" else _HEADING), *(_line(row) for row in rows)]
    notes = (
        "KB is 1,024 bytes; ours by the paper's formula, whose n is the number of frames; DEF as settled here.",
        "MPEG-4's column is the paper's: near-lossless and untuned; a well-set predictive coder takes about a tenth.",
    )
    return Report({"table": int(arguments.number), "rows": rows}, lines, notes=notes)


_HEADING = "trial    FDF   b  n_d |  KB paper   ours | DEF paper  ours, paper's encoder  ours, closed"
_HEADING_2 = _HEADING + " | our optimum"


def _row(row: PaperRow, corpus: Path, *, optimum: bool) -> dict[str, Value]:
    values: dict[str, Value] = {
        "name": row.take.name,
        "frames": row.take.n_frames,
        "trial": row.take.trial,
        "mark": row.take.mark,
        "fdf": row.fdf,
        "bits": row.bits,
        "segment": row.segment,
        "paper_def": row.def_,
        "paper_kb": row.qmd_kb,
        "paper_raw_kb": row.raw_kb,
        "paper_mpeg4_kb": row.mpeg4_kb,
        "kb": round(row.formula_kb, 2),
    }
    motion = _opened(row.take, corpus)
    if motion is None:
        return {**values, "mark": "not in the corpus: sizes only"}
    session = TuningSession(motion)
    settings = QmdSettings(row.fdf, row.bits, row.segment)
    for key, encoder in (("def", Encoder.PAPER), ("closed_def", Encoder.CLOSED)):
        values[key] = session.evaluate(QmdSettings(settings.fdf, settings.bits, settings.segment, encoder)).error.def_
    if optimum:
        best = exhaustive(evaluator_for(motion, QmdSettings(encoder=Encoder.PAPER)), paper_grid(motion)).best
        values["optimum"] = best.as_json() if best else None
    return values


def _opened(take: Take, corpus: Path) -> Motion | None:
    if take.file is None or not (corpus / take.file).exists():
        return None
    skeleton = str(corpus / take.skeleton) if take.skeleton else None
    return open_motion(str(corpus / take.file), skeleton=skeleton).motion


def _line(values: dict[str, Value]) -> tuple[str, str]:
    text = (
        f"{values['trial']:<7} {values['fdf']:>4} {values['bits']:>3} {values['segment'] or 'n':>4} |"
        f"  {values['paper_kb']:>8} {values['kb']:>6.1f} | {values['paper_def']:>9}"
    )
    if "def" in values:
        text += f"  {values['def']:>20.3g}  {values['closed_def']:>12.3g}"
    if isinstance(best := values.get("optimum"), dict):
        text += f" | FDF {best['fdf']}, b {best['bits']}, n_d {best['segment'] or 'n'}, DEF {best['def']:.3g}"
    return str(values["name"]), f"{text}  ({values['mark']})" if values["mark"] else text
