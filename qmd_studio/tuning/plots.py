"""The paper's Figures 5 and 6, and the plot of a batch, drawn with matplotlib (the extra `plots`)."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from qmd_studio import storage
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.errors import CodecError
from qmd_studio.tuning.batch import Row
from qmd_studio.tuning.comparison import Comparison
from qmd_studio.tuning.sweep import FIGURE_BITS
from qmd_studio.tuning.trial import Evaluator

FORMATS = ("svg", "png", "pdf")
_KB = 1024
_SMALLEST_DEF = 1e-6
_SMALLEST_MM = 1e-5


def figure_5(path: Path, n_rows: int, n_columns: int) -> None:
    """Draw the payload's size over FDF for b 8 to 11, one segment (Figure 5; the paper's n is 100, its m 62)."""
    plot, axes = _plot()
    for bits in FIGURE_BITS:
        sizes = [payload_size(n_rows, n_columns, fdf, bits).bytes / _KB for fdf in range(n_columns + 1)]
        axes.plot(range(n_columns + 1), sizes, label=f"b = {bits}")
    axes.set(xlabel="FDF", ylabel="QMD file, KB", title=f"Size over FDF, n = {n_rows}, m = {n_columns}, one segment")
    _save(plot, axes, path)


def figure_6(path: Path, evaluator: Evaluator, name: str) -> dict[int, list[float]]:
    """Draw DEF over FDF for b 8 to 11, one segment (Figure 6), and return the values by b."""
    plot, axes = _plot()
    n_columns = evaluator.motion.skeleton.n_columns
    trials = [evaluator.try_bits(fdf, 0, FIGURE_BITS) for fdf in range(n_columns + 1)]
    values = {bits: [column[at].def_ for column in trials] for at, bits in enumerate(FIGURE_BITS)}
    for bits, def_ in values.items():
        axes.plot(range(n_columns + 1), def_, label=f"b = {bits}")
    title = f"Error over FDF, {name}, {evaluator.base.encoder} encoder, one segment"
    axes.set(xlabel="FDF", ylabel="DEF, ASF length units", title=title)
    axes.set_yscale("symlog", linthresh=max(_SMALLEST_DEF, max(values[FIGURE_BITS[0]]) * 1e-3))
    axes.set_ylim(bottom=0)
    _save(plot, axes, path)
    return values


def batch_plot(path: Path, rows: Sequence[Row]) -> None:
    """Draw DEF over bytes a frame for each file and setting of a batch, one colour an encoder, both logarithmic."""
    plot, axes = _plot()
    for encoder in sorted({str(row["encoder"]) for row in rows}):
        mine: list[Mapping[str, Any]] = [row for row in rows if row["encoder"] == encoder]
        x = [row["bytes"] / row["frames"] for row in mine]
        axes.scatter(x, [max(row["def"], _SMALLEST_DEF) for row in mine], s=12, label=encoder)
    axes.set(xlabel="bytes a frame", ylabel="DEF, ASF length units", xscale="log", yscale="log", title="Batch")
    _save(plot, axes, path)


def comparison_plot(path: Path, comparison: Comparison, name: str) -> None:
    """Draw mean error over bytes a frame for each contender, both logarithmic; lines show what was asked for.

    A contender with knobs has two points, at equal error and at equal size, joined by a line that only guides the eye.
    """
    plot, axes = _plot()
    rows = (*comparison.at_error, *comparison.at_size)
    for contender in dict.fromkeys(row.name for row in rows):
        mine = [row for row in rows if row.name == contender]
        errors = [max(row.error.mean_mm, _SMALLEST_MM) for row in mine]
        axes.plot(
            [row.bytes_per_frame for row in mine], errors, marker="o", markersize=4, linewidth=0.8, label=contender
        )
    axes.axhline(comparison.mean_error_mm, color="0.6", linewidth=0.8, linestyle="--")
    axes.axvline(comparison.n_bytes / rows[0].n_frames, color="0.6", linewidth=0.8, linestyle="--")
    axes.set(xlabel="bytes a frame", ylabel="mean joint error, mm", xscale="log", yscale="log", title=f"Codecs, {name}")
    _save(plot, axes, path)


def check_plots(path: Path) -> None:
    """Raise `CodecError` where `path` cannot be drawn: matplotlib is absent, or the suffix is none of `FORMATS`."""
    if path.suffix.lower().removeprefix(".") not in FORMATS:
        wanted = "a name that ends in " + ", ".join(f".{suffix}" for suffix in FORMATS)
        raise CodecError("plots cannot be drawn in this format", path=path, wanted=wanted, got=path.suffix)
    _plot()


def _plot() -> tuple[Any, Any]:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise CodecError("plots need matplotlib", hint='Install it: pip install "qmd-studio[plots]"') from None
    plot = Figure(figsize=(6.4, 4.4), layout="constrained")
    return plot, plot.subplots()


def _save(plot: Any, axes: Any, path: Path) -> None:
    axes.grid(alpha=0.3)
    axes.legend()
    data = io.BytesIO()
    suffix = path.suffix.lower().removeprefix(".")
    plot.savefig(data, format=suffix, dpi=150, metadata={"Date": None} if suffix == "svg" else None)
    storage.write_atomic(path, data.getvalue())
