"""The command line's grammar: every verb, its options and their ranges. Verbs load what they need when they run."""

from __future__ import annotations

import math
from argparse import ArgumentParser
from typing import Any

from qmd_studio import __version__
from qmd_studio.cli.grammar import (
    MAX_COUNT,
    Parser,
    above_zero,
    add_skeleton,
    add_verb,
    add_whole,
    bad_value,
    distance,
    frame_rate,
    weight,
    wholes,
)
from qmd_studio.cli.parser_body import add_body
from qmd_studio.cli.parser_render import add_render
from qmd_studio.cli.parser_retarget import add_retarget
from qmd_studio.codecs.qmd.settings import Encoder

ENCODERS = tuple(str(encoder) for encoder in Encoder if encoder is not Encoder.BOUNDED)
"""What the searches may try: the bounded encoder chooses its settings itself."""
TARGETS = {
    "bytes": "least DEF in a payload of this many bytes",
    "kbps": "least DEF at this many 1000 bits a second",
    "def": "fewest bytes for this DEF",
    "mean-mm": "fewest bytes for this mean distance",
    "max-mm": "fewest bytes with no joint farther off in any frame",
}

_SEGMENT_HELP = "rows of a segment, 0 = one segment for all"


_ENCODER_HELP = "closed (the default), the same without kinematics, the paper's, or as small as a bound lets it be"


def build_parser() -> ArgumentParser:
    """Return the parser of `qmd`; the namespace it makes has `run(namespace) -> Report`."""
    parser = Parser(prog="qmd", description="Avatar motion that is small to send: look, convert, encode, measure.")
    parser.add_argument("--version", action="version", version=f"qmd {__version__}")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True, parser_class=Parser)
    _add_info(verbs)
    _add_convert(verbs)
    _add_size(verbs)
    _add_encode(verbs)
    _add_decode(verbs)
    _add_measure(verbs)
    _add_tune(verbs)
    _add_table(verbs)
    _add_figure(verbs)
    _add_batch(verbs)
    _add_compare(verbs)
    add_render(verbs)
    add_retarget(verbs)
    add_body(verbs)
    return parser


def _add_info(verbs: Any) -> None:
    parser = add_verb(verbs, "info", "say what a file holds")
    parser.add_argument("file", metavar="FILE")
    add_skeleton(parser)
    parser.add_argument("--device", metavar="NAME", help="QMD: what playing it takes there, such as cortex-m4 or phone")


def _add_convert(verbs: Any) -> None:
    parser = add_verb(verbs, "convert", "write a motion in another format, chosen by the suffix of OUT")
    parser.add_argument("input", metavar="IN")
    parser.add_argument("output", metavar="OUT")
    add_skeleton(parser)
    parser.add_argument(
        "--fps", metavar="F", type=frame_rate, help="the frame rate, where the file's is wrong or absent"
    )


def _add_size(verbs: Any) -> None:
    parser = add_verb(verbs, "size", "say how large a QMD payload will be, without any motion")
    add_whole(parser, "--frames", "N", low=0, required=True, help="rows of differences (the paper's n)")
    add_whole(parser, "--dofs", "M", low=1, required=True, help="columns of the motion matrix")
    add_whole(parser, "--fdf", "F", low=0, required=True, help="columns kept exact")
    add_whole(parser, "--bits", "B", low=8, high=16, required=True, help="bits of an index, 8 to 16")
    add_whole(parser, "--segment", "D", low=0, required=True, help=_SEGMENT_HELP)


def _add_encode(verbs: Any) -> None:
    parser = add_verb(verbs, "encode", "encode a motion as QMD and measure what that cost")
    parser.add_argument("input", metavar="IN")
    parser.add_argument("output", metavar="OUT.qmd")
    add_skeleton(parser)
    add_whole(parser, "--fdf", "F", low=0, help="columns kept exact (6)")
    add_whole(parser, "--bits", "B", low=8, high=16, default=8, help="bits of an index, 8 to 16 (8)")
    add_whole(parser, "--segment", "D", low=0, default=0, help=_SEGMENT_HELP)
    parser.add_argument(
        "--encoder", choices=("closed", "plain", "paper", "bounded"), default="closed", help=_ENCODER_HELP
    )
    parser.add_argument(
        "--max-error-mm",
        metavar="E",
        type=distance("--max-error-mm"),
        help="bounded and compact: no joint further off than this",
    )
    parser.add_argument("--k", metavar="K", type=weight, default=math.inf, help="paper: table weights 1/l^K (inf)")
    add_whole(parser, "--rqt", "M", low=1, default=10000, help="paper: values are rounded to 1/M")
    parser.add_argument(
        "--buckets", choices=("frequency", "width"), default="frequency", help="paper: buckets of equal share or width"
    )
    parser.add_argument(
        "--profile",
        choices=("paper", "compact"),
        default="paper",
        help="paper: version 1, which any QMD decoder plays; compact: version 2, several times smaller",
    )
    parser.add_argument(
        "--mean-error-mm", metavar="E", type=distance("--mean-error-mm"), help="compact: the mean joint error (0.5)"
    )
    add_whole(parser, "--every", "K", low=1, default=1, help="keep every K-th frame; players fill in between (1)")
    add_whole(parser, "--max-level", "L", low=1, high=6, default=6, help="hold columns of a higher level, 1 to 6 (6)")
    add_whole(parser, "--max-loa", "A", low=0, high=3, help="BAP: hold the joints that an H-Anim body of LOA A lacks")


def _add_decode(verbs: Any) -> None:
    parser = add_verb(verbs, "decode", "turn a QMD file back into a motion that other programs read")
    parser.add_argument("input", metavar="IN.qmd")
    parser.add_argument("output", metavar="OUT", help="a name that ends in .amc, .bvh, .bap, .csv or .npz")


def _add_measure(verbs: Any) -> None:
    parser = add_verb(verbs, "measure", "say how far two motions of one skeleton are apart")
    parser.add_argument("original", metavar="ORIGINAL")
    parser.add_argument("decoded", metavar="DECODED")
    add_skeleton(parser)
    parser.add_argument(
        "--align",
        choices=("none", "first"),
        default="none",
        help="first: move DECODED so that both roots start at one place",
    )
    parser.add_argument("--csv", metavar="FILE", help="write the distance of every joint in every frame, in mm")


def _add_tune(verbs: Any) -> None:
    parser = add_verb(
        verbs, "tune", "find the best FDF, b and n_d for a motion: the least bytes times DEF, or a target"
    )
    parser.add_argument("input", metavar="IN")
    add_skeleton(parser)
    _add_encoder(parser)
    parser.add_argument("--exhaustive", action="store_true", help="try every setting of the grid, as the paper does")
    target = parser.add_mutually_exclusive_group()
    for kind, what in TARGETS.items():
        target.add_argument(f"--target-{kind}", metavar="V", type=above_zero(f"--target-{kind}"), help=what)
    parser.add_argument(
        "--grid", choices=("paper", "wide"), help="the paper's own, or all there is; paper, but wide for a target"
    )
    _add_bounds(parser)
    parser.add_argument(
        "--every",
        metavar="LIST",
        type=wholes("--every", 1, MAX_COUNT),
        default=(1,),
        help="also try keeping every K-th frame only, such as 1-4 (1)",
    )
    parser.add_argument(
        "--max-level",
        metavar="LIST",
        type=wholes("--max-level", 1, 6),
        default=(6,),
        help="also try holding columns of a higher level, such as 4-6 (6)",
    )
    parser.add_argument(
        "--max-loa",
        metavar="LIST",
        type=wholes("--max-loa", 0, 3),
        default=(None,),
        help="BAP: also try holding the joints that an H-Anim body of LOA A lacks",
    )
    parser.add_argument("--any-size", action="store_true", help="allow files larger than the raw motion")
    parser.add_argument("--state", metavar="FILE", help="keep what is found here, and go on from what is there")


def _add_table(verbs: Any) -> None:
    parser = add_verb(verbs, "table", "print a table of the paper beside our figures for the same motions")
    parser.add_argument("number", metavar="1|2", choices=("1", "2"))
    parser.add_argument("--corpus", metavar="DIR", required=True, help="the folder with cmu_asfamc and cmu_derived")


def _add_figure(verbs: Any) -> None:
    parser = add_verb(verbs, "figure", "draw Figure 5 (size over FDF) or 6 (error over FDF) of the paper")
    parser.add_argument("number", metavar="5|6", choices=("5", "6"))
    parser.add_argument("input", metavar="IN", nargs="?", help="the motion; Figure 5 without one is the paper's own")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="a name that ends in .svg, .png or .pdf")
    add_skeleton(parser)
    _add_encoder(parser, default="paper")


def _add_batch(verbs: Any) -> None:
    parser = add_verb(verbs, "batch", "encode and measure many files with many settings; goes on where it was stopped")
    parser.add_argument("inputs", metavar="IN", nargs="+", help="files, or folders whose motions are taken")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="the folder for batch.csv and the logs")
    add_skeleton(parser)
    parser.add_argument(
        "--encoder", metavar="E,…", type=_encoders, default=("closed",), help=f"of {', '.join(ENCODERS)} (closed)"
    )
    _add_bounds(parser)
    add_whole(parser, "--jobs", "N", low=1, help="processes (one a core)")
    parser.add_argument("--cluster", metavar="tcp://HOST:PORT", help="use the workers of this Dask scheduler instead")
    parser.add_argument("--plot", metavar="OUT", help="draw error over size; a name that ends in .svg, .png or .pdf")


def _add_compare(verbs: Any) -> None:
    parser = add_verb(verbs, "compare", "set QMD beside other codecs on a motion, at equal error and at equal size")
    parser.add_argument("input", metavar="IN")
    add_skeleton(parser)
    parser.add_argument(
        "--mean-error-mm", metavar="E", type=distance("--mean-error-mm"), default=0.5, help="the equal error (0.5)"
    )
    add_whole(parser, "--size", "BYTES", low=1, help="the equal size of the payloads (that of FDF 6, b 8, one segment)")
    parser.add_argument("--csv", metavar="OUT", help="write all figures as a table")
    parser.add_argument("--plot", metavar="OUT", help="draw error over size; a name that ends in .svg, .png or .pdf")


def _add_encoder(parser: ArgumentParser, default: str = "closed") -> None:
    parser.add_argument("--encoder", choices=ENCODERS, default=default, help=f"({default})")
    parser.add_argument("--k", metavar="K", type=weight, default=math.inf, help="paper: table weights 1/l^K (inf)")
    add_whole(parser, "--rqt", "M", low=1, default=10000, help="paper: values are rounded to 1/M")


def _add_bounds(parser: ArgumentParser) -> None:
    parser.add_argument("--fdf", metavar="LIST", type=wholes("--fdf", 0, MAX_COUNT), help="such as 0,6 or 1-26:5")
    parser.add_argument("--bits", metavar="LIST", type=wholes("--bits", 8, 16), help="such as 8-10")
    parser.add_argument(
        "--segments",
        metavar="LIST",
        type=wholes("--segments", 0, MAX_COUNT),
        help="such as 30-330:30,0; 0 = one for all",
    )


def _encoders(text: str) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(text.split(",")))
    if not set(names) <= set(ENCODERS):
        raise bad_value("--encoder", f"one or more of {', '.join(ENCODERS)}, with commas between", text)
    return names
