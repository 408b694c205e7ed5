"""All encoders of version 1 over all raw CMU clips of the corpus: the bars they have been set, and a row for each clip.

Takes a few minutes on one core, so it is no part of `make bench`:

    .venv/bin/python tests/benchmarks/encoders.py [--bounds 2 1 0.5]
"""

import argparse
import time

import numpy as np
from bench_motion import CORPUS

from qmd_studio.codecs.qmd.encode import encode_matrix
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.codecs.qmd.size import payload_size
from qmd_studio.codecs.qmd.units import codec_matrix, motion_matrix
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.metrics import measure
from qmd_studio.registry import open_file

LISTED = "02_01", "02_02"
CLOSED, DRAFT, BARS = "closed", "closed, draft", {2.0: 0.80, 1.0: 0.85}
WAYS = {
    "paper": (QmdSettings(encoder=Encoder.PAPER), False),
    "plain": (QmdSettings(encoder=Encoder.PLAIN), False),
    DRAFT: (QmdSettings(), True),
    CLOSED: (QmdSettings(), False),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bounds", type=float, nargs="*", default=list(BARS), help="millimetres")
    bounds = parser.parse_args().bounds
    motions = {path.stem: open_file(path).motion for path in raw_clips()}
    print(f"{len(motions)} clips, {sum(m.n_frames for m in motions.values()):,} frames; FDF 6, b 8, one segment")
    found = {way: {name: run(m, *how) for name, m in motions.items()} for way, how in WAYS.items()}
    for way, clips in found.items():
        summary(way, clips, found["paper"])
    print("\nclip | frames | paper DEF | plain | closed | paper / closed | worst mm | orientation deg | us a frame")
    for name, motion in motions.items():
        one = found[CLOSED][name]
        defs = " | ".join(f"{found[way][name]['def']:.4f}" for way in ("paper", "plain", CLOSED))
        ratio = found["paper"][name]["def"] / one["def"]
        rest = f"{ratio:.0f} | {one['max_mm']:.2f} | {one['angle_deg']:.4f} | {one['us']:.0f}"
        print(f"{name} | {motion.n_frames} | {defs} | {rest}")
    for bound_mm in bounds:
        within(bound_mm, motions)


def raw_clips():
    """Return the paths of the raw CMU motions; one of them is there twice, with other line ends."""
    return [path for path in sorted(CORPUS.glob("cmu_asfamc/*.amc")) if "crlf" not in path.stem]


def run(motion, settings, draft):
    """Encode one clip and measure it, timed once compiled code is loaded."""
    matrix = codec_matrix(motion)
    settings = settings.checked(motion.skeleton.n_columns, motion.n_frames - 1)
    encode_matrix(matrix[:30], motion.skeleton, settings, draft=draft)
    started = time.perf_counter()
    encoded = encode_matrix(matrix, motion.skeleton, settings, draft=draft)
    us = 1e6 * (time.perf_counter() - started) / motion.n_frames
    decoded = motion.with_values(motion_matrix(encoded.decoded.T, motion.skeleton))
    error = measure(motion, decoded)
    return {
        "def": error.def_, "mean_mm": error.mean_mm, "max_mm": error.max_mm, "us": us,
        "angle_deg": orientation_error_deg(motion, decoded), "bytes": encoded.payload.size.bytes,
        "found": [(s.fdf, s.bits) for s in encoded.payload.segments],
    }  # fmt: skip


def orientation_error_deg(motion, decoded):
    """Return the mean angle between the orientations of all joints."""
    ours, theirs = (world_from_joint(m.skeleton, m.X)[:, :, :3, :3] for m in (motion, decoded))
    chord = np.linalg.norm(ours - theirs, axis=(2, 3))
    return float(np.degrees(2 * np.arcsin(np.minimum(chord / np.sqrt(8), 1))).mean())


def mean(values):
    """Return the geometric mean."""
    return float(np.exp(np.mean(np.log(list(values)))))


def summary(way, clips, paper):
    """Print rows of five columns for one encoder, with the bars where it has some."""
    ratios = {name: paper[name]["def"] / one["def"] for name, one in clips.items()}
    least = min(ratios, key=ratios.get)
    worst = max(clips, key=lambda name: clips[name]["max_mm"])
    bars = way == CLOSED

    def row(what, value, more="", bar=""):
        print(f"{way}: {what} | {value} | {more} | | {bar if bars else ''}")

    row("DEF of the paper's over DEF, geometric mean", f"{mean(ratios.values()):.0f}", "", "at least 1,000")
    row("the same, worst clip", f"{ratios[least]:.0f}", least, "at least 120")
    for name, bar in zip(LISTED, ("at most 0.0025", "at most 0.0035"), strict=True):
        row(f"DEF of {name}", f"{clips[name]['def']:.4f}", "", bar)
    row("worst joint of any frame", f"{clips[worst]['max_mm']:.2f} mm", worst, "at most 8 mm")
    row("orientation, geometric mean", f"{mean(c['angle_deg'] for c in clips.values()):.4f}°", "", "at most 0.03°")
    row("mean error, geometric mean", f"{mean(c['mean_mm'] for c in clips.values()):.4f} mm")
    row("encoding, median", f"{np.median([c['us'] for c in clips.values()]):.1f} us a frame", "", "at most 110")


def within(bound_mm, motions):
    """Print what the bounded encoder makes of every clip."""
    print(f"\nevery joint within {bound_mm:g} mm\nclip | bytes a frame | share | FDF, b | segments | max mm | s")
    shares, settings = [], QmdSettings(encoder=Encoder.BOUNDED, max_error_mm=bound_mm)
    for name, motion in motions.items():
        one = run(motion, settings, False)
        n_rows = motion.n_frames - 1
        shares.append(one["bytes"] / payload_size(n_rows, motion.skeleton.n_columns, 6, 8).bytes)
        setting, seconds = one["found"][0], one["us"] * motion.n_frames / 1e6
        kept = "" if one["max_mm"] <= bound_mm else " NOT KEPT"
        parts = f"{len(one['found'])} | {one['max_mm']:.3f}{kept} | {seconds:.2f}"
        print(f"{name} | {one['bytes'] / n_rows:.1f} | {shares[-1]:.3f} | {setting} | {parts}")
    bar = f"at most {BARS[bound_mm]}" if bound_mm in BARS else ""
    print(f"bounded, {bound_mm:g} mm: bytes over the paper's file, geometric mean | {mean(shares):.3f} | | | {bar}")


if __name__ == "__main__":
    main()
